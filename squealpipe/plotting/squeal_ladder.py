"""Accuracy of methods for a structure's squeal against their cost, and how much each creeps."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.benchmark.schema import Role
from squealpipe.plotting import style
from squealpipe.plotting.work_precision import METHOD_MARKS, draw_methods, foot

ERRORS = {
    "frequency": ("frequency", "relative error"),
    "velocity": ("level", "relative error of the rms speed"),
    "separation": ("contact loss", "error of the share of time"),
}
"""Quantity → title of its panel, and label of its axis."""


def draw_level(axes: Axes, ladder: xr.Dataset) -> None:
    """Error of the rms speed against CPU time."""
    draw_error(axes, ladder, "velocity")
    axes.legend(fontsize=6.5)


def draw_error(axes: Axes, ladder: xr.Dataset, quantity: str) -> None:
    """Error of a quantity against CPU time; the finest run at its own error, grey below it.

    Args:
        quantity: one of :data:`ERRORS`.
    """
    # errors below this are round-off and are drawn on the axis' lower edge
    smallest_error = 1e-7
    known = max(float(ladder[f"{quantity}_uncertainty"]), smallest_error)
    error = ladder[f"{quantity}_error"]
    is_finest = ladder.role == Role.our_setting
    shown = error.where(~is_finest, known).clip(min=smallest_error)
    rows = ladder[["method", "role", "cpu_time"]].assign(
        error=shown, worth=ladder.verdict
    )
    names = list(dict.fromkeys(ladder.method.values.tolist()))
    draw_methods(axes, rows, "cpu_time", 1.0, names, ring="finest")
    if not np.isfinite(shown).any():
        return
    left, right = float(shown.min()), float(shown.max())
    room = max(right / left, 10.0) ** 0.08
    axes.set_xlim(left / room, right * room)
    axes.axvspan(
        left / room, known, color=style.Colour.light, alpha=0.35, zorder=0, lw=0
    )
    # offset in points (x, y) and alignment of the settings beside a method's markers, in turn
    label_offsets = [
        (-4, 3, "right"),
        (4, 3, "left"),
        (0, 5, "center"),
        (0, -9, "center"),
    ]
    for place in np.flatnonzero(np.isfinite(shown.values)):
        x, y, side = label_offsets[
            names.index(str(ladder.method.values[place])) % len(label_offsets)
        ]
        words = str(ladder.setting.values[place]).removesuffix(" modes").split(", ")
        axes.annotate(
            ", ".join(dict.fromkeys(words)),  # equal widths once
            (shown.values[place], ladder.cpu_time.values[place]),
            (x, y),
            textcoords="offset points",
            ha=side,
            fontsize=5.5,
        )
    axes.set(xlabel=ERRORS[quantity][1], ylabel="CPU time (s)")


def draw_creep(axes: Axes, ladder: xr.Dataset) -> None:
    """Share of the time that a contact is slower than the width of smoothed friction."""
    slow = ladder.stick_fraction.max(["mode", "contact"])
    width = ladder.friction_width
    names = list(dict.fromkeys(ladder.method.values.tolist()))
    for name in names:
        mine = ((ladder.method == name) & (width > 0)).values
        if mine.any():
            colour, marker, dash = METHOD_MARKS[names.index(name)]
            look: dict[str, Any] = {
                "color": colour,
                "marker": marker,
                "ms": 3.5,
                "lw": 0.8,
            }
            axes.plot(width[mine], slow[mine], dash, **look)
    finest = float(slow[(ladder.role == Role.our_setting).values].item())
    axes.axhline(finest, color=style.Colour.red, lw=0.8, ls="--")
    axes.annotate(
        "finest: stick",
        (1.0, finest),
        (-2, 2),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        ha="right",
        fontsize=6.5,
        color=style.Colour.red,
    )
    if (width > 0).any():
        axes.set_xscale("log")
    axes.set(xlabel="smoothing of friction / belt speed", ylabel="share of time")
    axes.set_ylim(bottom=0.0)


def figure(ladder: xr.Dataset) -> Figure:
    """Three errors against CPU time, and the share of time that is creep."""
    made, axes = style.new_figure(style.PAGE, 5.2, nrows=2, ncols=2)
    for panel, quantity in zip(axes.flat, ERRORS, strict=False):
        draw_error(panel, ladder, quantity)
    draw_creep(axes[1, 1], ladder)
    titles = [title for title, _ in ERRORS.values()]
    style.panel_letters(axes.flat, [*titles, "stick, or creep"])
    made.legend(
        *axes[0, 0].get_legend_handles_labels(),
        loc="outside upper center",
        ncols=3,
        fontsize=6.5,
    )
    foot(made, ladder)
    return made
