"""Curves of special cycles in two parameters: folds, period doublings, grazings, onsets of stick.

The equations of the cycle's legs and one more, by pseudo-arclength. At a fold their derivative by
the unknowns is singular, at a period doubling that of a disturbance that returns with the other
sign; a bordered system gives the equation (Govaerts, Numerical Methods for Bifurcations of
Dynamical Equilibria, 2000, ch. 3). It is exact; its derivative, which only steers Newton's method,
is a difference of exact Jacobians along the null vector.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from squealpipe.methods.continuation import ContinuationState, PseudoArclength
from squealpipe.systems import runs
from squealpipe.systems.cycles.admissible import ROUND_OFF, Kind, Margin, margins
from squealpipe.systems.cycles.branch import PRECISE, STEPS, Line, label_of, started
from squealpipe.systems.cycles.event_map import FREE, Cycle, Event, EventMap, Section
from squealpipe.systems.cycles.flow import Flow, Vector
from squealpipe.systems.cycles.labels import Label
from squealpipe.text import suggestion
from squealpipe.validation import Number, Several, checked

if TYPE_CHECKING:
    from squealpipe.systems.system import System

_DIFFERENCE = 1e-5
_NEAR = 1e-4
"""Margin of a start below which it is taken for the one that vanishes."""
_NO_MARGIN = Margin(Kind.length, -1, FREE)
RETURNS = {Label.fold: 1.0, Label.period_doubling: -1.0}
"""What multiplies a disturbance in a period."""


Test = Callable[[Vector], float]


class Meeting(IntEnum):
    """What else happens at a point of a curve."""

    regular = 0
    cusp = 1
    fold_flip = 2
    fold_grazing = 3
    flip_grazing = 4
    stick_onset = 5
    end_of_leg = 6
    end = 7


@dataclass
class Curve:
    """The equations of a curve.

    Attributes:
        map: of the cycle, with two followed parameters.
        own: the margin that vanishes along it, of a grazing or an onset of stick.
        border: right and left null vector next to the point, of a fold or a period doubling.
    """

    map: EventMap
    label: Label
    own: Margin = _NO_MARGIN
    border: tuple[Vector, Vector] = (np.empty(0), np.empty(0))

    def returning(self, jacobian: Vector, factor: float) -> Vector:
        """The derivative by the unknowns for disturbances that a period multiplies by a factor."""
        n, size = self.map.flow.size, self.map.size
        found = jacobian[:, :size].copy()
        last = (self.map.legs - 1) * n
        found[last : last + n, :n] += (1.0 - factor) * np.eye(n)
        if self.map.periods:
            found[-1, -1] += 1.0 - factor
        return found

    def determinant(self, point: Vector, factor: float) -> float:
        """Zero where a disturbance returns multiplied by the factor."""
        return float(np.linalg.det(self.returning(self.map.evaluate(point)[1], factor)))

    def renew(self, point: Vector) -> None:
        """Take the borders, and the section of a cycle without events, from a point."""
        if self.map.section is not None:
            heading = Cycle.at(self.map, point).heading
            state = self.map.unpack(point)[0][0]
            section = Section(state, heading / np.linalg.norm(heading))
            self.map = replace(self.map, section=section)
        if self.label in RETURNS:
            matrix = self.returning(self.map.evaluate(point)[1], RETURNS[self.label])
            left, _, right = np.linalg.svd(matrix)
            self.border = right[-1], left[:, -1]

    def evaluate(self, point: Vector) -> tuple[Vector, Vector]:
        """All equations with their Jacobian."""
        values, jacobian = self.map.evaluate(point)
        if not np.isfinite(jacobian).all() or not np.isfinite(values).all():
            return np.append(values, np.nan), np.vstack([jacobian, jacobian[:1]])
        singular = self.label in RETURNS
        value, row = self._singular(point, jacobian) if singular else self._margin(point)
        return np.append(values, value), np.vstack([jacobian, row])

    def _singular(self, point: Vector, jacobian: Vector) -> tuple[float, Vector]:
        size, (right, left) = self.map.size, self.border
        matrix = np.zeros((size + 1, size + 1))
        matrix[:size, :size] = self.returning(jacobian, RETURNS[self.label])
        matrix[:size, size], matrix[size, :size] = left, right
        unit = np.eye(size + 1)[-1]
        null, dual = np.linalg.solve(matrix, unit), np.linalg.solve(matrix.T, unit)
        step = np.append(null[:size], np.zeros(len(point) - size))
        step *= _DIFFERENCE / np.linalg.norm(step)
        change = self.map.evaluate(point + step)[1] - self.map.evaluate(point - step)[1]
        slope = change * (np.linalg.norm(null[:size]) / (2.0 * _DIFFERENCE))
        return float(null[-1]), -dual[:size] @ slope

    def _margin(self, point: Vector) -> tuple[float, Vector]:
        """What a margin is of, as a function of the end of its leg, and its row."""
        equations, leg = self.map, self.own.leg
        if self.own.kind == Kind.length:
            at = equations.legs * equations.flow.size + leg
            return float(point[at]), np.eye(len(point))[at]
        parts, event = equations.parts(point), equations.events[leg]
        time = parts.start + float(parts.durations[: leg + 1].sum())
        flow, n = equations.flow, equations.flow.size
        condition = self.own.which if self.own.kind == Kind.condition else None
        value, *slopes = flow.quantity(parts.values, event, condition, parts.path.ends[leg], time)
        by_end, by_time = equations.by_unknowns(parts, leg)
        row = slopes[:n] @ by_end
        if flow.timed:
            row += slopes[n] * by_time
        row[equations.size :] += slopes[n + flow.timed :]
        row *= equations.column_units
        size = max(float(np.abs(row).max()), 1e-300)
        return value / size, row / size

    def tests(self) -> dict[Meeting, Test]:
        """What changes sign where something else happens."""
        if self.label == Label.fold:
            size = self.map.size
            return {
                Meeting.cusp: lambda z: self._cusp(z, size),
                Meeting.fold_flip: lambda z: self.determinant(z, -1.0),
            }
        if self.label == Label.period_doubling:
            return {Meeting.fold_flip: lambda z: self.determinant(z, 1.0)}
        if self.label == Label.grazing:
            return {
                Meeting.fold_grazing: lambda z: self.determinant(z, 1.0),
                Meeting.flip_grazing: lambda z: self.determinant(z, -1.0),
            }
        return {}

    def _cusp(self, point: Vector, size: int) -> float:
        return float(self.evaluate(point)[1][-1, :size] @ self.border[0])

    def least_margin(self, point: Vector) -> tuple[float, Margin | None]:
        """The margin next to zero that is not the curve's own."""
        found = {k: v for k, v in margins(Cycle.at(self.map, point)).items() if k != self.own}
        key = min(found, key=lambda k: found[k], default=None)
        return (np.inf, None) if key is None else (found[key], key)


def _curve_of(cycle: Cycle, label: Label) -> tuple[Curve, Vector]:
    """The equations of the curve through a cycle with two followed parameters, and a guess."""
    equations = cycle.map
    if label in RETURNS:
        return Curve(equations, label), cycle.point
    near = {k: abs(v) for k, v in margins(cycle).items() if abs(v) < _NEAR and k.kind != Kind.edge}
    near = {k: v for k, v in near.items() if label_of(cycle, {k: 0.0}) == label}
    if not near:
        raise ValueError(f"start: no condition of {label.name} just holds there")
    own = min(near, key=lambda k: near[k])
    if own.kind != Kind.touch:
        return Curve(equations, label, own), cycle.point
    # the leg is cut where it touches: there the switch's event has no speed, if it stays there
    parts, leg, event = cycle.parts, own.leg, equations.events[own.leg]
    first, traced = len(equations.flow.system.traced.variables), equations.flow.system.traced
    inside = [turn for turn in parts.path.turns[first + own.which] if turn.leg == leg]
    turn = min(inside, key=lambda each: abs(each.value))
    falls = traced.falls[event.before, own.which] >= 0
    number = int((traced.falls if falls else traced.rises)[event.before, own.which])
    targets = traced.switches[number].targets if number < len(traced.switches) else ()
    stays = len(targets) == 1 and targets[0][0] == event.before
    kind = targets[0][2] if stays else FREE
    touch = Event(
        number if stays else FREE, own.which, 1.0 if falls else -1.0, event.before, event.before,
        kind,
    )  # fmt: skip
    states = [cycle.states_at(np.array([cycle.clocks[leg] + turn.time]))[0][0]]
    followed = np.array([parts.values[name] for name in equations.flow.followed])
    start = parts.start
    if event.surface == FREE:
        # without events the section is the touch
        events: tuple[Event, ...] = (touch,)
        durations, start, leg = parts.durations, start + turn.time, 0
    else:
        events = (*equations.events[:leg], touch, *equations.events[leg:])
        rest = parts.durations[leg] - turn.time
        durations = np.concatenate(
            [parts.durations[:leg], [turn.time, rest], parts.durations[leg + 1 :]]
        )
        states = [*parts.states[: leg + 1], states[0], *parts.states[leg + 1 :]]
    made = replace(equations, events=events, section=None)
    own = Margin(Kind.speed, leg, own.which)
    return Curve(made, label, own), made.pack(np.array(states), durations, start, followed)


@dataclass(frozen=True)
class Point:
    """A point of a curve."""

    cycle: Cycle
    residual: float
    label: Meeting = Meeting.regular


def _at_point(test: Test, state: ContinuationState, _: Cycle) -> float:
    return test(state.point)


class _Way:
    """A curve in one direction."""

    def __init__(self, curve: Curve, limits: Mapping[str, tuple[float, float]]) -> None:
        self.curve, self.limits = curve, limits
        self.algorithm = PseudoArclength(PRECISE, least_iterations=0, own_tangent=True)
        self.end = "point_limit"

    def inside(self, point: Vector) -> float:
        """Distance from the limits, over the units."""
        equations = self.curve.map
        values = dict(zip(equations.flow.followed, point[equations.size :], strict=True))
        units = dict(zip(equations.flow.followed, equations.units, strict=True))
        found = [
            side
            for name, (low, high) in self.limits.items()
            for side in (values[name] - low / units[name], high / units[name] - values[name])
        ]
        return min(found, default=np.inf)

    def points(self, state: ContinuationState) -> Iterator[Point]:
        """The points after a first one."""
        while True:
            self.curve.renew(state.point)
            following = self.algorithm.advance(self.curve, state, self._is_cycle)
            if following is None:
                self.end = "curve_lost"
                return
            tests = self.curve.tests()
            found: dict[float, Meeting] = {}
            line = Line(
                self.algorithm, self.curve, (state, self._cycle(state)),
                (following, self._cycle(following)), partial(Cycle.at, self.curve.map),
            )  # fmt: skip
            for label, test in tests.items():
                if test(state.point) * test(following.point) < 0.0:
                    share = line.root(partial(_at_point, test))
                    # with two states folds and period doublings meet a grazing at the same point
                    if share is not None and all(abs(share - other) > 1e-6 for other in found):
                        found[share] = label
            end = self._end(line)
            for share in sorted(found):
                if end is None or share < end[0] - 1e-6:
                    yield self._point(line.at(share)[0], found[share])
            if end is not None:
                self.end = end[2]
                yield self._point(line.at(end[0])[0], end[1])
                return
            yield self._point(following, Meeting.regular)
            state = following

    def _is_cycle(self, state: ContinuationState) -> bool:
        return Cycle.at(self.curve.map, state.point).period > 0.0

    def _end(self, line: Line) -> tuple[float, Meeting, str] | None:
        """(share of the step, label, reason) where the curve ends."""
        ends, point = [], line.known[1.0][0].point
        if self.inside(point) <= 0.0:
            share = line.root(partial(_at_point, self.inside))
            ends.append((1.0 if share is None else share, Meeting.end, "end_of_range"))
        least, key = self.curve.least_margin(point)
        if least < -ROUND_OFF and key is not None:
            share = line.root(lambda there, _: self.curve.least_margin(there.point)[0])
            share = 0.0 if share is None else share
            cycle = line.at(share)[1]
            ends.append((share, *self._changed(cycle, self.curve.least_margin(cycle.point)[1])))
        return min(ends, default=None)

    def _changed(self, cycle: Cycle, key: Margin | None) -> tuple[Meeting, str]:
        if key is None:
            return Meeting.end, "curve_lost"
        label = label_of(cycle, {key: 0.0})
        met = Meeting.end
        if key.kind == Kind.length:
            met = Meeting.end_of_leg
        elif label == Label.stick_onset:
            met = Meeting.stick_onset
        elif label == Label.grazing and self.curve.label == Label.fold:
            met = Meeting.fold_grazing
        elif label == Label.grazing and self.curve.label == Label.period_doubling:
            met = Meeting.flip_grazing
        system, event = cycle.map.flow.system, cycle.map.events[key.leg]
        watched = (system.traced.falls, system.traced.rises)
        number = event.switch
        if key.kind in {Kind.touch, Kind.edge}:
            number = int(max(table[event.before, key.which] for table in watched))
        names = [*(each.name for each in system.switches), *system.stops]
        return met, f"order_changes_{key.kind.name}_of_{names[number]}".replace(" ", "_")

    def _cycle(self, state: ContinuationState) -> Cycle:
        return Cycle.at(self.curve.map, state.point)

    def _point(self, state: ContinuationState, label: Meeting) -> Point:
        return Point(self._cycle(state), state.residual, label)


def _label(
    system: System, label: str, parameters: Sequence[str], to: Mapping[str, tuple[float, float]]
) -> Label:
    names = [each.name for each in (*RETURNS, Label.grazing, Label.stick_onset)]
    if label not in names:
        raise ValueError(f"label {label!r}: {suggestion(str(label), names)}")
    if len(set(parameters)) != 2 or len(parameters) != 2:
        raise ValueError(f"parameters = {parameters!r}: two names are needed")
    for name in parameters:
        system.check_parameter(name)
    for name, limits in to.items():
        if name not in parameters:
            raise ValueError(f"to: {name!r} is unknown; {suggestion(name, parameters)}")
        if limits[0] >= limits[1]:
            raise ValueError(f"to: {name} = {limits!r}: two numbers that ascend are needed")
    return Label[label]


@checked
def cycle_curve(
    system: Any,
    label: str,
    parameters: Sequence[str],
    *,
    start: xr.Dataset,
    to: Mapping[str, tuple[Number, Number]] | None = None,
    n_points: Several = 200,
) -> xr.Dataset:
    """The curve of a special point of a branch, in two parameters, in both directions.

    Args:
        label: ``fold``, ``period_doubling``, ``grazing`` or ``stick_onset``.
        parameters: names of the two that vary.
        start: a branch, whose first point of that label is taken, or one point of it.
        to: parameter → (lowest, highest) value at which the curve ends.
        n_points: most points, of both directions together.

    Returns:
        Dataset over ``point``: both parameters by name, ``period``, ``residual`` and ``label``
        (what else happens there); and over ``side`` (first, last) ``outcome``, why the curve ended:
        ``order_changes_…`` names what changes the order of the events.

    Raises:
        ValueError: an unknown label or parameter, limits that do not ascend or leave the start out,
            or no such point in ``start``.
    """
    limits = dict(to or {})
    which = _label(system, label, parameters, limits)
    if "label" not in start:
        raise ValueError("start: a branch of cycle_branch or one of its points is needed")
    at = np.flatnonzero(np.atleast_1d(start["label"].values) == which)
    if not len(at):
        raise ValueError(f"start has no point of {label}")
    cycle = started(system, start.isel(point=int(at[0])) if "point" in start.dims else start)
    units = np.array([max(abs(cycle.parts.values[name]), 1e-3) for name in parameters])
    cycle = Cycle.at(*cycle.followed_in(Flow(system, tuple(parameters)), units))
    curve, guess = _curve_of(cycle, which)
    curve.renew(guess)
    algorithm = PseudoArclength(replace(PRECISE, max_iterations=20), 0, own_tangent=True)
    normal = np.eye(len(guess))[-1]
    first = algorithm.solve(curve, guess, normal, STEPS.first_step) or algorithm.solve(
        curve, guess, np.eye(len(guess))[-2], STEPS.first_step
    )
    if first is None:
        raise ValueError(f"start: no curve of {label} is found there")
    ways = [_Way(replace(curve), limits) for _ in range(2)]
    if ways[0].inside(first.point) < 0.0:
        raise ValueError(f"to = {to!r}: the start lies outside")
    runs_of = [
        way.points(replace(first, tangent=sign * first.tangent))
        for way, sign in zip(ways, (-1.0, 1.0), strict=True)
    ]
    found: list[list[Point]] = [[], []]
    open_ways, count = [0, 1], 1
    while open_ways and count < n_points:
        for side in list(open_ways):
            point = next(runs_of[side], None) if count < n_points else None
            if point is not None:
                found[side].append(point)
                count += 1
            elif count < n_points:
                open_ways.remove(side)
    middle = Point(Cycle.at(curve.map, first.point), first.residual)
    points = [*found[0][::-1], middle, *found[1]]
    return _dataset(system, label, points, parameters, [way.end for way in ways])


def _dataset(
    system: System, label: str, points: list[Point], parameters: Sequence[str], ends: list[str]
) -> xr.Dataset:
    found: dict[str, Any] = {
        name: (
            "point", np.array([p.cycle.parts.values[name] for p in points]),
            runs.labels(f"{name} along the curve", "1"),
        )
        for name in parameters
    }  # fmt: skip
    period = np.array([point.cycle.period for point in points])
    found["period"] = ("point", period, runs.labels("period", "s"))
    residual = np.array([point.residual for point in points])
    text = "largest equation left over, without units"
    found["residual"] = ("point", residual, runs.labels(text, "1"))
    table = {int(each): each.name for each in Meeting}
    codes = [int(point.label) for point in points]
    found["label"] = runs.flag("what else happens at the point", "point", codes, table)
    names = ["point_limit", "end_of_range", "curve_lost"]
    names += sorted(set(ends) - set(names))
    found["outcome"] = runs.flag(
        "why the curve ended", "side", [names.index(end) for end in ends], dict(enumerate(names))
    )
    values = points[0].cycle.parts.values
    attributes = runs.attributes(system, "cycle curve", values, 1e-14)
    return xr.Dataset(
        found, attrs=attributes | {"curve": label, "parameters_followed": " ".join(parameters)}
    )
