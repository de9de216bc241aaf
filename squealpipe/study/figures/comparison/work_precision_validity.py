"""Work–precision of the validity map."""

from __future__ import annotations

import re

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.schema.comparison import Role
from squealpipe.study.figures.parts.work_precision import foot, legend_above

READS = ("work_precision_integration",)
CAPTION = (
    "Share of the cells of the validity map that are decided wrongly (left) and mean distance of "
    "its boundary from the reference's (right), against (a, b) the wall time of the map and (c, "
    "d) evaluations of the right-hand side: over tolerance and step (reference: tolerance 10⁻¹⁵),"
    " over the horizon (reference: the longest), and over the grid (reference: the fine grid, "
    "each coarse cell standing for its neighbourhood). Settings without any wrong cell are drawn "
    "at the dotted line. Red ring: the setting that our maps use. Machine and versions are named "
    "below the panels."
)
ALT = "Four charts: share of wrong cells and boundary distance against wall time and evaluations."

SETTING = re.compile("^([Th]) ")
"""A setting's symbol, before its value."""
_COSTS = {
    "wall_time": "wall time of the map (s)",
    "evaluations": "evaluations of the right-hand side",
}
_MARKS = {
    ("tolerance", Role.ours): (style.BLUE, "o", "over tolerance"),
    ("horizon", Role.ours): (style.GREEN, "^", "over horizon"),
    ("grid", Role.ours): (style.BLACK, "s", "over grid"),
    ("tolerance", Role.public): (style.GREY, "*", "Moreau–Jean, over step"),
}

TITLES = ("wrong cells", "boundary", "wrong cells", "boundary")


def draw(integration: xr.Dataset) -> Figure:
    """Both charts, from the task ``validity`` of dataset ``work_precision_integration``."""
    rows = integration.isel(run=integration.task.values == "validity")
    figure, axes = style.new_figure(style.PAGE, 5.4, nrows=2, ncols=2, sharex="row", sharey="col")
    for row, cost in enumerate(_COSTS):
        _draw(axes[row, 0], rows, "error", cost)
        _draw(axes[row, 1], rows, "boundary_distance", cost)
        for panel in axes[row]:
            panel.set_xlabel(_COSTS[cost])
    for letter, panel, title in zip("abcd", axes.flat, TITLES, strict=True):
        style.panel_letter(panel, letter, title)
    for panel in axes[:, 0]:
        panel.set_ylabel("share of wrong cells")
    for panel in axes[:, 1]:
        panel.set_ylabel("distance of the boundary (rad)")
    legend_above(figure, axes[0, 0], 5)
    foot(figure, integration)
    return figure


def _draw(axes: Axes, rows: xr.Dataset, name: str, cost: str) -> None:
    values, spent = rows[name].values, rows[cost].values
    positive = values[values > 0]
    floor = 0.3 * positive.min() if positive.size else 1e-6
    shown = np.maximum(values, floor)
    axes.set_ylim(0.5 * floor, 2.0 * shown.max())
    public = rows.role.values == Role.public
    for (scene, role), (colour, marker, text) in _MARKS.items():
        mine = (rows.scene.values == scene) & (public == (role == Role.public))
        order = np.argsort(spent[mine])
        axes.plot(
            spent[mine][order], shown[mine][order], "-", color=colour, marker=marker, ms=4,
            lw=0.8, label=text,
        )  # fmt: skip
        for index in np.flatnonzero(mine & (values > 0)):
            axes.annotate(
                SETTING.sub(r"\1 = ", rows.setting.values[index]), (spent[index], shown[index]),
                xytext=(-3, -7) if scene == "horizon" else (2, 3), textcoords="offset points",
                ha="right" if scene == "horizon" else "left", fontsize=5.5, color=colour,
            )  # fmt: skip
    ours = rows.role.values == Role.our_setting
    axes.plot(
        spent[ours], shown[ours], "o", ms=9, mfc="none", mec=style.RED, mew=1.0, label="our setting"
    )
    axes.axhline(floor, color=style.GREY, lw=0.6, ls=":")
    axes.annotate(
        "no wrong cell", (0.02, floor), xycoords=("axes fraction", "data"), fontsize=6,
        color=style.GREY, xytext=(0, 2), textcoords="offset points",
    )  # fmt: skip
    axes.set(xscale="log", yscale="log")
    axes.margins(x=0.15)
    axes.minorticks_off()
    axes.grid(visible=True, lw=0.3, color="#DDDDDD")
