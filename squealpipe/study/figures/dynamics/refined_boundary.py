"""The boundary of kept contact at high resolution."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import NullLocator

from squealpipe.plotting import style

READS = ("refined_validity_map", "refinement_check")
CAPTION = (
    "Where model A1 keeps contact (grey), at high resolution. (a) In colour the cells that were "
    "run along the boundaries and where a thin region may hide: around late separations and where "
    "little contact force is left; lone points of the coarse grid are not shown, and all other "
    "cells inherit their neighbour's answer. (b) The window with most of the boundary, all cells "
    "that were run in colour. (c) Runs of uniform maps and the share of cells that they show "
    "wrongly, against the runs of the refined map."
)
ALT = (
    "A map of kept contact with the cells that were run in colour; a magnified part of it; a chart "
    "of wrong cells over the number of runs for uniform maps, with the refined map's runs marked."
)
WINDOW = 0.12
"""Side of the window of panel (b) over that of the map."""


def draw(refined: xr.Dataset, check: xr.Dataset) -> Figure:
    """A map, a magnified part, and the comparison with uniform maps.

    Args:
        refined: dataset ``refined_validity_map``.
        check: dataset ``refinement_check``.
    """
    figure, axes = style.new_figure(style.PAGE, 2.9, ncols=3, width_ratios=(1, 1, 0.8))
    _map(axes[0, 0], refined.assign(computed=_clustered(refined.computed)))
    window = _intricate(refined)
    axes[0, 0].add_patch(
        Rectangle(
            (window[0], window[2]),
            window[1] - window[0],
            window[3] - window[2],
            fill=False,
            edgecolor=style.RED,
            linewidth=1.2,
        )
    )
    size = refined.alpha1.size
    style.panel_letter(
        axes[0, 0], "a", f"{size} × {size}, {100 * float(refined.computed.mean()):.1f} % run"
    )
    part = refined.sel(alpha1=slice(*window[:2]), alpha2=slice(*window[2:]))
    _map(axes[0, 1], part)
    for axis in (axes[0, 1].xaxis, axes[0, 1].yaxis):
        style.angle_ticks(axis, np.pi, np.pi / 25)
    axes[0, 1].set(xlim=window[:2], ylim=window[2:])
    style.panel_letter(axes[0, 1], "b", "magnified")
    _comparison(axes[0, 2], check)
    figure.legend(
        handles=[
            Patch(facecolor=style.LIGHT, label="contact kept"),
            Patch(facecolor=style.BLUE, label="kept, run"),
            Patch(facecolor=style.WHITE, edgecolor=style.LIGHT, label="contact lost"),
            Patch(facecolor=style.ORANGE, label="lost, run"),
        ],
        loc="outside lower center",
        ncols=4,
    )
    return figure


def _intricate(refined: xr.Dataset) -> tuple[float, float, float, float]:
    """The window that holds most of the boundary, rad: α1 from, to; α2 from, to."""
    kept = refined.separates.values == 0
    boundary = np.zeros(kept.shape, int)
    boundary[1:] += kept[1:] != kept[:-1]
    boundary[:, 1:] += kept[:, 1:] != kept[:, :-1]
    sums = np.pad(boundary.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
    side = max(2, round(WINDOW * len(kept)))
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
    around = np.pad(ran.astype(int), 1)
    rows, columns = ran.shape
    count = sum(
        around[i : i + rows, j : j + columns]
        for i in range(3)
        for j in range(3)
        if (i, j) != (1, 1)
    )
    return computed.copy(data=ran & (count > 0))


def _map(axes: Axes, refined: xr.Dataset) -> None:
    kept = refined.separates.values == 0
    tones = np.where(kept, 1, 0) + 2 * (refined.computed.values != 0)
    style.draw_map(
        axes,
        refined.alpha1.values,
        refined.alpha2.values,
        tones,
        **style.category_colours([style.WHITE, style.LIGHT, style.ORANGE, style.BLUE]),
    )


def _comparison(axes: Axes, check: xr.Dataset) -> None:
    axes.plot(check.runs, check.wrong_share, "o-", color=style.ORANGE)
    axes.margins(x=0.2, y=0.15)
    axes.set_xscale("log")
    if (check.wrong_share > 0).any():
        axes.set_yscale("log")
    for count, runs, wrong in zip(
        check.points.values, check.runs.values, check.wrong_share.values, strict=True
    ):
        axes.annotate(
            f"{count}²", (runs, wrong), xytext=(0, 6), textcoords="offset points", ha="center",
            fontsize=7,
        )  # fmt: skip
    refined = float(check.refined_runs)
    axes.axvline(refined, color=style.BLUE, linestyle="--")
    axes.annotate(
        "refined map", (refined, 0.96), xycoords=axes.get_xaxis_transform(), xytext=(3, 0),
        textcoords="offset points", rotation=90, va="top", fontsize=7, color=style.BLUE,
    )  # fmt: skip
    axes.set_xticks(check.runs.values, [f"{runs}" for runs in check.runs.values], fontsize=6)
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set(xlabel="runs", ylabel="wrong cells of uniform maps (share)")
    style.panel_letter(axes, "c", f"{int(check.missed_regions.sum())} regions missed")
