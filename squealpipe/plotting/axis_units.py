"""Axes in other units: those that are asked for, or those in which people write such sizes.

A picture is drawn in the units of its dataset. Then ticks and labels of each axis are converted,
which works for every picture alike and moves no line.
"""

import math
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import (
    AutoLocator,
    FixedLocator,
    FuncFormatter,
    Locator,
    LogLocator,
    NullLocator,
)

from squealpipe.plotting.style import (
    ANGLE_NAMES,
    POWER_OF_TEN_BELOW,
    angle_in_words,
    symbol,
)
from squealpipe.systems.inputs.units import conversion, shown_in
from squealpipe.systems.inputs.words import RAISED, number
from squealpipe.vibration.sizes import is_real


def in_units(figure: Figure, wanted: Sequence[str], dataset: xr.Dataset) -> None:
    """Convert the axes of a figure.

    Args:
        wanted: units; each axis of its kind takes it. All others of a dataset whose brake has the
            size of a real one take what people write: µm, ms, kN, Hz, kHz.

    Raises:
        ValueError: no axis measures what a unit does, or two units measure the same.
    """
    for index, one in enumerate(wanted):
        for other in wanted[:index]:
            if conversion(one, other) is not None:
                raise ValueError(
                    f"unit {one} and unit {other} measure the same; give one of them"
                )
    left, seen = set(wanted), set()
    for axis in (each for axes in figure.axes for each in (axes.xaxis, axes.yaxis)):
        # an axis label ends with its unit in parentheses: "contact force (N)"
        match = re.match(r"^(.*?)\s*\(([^()]+)\)$", axis.get_label_text(), re.DOTALL)
        if match is None:
            continue
        words, unit = match.groups()
        seen.add(unit)
        target = next(
            (one for one in wanted if conversion(unit, one) is not None), None
        )
        if target is not None:
            left.discard(target)
            _convert(axis, words, conversion(unit, target) or 1.0, target)
        elif is_real(dataset):
            _make_readable(axis, words, unit)
    left -= _title_angles(figure, wanted, dataset)
    if left:
        axes = ", ".join(sorted(seen)) or "of numbers without a unit"
        raise ValueError(
            f"unit {min(left)}: no axis of this picture measures that; its axes are in {axes}"
        )


def _title_angles(
    figure: Figure, wanted: Sequence[str], dataset: xr.Dataset
) -> set[str]:
    """Write the angles in titles in the wanted unit of angles; that unit, if there are any."""
    angles = {
        name: float(dataset[name])
        for name in ANGLE_NAMES
        if name in dataset and not dataset[name].ndim
    }
    used = set()
    for unit in wanted:
        turn = conversion("rad", unit)
        sign = "°" if conversion(unit, "deg") == 1.0 else f" {unit}"
        for text in figure.findobj(Text) if turn is not None else ():
            words = text.get_text()  # type: ignore[attr-defined]
            for name, angle in angles.items():
                now = f"{symbol(name)} = {number(angle * (turn or 1.0), 6)}{sign}"
                changed = words.replace(angle_in_words(name, angle), now)
                used |= {unit} if changed != words else set()
                words = changed
            text.set_text(words)  # type: ignore[attr-defined]
    return used


def _make_readable(axis: Axis, words: str, unit: str) -> None:
    largest = float(np.abs(axis.get_view_interval()).max())
    # only these units of an axis may be replaced by ones that read better
    readable = {
        "m": "m",
        "s": "s",
        "N": "N",
        "Hz": "Hz",
        "m/s": "m s-1",
        "N/m": "N m-1",
    }
    if unit == "rad/s":
        factor, name = shown_in(largest / (2.0 * np.pi), "Hz")
        _convert(axis, words, factor / (2.0 * np.pi), name)
    elif unit in readable:
        factor, name = shown_in(largest, readable[unit])
        if factor != 1.0:
            _convert(axis, words, factor, name)


def _convert(axis: Axis, words: str, factor: float, unit: str) -> None:
    words = "frequency" if words == "ω" and "rad" not in unit else words
    axis.set_label_text(f"{words} ({unit})")
    largest = factor * float(np.abs(axis.get_view_interval()).max())
    if (
        axis.get_scale() != "log" and 0 < largest < POWER_OF_TEN_BELOW
    ):  # one power of ten for all
        power = math.floor(math.log10(largest))
        factor *= 10.0**-power
        axis.set_label_text(f"{words} (10{str(power).translate(RAISED)} {unit})")
    if axis.get_scale() == "log":
        axis.set_major_locator(_ScaledLog(factor))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FuncFormatter(lambda x, _: _power(x * factor)))
    else:
        if not isinstance(axis.get_major_locator(), FixedLocator):  # multiples of π/4
            axis.set_major_locator(_ScaledLinear(factor))
        axis.set_major_formatter(FuncFormatter(lambda x, _: number(x * factor, 6)))


def _power(value: float) -> str:
    return f"$10^{{{round(np.log10(value))}}}$" if value > 0 else ""


class _Scaled(Locator):
    """Locator around another one, whose ticks are round once they are multiplied by a factor."""

    def __init__(self, factor: float) -> None:
        super().__init__()
        self.factor = factor

    def tick_values(self, vmin: float, vmax: float) -> Any:
        ticks = super().tick_values(vmin * self.factor, vmax * self.factor)
        return np.asarray(ticks) / self.factor


class _ScaledLinear(_Scaled, AutoLocator):
    """Locator of a linear axis."""


class _ScaledLog(_Scaled, LogLocator):
    """Locator of a logarithmic axis."""
