"""Find all values of one parameter at which a vibrating subject is quiet.

Idea: steady sliding that is linearly unstable is never quiet. So the range of a parameter is split
where growth crosses zero, which costs no run; in each stretch where small motions die out, runs
next to both of its ends and at some values between them tell whether a push dies out there. Where
it does right beside a linear boundary that boundary is the end of the quiet interval; between a
quiet and a noisy value runs bisect. All parameters are tested side by side.

Invariant: growth that comes up to zero between three stable values and crosses it twice is seen; a
stretch of quiet between two values that are looked at is not. Cost: two to ten runs an interval,
and one for each halving.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import scipy


@dataclass(frozen=True)
class Search:
    """Thresholds of the search; each comment says what another value would do."""

    located: float = 1e-3
    """Width to which a boundary is located by runs: of the value, or rad. Half as much: one run
    more."""
    least: float = 1e-3
    """Values below this, over the present one, are located as if they were this. Half as much: one
    run more where a boundary lies near 0."""
    most_trials: int = 8
    """Most values within a stretch that are run. Twice as many: shorter noise within quiet is
    seen, at twice the cost."""
    tol: float = 1e-9
    """Smallest tolerance of the runs, since boundaries are located far more coarsely. Less only
    takes time."""
    root: float = 1e-14
    """Relative width to which the linear boundary is located; more would show in printed digits."""


class Cure(NamedTuple):
    """One parameter of a subject that is changed.

    Attributes:
        value: the present value.
        apply: the subject with another value.
        below, above: values on either side that are looked at, away from the present one.
        is_angle: whether values are located absolutely, in rad.
        of_none: value in hundredths of which a change is told where the present one is 0.
    """

    value: float
    apply: Callable[[float], Any]
    below: np.ndarray
    above: np.ndarray
    is_angle: bool = False
    of_none: float = 1.0

    @property
    def grid(self) -> np.ndarray:
        """All values that are looked at, ascending or descending with ``above``."""
        return np.unique([*self.below, self.value, *self.above])

    def change(self, value: float) -> float:
        """Return the change to another value, in per cent of the present one, or degrees."""
        if self.is_angle:
            return math.degrees(value - self.value)
        return 100.0 * (value - self.value) / (self.value or self.of_none)

    def scale(self, located: float, value: float) -> float:
        """Return the distance next to a value that counts as located."""
        if self.is_angle:
            return located
        return located * max(abs(value), Search.least * abs(self.value), 1e-12)


@dataclass
class QuietInterval:
    """Values from ``low`` to ``high`` at which the subject is quiet.

    Attributes:
        low_open, high_open: whether the range that was searched ends there, and not the quiet.
    """

    low: float
    high: float
    low_open: bool = False
    high_open: bool = False

    def contains(self, value: float) -> bool:
        """Tell whether a value is in it."""
        return self.low <= value <= self.high

    def distance(self, value: float) -> float:
        """Return how far a value has to be changed to be quiet."""
        return max(self.low - value, value - self.high, 0.0)

    def edges(self) -> list[float]:
        """Return its ends that are boundaries, not ends of the range."""
        ends = (self.low, self.low_open), (self.high, self.high_open)
        return [end for end, is_open in ends if not is_open]


Margin = Callable[[Any], float]
"""Growth of small motions of a subject beyond round-off, 1/s; positive where there is
no steady sliding."""
Test = Callable[[Sequence[Cure], Sequence[float]], Sequence[bool]]
"""Test that tells whether a push dies out at some values of some parameters."""


def linear_intervals(cure: Cure, margin: Margin) -> list[QuietInterval]:
    """Return the stretches of a parameter's range in which small motions do not grow."""

    def at(value: float) -> float:
        return margin(cure.apply(value))

    values = cure.grid.tolist()
    margins = [at(value) for value in values]
    values, margins = _with_peaks(at, values, margins)
    intervals: list[QuietInterval] = []
    for index, value in enumerate(values):
        if margins[index] > 0.0:
            continue
        if index and margins[index - 1] <= 0.0:
            intervals[-1].high = value
            continue
        begins = QuietInterval(value, value, low_open=True, high_open=True)
        if index:
            begins.low, begins.low_open = _zero(at, value, values[index - 1]), False
        intervals.append(begins)
    # where each ends
    for interval in intervals:
        last = values.index(interval.high)
        if last + 1 < len(values):
            interval.high = _zero(at, values[last], values[last + 1])
            interval.high_open = False
    return intervals


def _with_peaks(
    at: Callable[[float], float], values: list[float], margins: list[float]
) -> tuple[list[float], list[float]]:
    """Return values and margins, with those at which growth crosses zero twice between two."""
    for index in range(len(values) - 2, 0, -1):
        three = margins[index - 1 : index + 2]
        if max(three) > 0.0 or not three[1] > max(three[0], three[2]):
            continue
        low, high = values[index - 1], values[index + 1]
        extremum = scipy.optimize.minimize_scalar(
            lambda value: -at(float(value)),
            bounds=(low, high),
            method="bounded",
            options={"xatol": 0.02 * (high - low)},
        )
        peak = float(extremum.x)
        if at(peak) > 0.0 and peak not in values:
            values, margins = [*values, peak], [*margins, at(peak)]
    order = np.argsort(values)
    return [values[i] for i in order], [margins[i] for i in order]


def _zero(at: Callable[[float], float], stable: float, unstable: float) -> float:
    """Return the last value at which small motions do not grow, on the way to one where they do.

    Where growth crosses zero, by Brent's method, which bisects where it jumps.
    """
    near = Search.root * abs(unstable - stable)
    root = float(
        scipy.optimize.brentq(at, stable, unstable, xtol=near, rtol=Search.root)
    )
    step = near + Search.root * abs(root)
    value = root
    while value != stable and at(value) > 0.0:
        way = min(step, abs(stable - root))
        value, step = root + math.copysign(way, stable - root), 4.0 * step
    return value


def thinned(values: np.ndarray) -> list[float]:
    """Return some of the values, dense at first, the last among them."""
    if not values.size:
        return []
    count = min(Search.most_trials, values.size)
    numbers = np.unique(np.geomspace(1, values.size, count).astype(int))
    return [float(value) for value in values[numbers - 1]]


@dataclass
class _Stretch:
    """One linear interval of one parameter, and the values at which it is tested.

    Attributes:
        tried: value → whether it is quiet.
    """

    cure: Cure
    interval: QuietInterval
    tried: dict[float, bool] = field(default_factory=dict)

    def plan(self, *, quiet: bool) -> list[float]:
        """Return the values to run."""
        interval, cure = self.interval, self.cure
        now, grid = cure.value, cure.grid
        inside = grid[(grid > interval.low) & (grid < interval.high)]
        if not interval.contains(now):
            away = inside[np.argsort(np.abs(inside - now))]
            chosen = thinned(away)
        else:
            self.tried[now] = quiet
            chosen = []
            for is_open, side in (
                (interval.low_open, inside[inside < now][::-1]),
                (interval.high_open, inside[inside > now]),
            ):
                # a quiet subject is taken to be quiet as far as it is right beside the boundary
                if not quiet or is_open:
                    chosen += thinned(side)
        low, high = (
            self._beside(end, other, is_open)
            for end, other, is_open in (
                (interval.low, interval.high, interval.low_open),
                (interval.high, interval.low, interval.high_open),
            )
        )
        chosen = [value for value in chosen if low < value < high]
        return [v for v in dict.fromkeys([*chosen, low, high]) if v not in self.tried]

    def _beside(self, end: float, other: float, is_open: bool) -> float:
        """Return the value that tells whether an end of the stretch is quiet."""
        if is_open:
            return end
        step = min(self.cure.scale(Search.located, end), 0.5 * abs(other - end))
        return end + math.copysign(step, other - end)

    def brackets(self) -> list[list[float]]:
        """Return quiet and noisy neighbours between which the verdict changes."""
        order = sorted(self.tried)
        return [
            [one, other] if self.tried[one] else [other, one]
            for one, other in pairwise(order)
            if self.tried[one] != self.tried[other]
        ]


def quiet_intervals(
    cures: Mapping[str, Cure],
    linear: Mapping[str, Sequence[QuietInterval]],
    test: Test,
    *,
    quiet: bool,
) -> dict[str, list[QuietInterval]]:
    """Return all quiet intervals of each parameter, the nearest first.

    Args:
        linear: stretches of each in which small motions do not grow.
        test: whether a push dies out, by runs.
        quiet: whether it does now.
    """
    stretches = {
        name: [_Stretch(cure, each) for each in linear[name]]
        for name, cure in cures.items()
    }
    every = [each for those in stretches.values() for each in those]
    asked = [(each, value) for each in every for value in each.plan(quiet=quiet)]
    _run(asked, test)
    _bisect(every, test)
    answers = {}
    for name, those in stretches.items():
        now = cures[name].value
        intervals = [part for each in those for part in _quiet_parts(each)]
        answers[name] = sorted(intervals, key=lambda one: one.distance(now))
    return answers


def _run(asked: Sequence[tuple[_Stretch, float]], test: Test) -> None:
    if not asked:
        return
    cures = [each.cure for each, _ in asked]
    dies = test(cures, [value for _, value in asked])
    for (each, value), answer in zip(asked, dies, strict=True):
        each.tried[value] = bool(answer)


def _bisect(stretches: Sequence[_Stretch], test: Test) -> None:
    """Halve brackets until each is as narrow as a boundary is located."""
    while True:
        asked = []
        for stretch in stretches:
            for one, other in stretch.brackets():
                # next to a boundary of growth the bracket is as narrow as it can be
                near = min(one, other, key=abs)
                if abs(one - other) > stretch.cure.scale(Search.located, near) * (
                    1.0 + 1e-9
                ):
                    asked.append((stretch, 0.5 * (one + other)))
        if not asked:
            return
        _run(asked, test)


def _quiet_parts(stretch: _Stretch) -> list[QuietInterval]:
    """Return the quiet parts of a stretch by what was tried in it."""
    order = sorted(stretch.tried)
    parts: list[QuietInterval] = []
    for index, value in enumerate(order):
        if not stretch.tried[value]:
            continue
        if index and stretch.tried[order[index - 1]]:
            parts[-1].high = value
        else:
            parts.append(QuietInterval(value, value))
    for part in parts:
        first, last = part.low == order[0], part.high == order[-1]
        part.low_open = first and stretch.interval.low_open
        part.high_open = last and stretch.interval.high_open
        if first:
            part.low = stretch.interval.low
        if last:
            part.high = stretch.interval.high
    return parts


def nearest_boundary(
    intervals: Sequence[QuietInterval], value: float, *, quiet: bool
) -> float:
    """Return the nearest value at which the verdict changes between quiet and not; NaN if none.

    Args:
        intervals: the nearest first.
        quiet: whether the present value is quiet.
    """
    if quiet:
        edges = [
            e
            for interval in intervals
            if interval.contains(value)
            for e in interval.edges()
        ]
    else:
        edges = [
            interval.low if interval.low > value else interval.high
            for interval in intervals
            if not interval.contains(value)
        ]
    return min(edges, key=lambda edge: abs(edge - value), default=math.nan)


def interval_table(rows: Sequence[Sequence[QuietInterval]]) -> dict[str, np.ndarray]:
    """Return ``quiet_low`` and ``quiet_high``, (cures, intervals); NaN where there are fewer."""
    count = max((len(row) for row in rows), default=0)
    table = np.full((2, len(rows), count), np.nan)
    for index, row in enumerate(rows):
        table[0, index, : len(row)] = [each.low for each in row]
        table[1, index, : len(row)] = [each.high for each in row]
    return {"quiet_low": table[0], "quiet_high": table[1]}
