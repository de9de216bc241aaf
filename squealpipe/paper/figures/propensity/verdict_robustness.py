"""Robustness of each verdict: a table of settings by statements."""

import numpy as np
import xarray as xr
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from squealpipe.paper.schema.inference import DAMPED_GRID, in_order, in_words
from squealpipe.plotting.style import PAGE, Colour, new_figure, write
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("verdict_robustness",),
    caption=(
        "The paper's statements by the criteria of the inference, in settings that it leaves out. "
        "Blue: the statement holds; red: it fails; numbers: share in % of random starts, or of the "
        "feasible parameters, in which it holds, with half its 95 % interval; grey: not judged. "
        "R is the reaction force, v₀ the speed over which friction falls. With dashpots, or "
        "friction that depends on speed, coupled modes "
        f"and unstable cells are looked for on a grid of {DAMPED_GRID} × {DAMPED_GRID} angles; ω₁ "
        "is without damping."
    ),
    alt="A table of settings by statements, blue where a statement holds and red where it fails.",
)
def draw(reach: xr.Dataset) -> Figure:
    """One table."""
    reach = in_order(reach)
    share = reach.share.values
    figure, axes = new_figure(PAGE, 0.31 * len(share) + 2.4, text=1.36)
    panel = axes[0, 0]
    panel.set_facecolor("#E8E8E8")
    colours = LinearSegmentedColormap.from_list(
        "verdict", [Colour.red, "#FFFFFF", Colour.blue]
    )
    panel.pcolormesh(
        share, cmap=colours, vmin=0.0, vmax=1.0, edgecolor="white", linewidth=1.5
    )
    half = 0.5 * (reach.share_high - reach.share_low).values
    for row, column in np.argwhere(np.isfinite(share)):
        value = share[row, column]
        single = reach.judged.values[row, column] == 1
        text = "✓" if single and value else "✗" if single else f"{100 * value:.0f}"
        if not single:
            text += f"\n±{100 * half[row, column]:.0f}"
        dark = abs(value - 0.5) > 0.3
        look = {"fontsize": 9.5, "color": "white" if dark else Colour.black}
        write(panel, column + 0.5, row + 0.5, text, linespacing=0.85, **look)
    names = list(map(in_words, reach.statement.values.tolist()))
    rows = [
        name.replace("l_pre", r"$l_\mathrm{pre}$")
        for name in reach.variant.values.tolist()
    ]
    panel.set_xticks(np.arange(len(names)) + 0.5, names, rotation=90)
    panel.set_yticks(np.arange(len(share)) + 0.5, rows)
    panel.xaxis.tick_top()
    panel.invert_yaxis()
    panel.tick_params(length=0)
    panel.spines[:].set_visible(False)
    return figure
