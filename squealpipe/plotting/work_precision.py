"""Parts of every work–precision chart: marks of the methods, Pareto front, name of the machine."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator

from squealpipe.benchmark.schema import Reliability, Role
from squealpipe.plotting import style

METHOD_MARKS = [
    (colour, marker, dash)
    for markers, dash in (("os^vDP*", "-"), ("dH<>ph8", ":"))
    for colour, marker in zip(
        (
            *(
                style.Colour.black,
                style.Colour.blue,
                style.Colour.green,
                style.Colour.orange,
            ),
            *(style.Colour.red, style.Colour.purple, style.Colour.grey),
        ),
        markers,
        strict=True,
    )
]
"""Mark and colour of each method. Each mark can be hollow; a cross means silently wrong."""
SMALLEST = 1e-17
"""Errors below are drawn here: they are zero to the reference's last digit."""


def draw_methods(
    axes: Axes,
    rows: xr.Dataset,
    cost: str,
    scale: float,
    methods: Sequence[str],
    ring: str = "our setting",
) -> None:
    """Error against cost, one line for each method, with the Pareto front and our own setting.

    Only right answers are filled and can be on the front: an answer that is wrong is no bargain,
    however cheap. Wrong ones are crossed out, flagged ones are hollow.

    Args:
        rows: ``method``, ``role``, ``error``, the cost, and ``worth`` (``Reliability``; without it
            all are right).
        scale: factor from its unit to the axis'.
        ring: what the red rings are, which mark the role of our setting.
    """
    error = np.maximum(rows.error.values, SMALLEST)
    values = rows[cost].values * scale
    fine = np.isfinite(error) & (values > 0)
    if not fine.any():
        style.say_instead(axes, "no such motion\nat these parameters")
        return
    worth = rows.get("worth", xr.full_like(rows.error, Reliability.right)).values
    _draw_front(axes, error, values, fine & (worth == Reliability.right))
    for method in dict.fromkeys(rows.method.values.tolist()):
        mine = fine & (rows.method.values == method)
        colour, marker, dash = METHOD_MARKS[methods.index(method) % len(METHOD_MARKS)]
        right = mine & (worth == Reliability.right)
        look: dict[str, Any] = {"color": colour, "ms": 3.5, "lw": 0.8, "zorder": 2}
        look |= {"marker": marker}
        line: dict[str, Any] = {"ls": dash, "label": style.symbols(method)}
        line["markevery"] = np.flatnonzero(right[mine]).tolist()
        axes.plot(error[mine], values[mine], **look, **line)
        if (hollow := mine & ~right).any():
            look |= {"ls": "none", "mfc": style.Colour.white}
            axes.plot(error[hollow], values[hollow], **look)
    wrong = fine & (worth == Reliability.silently_wrong)
    ours = fine & (rows.role.values == Role.our_setting)
    cross: dict[str, Any] = {
        "color": style.Colour.black,
        "ms": 5.5,
        "mew": 1.1,
        "zorder": 3,
    }
    axes.plot(error[wrong], values[wrong], "x", label="silently wrong", **cross)
    circle = cross | {"color": style.Colour.red, "ms": 9, "mfc": "none", "mew": 1.0}
    axes.plot(error[ours], values[ours], "o", label=ring, **circle)
    axes.set_yscale("log")
    if axes.get_xscale() != "log":  # once for all panels that share it
        axes.set_xscale("log")
    axes.minorticks_off()
    # over less than two decades, powers of ten alone leave an axis almost without labels
    if values[fine].max() < 100.0 * values[fine].min():
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.grid(visible=True, lw=0.3, color="#DDDDDD")


def _draw_front(
    axes: Axes, error: np.ndarray, cost: np.ndarray, right: np.ndarray
) -> None:
    """A grey band along the right answers that no other right one beats in both."""
    front = _pareto(error[right], cost[right])
    look: dict[str, Any] = {
        "color": style.Colour.black,
        "lw": 3.0,
        "alpha": 0.15,
        "zorder": 1,
    }
    axes.step(error[right][front], cost[right][front], where="post", **look)


def _pareto(error: np.ndarray, cost: np.ndarray) -> np.ndarray:
    """Indices of runs that no other beats in both, by ascending error."""
    order = np.lexsort((cost, error))
    least = np.minimum.accumulate(cost[order])
    return order[np.diff(least, prepend=np.inf) < 0]


def rule_table(axes: Axes, solvers: xr.Dataset, columns: int, **lines: Any) -> None:
    """Names of solvers beside the rows of a table, ours in bold, and lines between its cells."""
    names = list(map(style.symbols, solvers.solver.values.tolist()))
    axes.set_yticks(range(len(names)), names)
    for label, role in zip(axes.get_yticklabels(), solvers.role.values, strict=True):
        label.set_fontweight("bold" if role != Role.public else "normal")
    axes.set_xticks(np.arange(columns + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(len(names) + 1) - 0.5, minor=True)
    axes.grid(visible=True, which="minor", **lines)
    axes.tick_params(which="both", length=0)


def foot(figure: Figure, dataset: xr.Dataset) -> None:
    """Platform and versions of a run, below all panels."""
    libraries = json.loads(dataset.attrs.get("libraries", "{}"))
    versions = ", ".join(f"{name} {libraries[name]}" for name in sorted(libraries))
    platform = dataset.attrs.get("platform", "platform unknown")
    if processor := dataset.attrs.get("processor", ""):
        platform = f"{processor}, {platform}"
    figure.supxlabel(f"{platform}\n{versions}", fontsize=5.5, color=style.Colour.grey)
