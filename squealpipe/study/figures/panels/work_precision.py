"""What all work–precision charts share: marks of the methods, Pareto front, and the machine."""

import json
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator

from squealpipe.plotting import style
from squealpipe.schema.comparison import Role

MARKS = [
    (colour, marker, dash)
    for markers, dash in (("os^vDP*", "-"), ("x+<>dhp", ":"))
    for colour, marker in zip(
        (
            style.BLACK,
            style.BLUE,
            style.GREEN,
            style.ORANGE,
            style.RED,
            style.PURPLE,
            style.GREY,
        ),
        markers,
        strict=True,
    )
]
"""How each method is drawn."""
_FEW_DECADES = 100.0
"""Ratio of costs below which decades alone would leave an axis with hardly a label."""
_SMALLEST = 1e-17
"""Errors below are drawn here: they are zero to the reference's last digit."""


def draw_methods(
    axes: Axes, rows: xr.Dataset, cost: str, scale: float, methods: Sequence[str]
) -> None:
    """Error against cost, one line for each method, with the Pareto front and our own setting.

    Args:
        scale: factor from its unit to the axis'.
    """
    error = np.maximum(rows.error.values, _SMALLEST)
    values = rows[cost].values * scale
    fine = np.isfinite(error) & (values > 0)
    if not fine.any():
        style.say_instead(axes, "no such motion\nat these parameters")
        return
    front = _pareto(error[fine], values[fine])
    axes.step(
        error[fine][front],
        values[fine][front],
        where="post",
        color=style.BLACK,
        lw=3.0,
        alpha=0.15,
        zorder=1,
    )
    for method in dict.fromkeys(rows.method.values.tolist()):
        mine = fine & (rows.method.values == method)
        colour, marker, dash = MARKS[methods.index(method) % len(MARKS)]
        axes.plot(
            error[mine],
            values[mine],
            dash,
            color=colour,
            marker=marker,
            ms=3.5,
            lw=0.8,
            label=style.symbols(method),
            zorder=2,
        )
    ours = fine & (rows.role.values == Role.our_setting)
    axes.plot(
        error[ours],
        values[ours],
        "o",
        ms=9,
        mfc="none",
        mec=style.RED,
        mew=1.0,
        label="our setting",
        zorder=3,
    )
    axes.set(xscale="log", yscale="log")
    axes.minorticks_off()
    if values[fine].max() < _FEW_DECADES * values[fine].min():
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.grid(visible=True, lw=0.3, color="#DDDDDD")


def _pareto(error: np.ndarray, cost: np.ndarray) -> np.ndarray:
    """Indices of runs that no other beats in both, by ascending error."""
    order = np.lexsort((cost, error))
    least = np.minimum.accumulate(cost[order])
    return order[np.diff(least, prepend=np.inf) < 0]


def foot(figure: Figure, dataset: xr.Dataset) -> None:
    """Platform and versions of a run, below all panels."""
    libraries = json.loads(dataset.attrs.get("libraries", "{}"))
    versions = ", ".join(f"{name} {libraries[name]}" for name in sorted(libraries))
    platform = dataset.attrs.get("platform", "platform unknown")
    figure.supxlabel(f"{platform}\n{versions}", fontsize=5.5, color=style.GREY)
