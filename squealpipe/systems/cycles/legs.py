"""Legs as they were run: how each ends, its series, and their extrema."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from squealpipe.systems.zeros import bracketed

Vector = NDArray[np.float64]


class LegEnd(NamedTuple):
    """End of a leg: a switch, and the regimes before and after it.

    Attributes:
        switch: its number, or :data:`squealpipe.systems.cycles.event_map.FREE`.
        surface: number of the surface, or likewise for the section of a cycle without
            events.
        sign: of the surface before the event.
        before, after: regimes.
        kind: number of the event's name.
        at_once: whether its regime is entered beyond the surface, by the event before.
    """

    switch: int
    surface: int
    sign: float
    before: int
    after: int
    kind: int
    at_once: bool = False


class Turn(NamedTuple):
    """An extremum of a series inside a leg: the leg, the time since its start, the value."""

    leg: int
    time: float
    value: float
    is_minimum: bool


@dataclass(frozen=True)
class Path:
    """Legs as they were run.

    Attributes:
        leg: (steps,) to which leg each step belongs.
        steps: (steps,) lengths, in units of ``unit``.
        offsets: (steps,) time from the start of the leg, likewise.
        series: (steps, series, order): states, the time, surfaces, outputs.
        regimes, starts, durations: of the legs.
        ends: (legs, states).
        unit: of time, s.
    """

    leg: NDArray[np.int64]
    steps: Vector
    offsets: Vector
    series: Vector
    regimes: NDArray[np.int64]
    starts: Vector
    durations: Vector
    ends: Vector
    unit: float

    @classmethod
    def of(
        cls,
        series: Vector,
        steps: Vector,
        counts: NDArray[np.int64],
        size: int,
        *,
        regimes: Sequence[int],
        starts: Vector,
        durations: Vector,
        unit: float,
    ) -> Self:
        """Return the path of legs whose steps follow one another.

        Args:
            counts: (legs,) steps of each.
            size: number of states, the first of the series.
        """
        leg, orders = (
            np.repeat(np.arange(len(counts)), counts),
            np.arange(series.shape[2]),
        )
        total = np.cumsum(steps) - steps
        last = np.cumsum(counts) - 1
        ends = (series[last, :size] * steps[last, None, None] ** orders).sum(axis=2)
        return cls(
            leg,
            steps,
            total - total[last - counts + 1][leg],
            series,
            np.array(regimes),
            np.array(starts),
            np.array(durations),
            ends,
            unit,
        )

    @cached_property
    def scaled(self) -> Vector:
        """The series over the share of each step, from 0 to 1."""
        orders = np.arange(self.series.shape[2])
        return self.series * self.steps[:, None, None] ** orders

    def ends_of(self, which: int) -> tuple[Vector, Vector]:
        """A series at the start and the end of each leg."""
        first = np.searchsorted(self.leg, np.arange(len(self.regimes)))
        last = np.append(first[1:], len(self.leg)) - 1
        return self.series[first, which, 0], self.scaled[last, which].sum(axis=-1)

    @cached_property
    def turns(self) -> list[list[Turn]]:
        """Extrema of each series inside the legs."""
        scaled = self.scaled
        orders = np.arange(1, scaled.shape[2])
        rates = scaled[..., 1:] * orders
        places = np.linspace(0.0, 1.0, 9)
        values = rates @ places ** (orders[:, None] - 1)
        by_quantity: list[list[Turn]] = [[] for _ in range(scaled.shape[1])]
        hits = np.nonzero(values[..., :-1] * values[..., 1:] < 0.0)
        if not len(hits[0]):
            return by_quantity
        step, series, left = hits
        first, last = values[hits], values[step, series, left + 1]
        slopes = rates[step, series]
        bends = slopes[:, 1:] * orders[:-1]

        def rate_at(place: Vector) -> tuple[Vector, Vector]:
            powers = np.vander(place, len(orders), increasing=True)
            return (slopes * powers).sum(axis=1), (bends * powers[:, :-1]).sum(axis=1)

        ends = (places[left], places[left + 1])
        place = bracketed(
            rate_at, ends, (first, last), 1e-6
        )  # the height is quadratic in it
        powers = np.vander(place, scaled.shape[2], increasing=True)
        height = (scaled[step, series] * powers).sum(axis=1)
        time = (self.offsets[step] + place * self.steps[step]) * self.unit
        each = (series, self.leg[step], time, height, first < 0)
        for number, *turn in zip(*(values.tolist() for values in each), strict=True):
            by_quantity[number].append(Turn(*turn))
        return by_quantity
