"""Predictability of model A1: the time for which a run can be computed point by point."""

from itertools import cycle

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.codes import flag_words
from squealpipe.plotting import style
from squealpipe.schema import meanings
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.words import number


@report_figure(
    reads=("hammering_map",),
    caption=(
        "How far ahead model A1 can be computed. (a) Time at which an error of the integrator's "
        "tolerance has grown to l_pre/1000, from the tangent map through all events; white: not "
        "within the time run. Beyond it only statistics mean something. (b) Share of the cells of "
        "each kind of motion in which a perturbation grows less than that over the run; cells are "
        "counted in the key; dashed: growth by the square of time."
    ),
    alt="Left, a map of the predictability horizon; right, shares of the growth by kind of motion.",
)
def draw(hammering: xr.Dataset) -> Figure:
    """A map of the horizon and the distribution of the growth."""
    figure, axes = style.new_figure(style.PAGE, 3.2, ncols=2)
    t_end = float(hammering.t_end)
    horizon = hammering.predictability_horizon.values
    shown = np.where(horizon < t_end, horizon, np.nan)
    low = np.nanmin(shown) if np.isfinite(shown).any() else 0.1 * t_end
    mesh = style.draw_map(
        axes[0, 0], hammering, shown, cmap="viridis_r", vmin=low, vmax=t_end
    )
    figure.colorbar(
        mesh, ax=axes[0, 0], label="predictability horizon (s)", shrink=0.85
    )
    reached = np.count_nonzero(horizon < t_end)
    style.panel_letter(axes[0, 0], "a", f"reached in {reached} of {horizon.size}")
    growth = hammering.lyapunov_exponent.values * t_end
    names = meanings(hammering.motion)
    panel = axes[0, 1]
    # distinct in greyscale, too
    dashes = ("-", (0, (5, 1)), (0, (1, 1)), "-.", (0, (3, 1, 1, 1, 1, 1)))
    for code, dash in zip(np.unique(hammering.motion.values).tolist(), cycle(dashes)):
        chosen = growth[hammering.motion.values == code]
        label = f"{flag_words(names[code])} ({chosen.size})"
        panel.ecdf(
            chosen,
            color=style.REGIME_COLOURS[names[code]],
            ls=dash,
            lw=1.4,
            label=label,
        )
    regular = float(hammering.attrs["regular_growth"])
    panel.axvline(regular, color=style.Colour.grey, ls="--", label="square of time")
    panel.set_xlabel(f"ln of the growth over t = {number(t_end, 4)} s")
    panel.set_ylabel("share of the cells below")
    figure.legend(loc="outside lower right", ncols=3)
    style.panel_letter(panel, "b", "growth of a perturbation")
    return figure
