"""Fig. 3: x(t) and y(t) at (0.4π, 0.6π)."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.paper.figures.dynamics.fig02 import inset_mechanism
from squealpipe.plotting import style
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("*simulate/F3*",),
    caption=(
        "Displacements of model A1, started at rest at α₁ = 0.4π, α₂ = 0.6π: (a) x, along the "
        "belt, and (b) y, away from it. Dotted: l_pre, above which contact is lost. (c) x much "
        "longer, as the study reads the paper (orange) and, where that differs, with friction of "
        "one sign in all models (black)."
    ),
    alt="Time histories of x and y with the springs, and below them x over a much longer time.",
)
def draw(runs: Mapping[str, xr.Dataset]) -> Figure:
    """Two panels, and a third one where the study has long runs."""
    run = runs["simulate/F3"]
    readings = (
        ("simulate/F3_long", style.Colour.along, "as printed"),
        ("corrected/simulate/F3_long", style.Colour.black, "one sign"),
    )
    long = [
        (runs[name], colour, words) for name, colour, words in readings if name in runs
    ]
    rows = 2 + bool(long)
    # inches: on page one it stands beside Fig. 7, where a wider one would be scaled down too far
    figure, axes = style.new_figure(4.4, 1.5 * rows, nrows=rows)
    titles = {
        "x": "x, along the belt",
        "y": r"y, away from the belt (dotted: $l_\mathrm{pre}$)",
    }
    for panel, letter, name, colour in zip(
        axes[:2, 0],
        "ab",
        ("x", "y"),
        (style.Colour.along, style.Colour.across),
        strict=True,
    ):
        panel.plot(run.time, run[name], color=colour, linewidth=0.7)
        panel.axhline(0.0, color=style.Colour.grey, linewidth=0.5)
        panel.set(ylabel=f"{name} (m)", xlim=(0.0, float(run.time[-1])))
        style.panel_letter(panel, letter, titles[name])
    axes[1, 0].axhline(float(run.preload), color="black", ls=":", lw=0.8)
    for other, colour, words in long:
        axes[2, 0].plot(other.time, other.x, color=colour, linewidth=0.4, label=words)
        axes[2, 0].set(ylabel="x (m)", xlim=(0.0, float(other.time[-1])))
        style.panel_letter(axes[2, 0], "c", "x, longer")
    if len(long) > 1:
        axes[2, 0].legend(loc="upper left", ncols=2)
    axes[-1, 0].set_xlabel("t (s)")
    inset_mechanism(axes[0, 0], run, (1.0, 0.2, 0.24, 0.7))
    return figure
