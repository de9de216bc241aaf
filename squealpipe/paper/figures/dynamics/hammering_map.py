"""Kinds of motion of model A1 over both spring angles, with impacts and forces."""

from typing import Any

import xarray as xr
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import LogLocator, MaxNLocator

from squealpipe.paper.figures.linear.linear_overlay import mark_figure_3
from squealpipe.plotting import plot, style
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.words import number


@report_figure(
    reads=("hammering_map",),
    caption=(
        "What model A1 does over both spring angles, started at rest. (a) Kind of motion in the "
        "second half of the run; dots: another kind in its last quarter. (b) Returns to the belt "
        "per unit of time. (c) Share of the time off the belt. (d) Largest contact force over the "
        "preload. The cross is the configuration of Fig. 3."
    ),
    alt=(
        "Four maps over both angles: motion, impacts per time, time separated, peak force."
    ),
)
def draw(hammering: xr.Dataset) -> Figure:
    """Four maps."""
    figure, axes = style.new_figure(style.PAGE, 6.0, text=1.36, nrows=2, ncols=2)
    plot(hammering, ax=axes[0, 0])
    style.panel_letter(
        axes[0, 0], "a", f"motion to t = {number(float(hammering.t_end), 4)} s"
    )
    force = hammering.peak_contact_force
    scale = {"norm": LogNorm(1.0, max(2.0, float(force.max())))}
    quantities: list[tuple[str, str, xr.DataArray, dict[str, Any]]] = [
        ("b", "impacts per time (s⁻¹)", hammering.impact_rate, {}),
        ("c", "share of time off belt", hammering.separated_fraction, {"vmin": 0}),
        ("d", r"peak force over $k_3 l_\mathrm{pre}$", force, scale),
    ]
    for panel, (letter, title, values, scale) in zip(
        axes.flat[1:], quantities, strict=True
    ):
        mesh = style.draw_map(panel, hammering, values, cmap="viridis", **scale)
        bar = figure.colorbar(mesh, ax=panel, shrink=0.85)
        bar.locator = MaxNLocator(4)
        if letter == "d":
            bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            bar.ax.yaxis.set_major_formatter("{x:g}")
            bar.minorticks_off()
        style.panel_letter(panel, letter, title)
    halo = [withStroke(linewidth=3.2, foreground="white")]
    for panel in axes.flat:
        mark_figure_3(panel, style.Colour.black, path_effects=halo)
    return figure
