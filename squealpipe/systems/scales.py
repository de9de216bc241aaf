"""Runs in numbers without units: a system's scales make its results the same in any units.

A system that states the units of its parameters and typical scales (a mass, a length, a time) is
integrated as numbers in these: the same motion in millimetres or metres is the same to the last
bit, chaotic or not, as long as its numbers are.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np


@cache
def powers_of(unit: str) -> tuple[tuple[str, int], ...]:
    """Return each part of a CF unit such as ``N s m-1`` with its power."""
    parts = re.findall(r"(/?) *([A-Za-z%°µ]+)\^?(-?\d*)", unit)
    return tuple(
        (base, int(power or 1) * (-1 if under else 1)) for under, base, power in parts
    )


class Scales:
    """The scales of some runs of a system.

    Attributes:
        known: unit → its scale, a number or an array (runs,).
    """

    # Units of numbers that have none.
    units_without_scale = ("1", "rad")

    def __init__(self, known: Mapping[str, Any]) -> None:
        self.known = dict(known)

    def of(self, unit: str) -> Any:
        """Return the scale of a quantity that has a unit.

        Raises:
            ValueError: no scale is known of a part of the unit.
        """
        if unit in Scales.units_without_scale:
            return 1.0
        if unit not in self.known:
            parts = [
                (base, n)
                for base, n in powers_of(unit)
                if base not in Scales.units_without_scale
            ]
            if missing := [base for base, _ in parts if base not in self.known]:
                raise ValueError(
                    f"unit {unit!r}: no scale is given of {missing[0]!r}; scales has "
                    f"{', '.join(self.known)}"
                )
            above, below = (
                math.prod(
                    self.known[base] ** abs(n) for base, n in parts if n * sign > 0
                )
                for sign in (1, -1)
            )
            self.known[unit] = above / below
        return self.known[unit]

    def into(
        self, units: Mapping[str, str], values: Mapping[str, Any]
    ) -> dict[str, Any]:
        """Return values as numbers in these scales; what has no unit stays.

        Args:
            units: name → unit.
        """
        return {
            name: value
            if units.get(name, "1") in Scales.units_without_scale
            # adding 0 makes −0 to 0: equal values have equal bits
            else value / self.of(units[name]) + 0.0
            for name, value in values.items()
        }

    def options(self, options: Any, units: Sequence[str], *, alike: bool) -> Any:
        """Return what runs look at in these scales.

        Args:
            options: ``RunOptions`` of :mod:`squealpipe.systems.integrate`.
            units: of the states.
            alike: the scales are the states' typical sizes.
        """
        time, times = self.of("s"), options.times
        around, sizes = options.around, options.unit_sizes
        if times is not None:
            times = np.atleast_2d(times) / np.reshape(time, (-1, 1))
        if around is not None:
            around = around / self.table(units[:2], len(around))[:, None]
        if sizes is not None:
            sizes = sizes / self.table(units, np.size(time))
        elif alike:
            sizes = np.ones(len(units))
        return replace(
            options,
            t_late=options.t_late / time,
            times=times,
            around=around,
            unit_sizes=sizes,
            t_start=options.t_start / time,
        )

    def back(
        self, raw: dict[str, np.ndarray], states: Sequence[str], tracked: Sequence[str]
    ) -> None:
        """Give raw results other than times their units, in place.

        Args:
            states, tracked: units of the states, and of the quantities that are tracked.
        """
        size = len(raw["final"])
        scale = self.table(states, size)
        for name in ("final", "peaks", "samples", "event_states"):
            raw[name] *= scale.reshape(size, *(1,) * (raw[name].ndim - 2), len(states))
        scale = self.table(tracked, size)[..., None]
        for name in ("extremes", "early_extremes", "late_extremes", "sample_extremes"):
            raw[name] *= scale.reshape(
                size, *(1,) * (raw[name].ndim - 3), len(tracked), 1
            )

    def table(self, units: Sequence[str], size: int) -> np.ndarray:
        """Return the scales of some units in each of so many runs, (runs, units)."""
        factors = np.empty((size, len(units)))
        for index, unit in enumerate(units):
            factors[:, index] = self.of(unit)
        return factors
