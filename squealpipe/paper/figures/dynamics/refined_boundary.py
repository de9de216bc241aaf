"""The boundary of kept contact at high resolution."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from scipy.ndimage import uniform_filter

from squealpipe.plotting import style
from squealpipe.study.figures.declared import report_figure

CELL_TONES = {
    style.Colour.white: "contact lost",
    style.Colour.light: "contact kept",
    style.Colour.orange: "lost, run",
    style.Colour.blue: "kept, run",
}
WINDOW_SHARE = 0.12
"""Side of the window of panel (b) over that of the map."""


@report_figure(
    reads=("refined_validity_map", "validity_boundary"),
    caption=(
        "Where model A1 keeps contact (grey), at high resolution. (a) In colour the cells that "
        "were run along the boundaries and where a thin region may hide: around late separations "
        "and where little contact force is left; lone points of the coarse grid are not shown, and "
        "all other cells inherit their neighbour's answer. (b) The window with most of the "
        "boundary, all cells that were run in colour; above it how many of a random sample of the "
        "others were wrong. The black line is the boundary as curves, traced apart from this map."
    ),
    alt="A map of kept contact with the cells that were run in colour, and a magnified part of it.",
)
def draw(refined: xr.Dataset, boundary: xr.Dataset) -> Figure:
    """A map and a magnified part of it, with the boundary as curves."""
    figure, axes = style.new_figure(style.PAGE, 3.9, ncols=2)
    _map(axes[0, 0], refined.assign(computed=_clustered(refined.computed)))
    window = _intricate(refined)
    corner, sides = window[::2], (window[1] - window[0], window[3] - window[2])
    axes[0, 0].add_patch(
        Rectangle(corner, *sides, fill=False, edgecolor=style.Colour.red, linewidth=1.2)
    )
    size, run = refined.alpha1.size, 100 * float(refined.computed.mean())
    style.panel_letter(axes[0, 0], "a", f"{size} × {size}, {run:.1f} % run")
    part = refined.sel(alpha1=slice(*window[:2]), alpha2=slice(*window[2:]))
    _map(axes[0, 1], part)
    curves = (boundary.alpha1.values, boundary.alpha2.values), boundary.curve.values
    style.draw_lines(axes[0, 1], *curves, color=style.Colour.black, linewidth=0.7)
    for axis in (axes[0, 1].xaxis, axes[0, 1].yaxis):
        style.angle_ticks(axis, np.pi, np.pi / 25)
    axes[0, 1].set(xlim=window[:2], ylim=window[2:])
    wrong, checked = int(refined.inherited_wrong), int(refined.inherited_checked)
    style.panel_letter(axes[0, 1], "b", f"magnified; {wrong} of {checked} others wrong")
    figure.legend(
        handles=style.patches(CELL_TONES.items()), loc="outside lower center", ncols=4
    )
    return figure


def _intricate(refined: xr.Dataset) -> tuple[float, float, float, float]:
    """The window that holds most of the boundary, rad: α1 from, to; α2 from, to."""
    kept = refined.separates.values == 0
    boundary = np.zeros(kept.shape, int)
    boundary[1:] += kept[1:] != kept[:-1]
    boundary[:, 1:] += kept[:, 1:] != kept[:, :-1]
    sums = np.pad(boundary.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
    side = max(2, round(WINDOW_SHARE * len(kept)))
    rows = sums[side:] - sums[:-side]
    held = rows[:, side:] - rows[:, :-side]
    places = np.argwhere(held == held.max())
    row, column = places[len(places) // 2]
    alpha1 = refined.alpha1.values[row : row + side]
    alpha2 = refined.alpha2.values[column : column + side]
    return alpha1[0], alpha1[-1], alpha2[0], alpha2[-1]


def _clustered(computed: xr.DataArray) -> xr.DataArray:
    """Cells that were run beside another one: the lone points of the coarse grid make moiré."""
    ran = computed.values.astype(bool)
    return computed.copy(
        data=ran & (uniform_filter(9.0 * ran, 3, mode="constant") > 1.5)
    )


def _map(axes: Axes, refined: xr.Dataset) -> None:
    tones = (refined.separates.values == 0) + 2 * (refined.computed.values != 0)
    style.draw_map(axes, refined, tones, **style.category_colours([*CELL_TONES]))
