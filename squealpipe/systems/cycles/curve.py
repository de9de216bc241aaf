"""Curves of special cycles in two parameters: folds, period doublings, tori, grazings, stick.

The equations of the cycle's legs and one more, by pseudo-arclength. At a fold their derivative by
the unknowns is singular, at a period doubling that of a disturbance that returns with the other
sign, at a torus that of one that returns turned by an angle, which is one more unknown; a bordered
system gives the equation (Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria,
2000, ch. 3). It is exact; its derivative, which only steers Newton's method, is a difference of
exact Jacobians along the null vector.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from squealpipe.methods.branch_line import Line
from squealpipe.methods.continuation import ContinuationState, PseudoArclength
from squealpipe.schema import flag_table
from squealpipe.schema.branch_labels import Label, Meeting
from squealpipe.systems.cycles.admissible import (
    MARGIN_ROUND_OFF,
    Margin,
    MarginKind,
    is_motion,
    margins,
)
from squealpipe.systems.cycles.branch import started
from squealpipe.systems.cycles.event_map import FREE, EventMap, PhaseCondition
from squealpipe.systems.cycles.event_order import label_of, order_of, run_of
from squealpipe.systems.cycles.flow import Flow, LegEnd, Vector
from squealpipe.systems.cycles.line import PRECISE, STEPS, flip
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.labels import attributes_of, flag, labels
from squealpipe.text import suggestion
from squealpipe.validation import Number, Several, checked

if TYPE_CHECKING:
    from squealpipe.systems.definition import System

_DIFFERENCE = 1e-7
_NEAR = 1e-4
"""Margin of a start below which it is taken for the one that vanishes."""
_JUMP = 1.0
"""Change of the parameters, over a step, beyond which a point is not next to the change."""
ENDS = ("point_limit", "end_of_range", "curve_lost", "multipliers_are_real")
"""Why a curve ends where the order of the events does not change."""
_NO_MARGIN = Margin(MarginKind.length, -1, FREE)
RETURNS = {Label.fold: 0.0, Label.period_doubling: np.pi, Label.torus: np.nan}
"""By which angle a disturbance is turned in a period; NaN where it is an unknown."""
GRAZINGS = {
    Label.fold: Meeting.fold_grazing,
    Label.period_doubling: Meeting.flip_grazing,
}


Test = Callable[[Vector], float]


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

    def known(self, point: Vector) -> Vector:
        """The unknowns of the cycle at a point, without the angle of a torus."""
        return point[: self.map.size + 2]

    def cycle(self, point: Vector) -> Cycle:
        """The cycle at a point."""
        return Cycle.at(self.map, self.known(point))

    def returning(self, jacobian: Vector, factor: complex) -> Vector:
        """The derivative by the unknowns for disturbances that a period multiplies by a factor."""
        n, size = self.map.flow.size, self.map.size
        found = jacobian[:, :size].astype(type(factor))
        last = (self.map.legs - 1) * n
        found[last : last + n, :n] += (1.0 - factor) * np.eye(n)
        if self.map.periods:
            found[-1, -1] += 1.0 - factor
        return found

    def factor(self, point: Vector) -> complex:
        """What multiplies a disturbance in a period."""
        angle = RETURNS[self.label]
        return (
            complex(np.exp(1j * point[-1])) if np.isnan(angle) else float(np.cos(angle))
        )

    def determinant(self, point: Vector, factor: float) -> float:
        """Zero where a disturbance returns multiplied by the factor."""
        jacobian = self.map.evaluate(self.known(point))[1]
        return float(np.linalg.det(self.returning(jacobian, factor)))

    def renew(self, point: Vector) -> None:
        """Take the borders, and the section of a cycle without events, from a point."""
        if self.map.section is not None:
            cycle = self.cycle(point)
            normal = cycle.heading / np.linalg.norm(cycle.heading)
            self.map = replace(
                self.map, section=PhaseCondition(cycle.parts.states[0], normal)
            )
        if self.label in RETURNS:
            jacobian = self.map.evaluate(self.known(point))[1]
            left, _, right = np.linalg.svd(self.returning(jacobian, self.factor(point)))
            self.border = _real(right[-1].conj()), _real(left[:, -1].conj())

    def evaluate(self, point: Vector) -> tuple[Vector, Vector]:
        """All equations with their Jacobian."""
        values, jacobian = self.map.evaluate(self.known(point))
        more = len(point) - jacobian.shape[1]
        jacobian = np.pad(jacobian, ((0, 0), (0, more)))
        if not np.isfinite(jacobian).all() or not np.isfinite(values).all():
            nothing = np.full(1 + more, np.nan)
            return np.append(values, nothing), np.vstack(
                [jacobian, jacobian[: 1 + more]]
            )
        singular = self.label in RETURNS
        value, row = (
            self._singular(point, jacobian) if singular else self._margin(point)
        )
        return np.append(values, value), np.vstack([jacobian, row])

    def _null(self, jacobian: Vector, factor: complex) -> Iterator[Any]:
        """Right and left solution of the bordered system; the last number of both is 0 on it."""
        size, (right, left) = self.map.size, self.border
        matrix: Any = np.zeros((size + 1, size + 1), type(factor))
        matrix[:size, :size] = self.returning(jacobian, factor)
        matrix[:size, size], matrix[size, :size] = left, right
        return (
            np.linalg.solve(each, np.eye(size + 1)[-1]) for each in (matrix, matrix.T)
        )

    def _singular(self, point: Vector, jacobian: Vector) -> tuple[Any, Vector]:
        size, factor = self.map.size, self.factor(point)
        null, dual = self._null(jacobian, factor)
        row: Any = -dual[:size] @ self._along(point, null[:size].real)
        if isinstance(factor, float):
            return float(null[-1]), row
        row = row - 1j * dual[:size] @ self._along(point, null[:size].imag)
        turned = 1j * factor * self.returning(np.zeros((size, size)), 0.0)
        row = np.append(row, dual[:size] @ turned @ null[:size])
        # an odd function of the angle, which is regular where that is zero or half a turn
        sine, cosine = np.sin(point[-1]), np.cos(point[-1])
        odd = row.imag / sine
        odd[-1] -= null[-1].imag * cosine / sine**2
        return np.array([null[-1].real, null[-1].imag / sine]), np.array(
            [row.real, odd]
        )

    def _along(self, point: Vector, direction: Vector) -> Vector:
        """How the Jacobian changes along a direction of the cycle's unknowns."""
        here = self.known(point)
        step = np.append(direction, np.zeros(2))
        size = max(float(np.linalg.norm(step)), 1e-300)
        step *= _DIFFERENCE / size
        change = self.map.evaluate(here + step)[1] - self.map.evaluate(here)[1]
        return np.asarray(change * (size / _DIFFERENCE))

    def _margin(self, point: Vector) -> tuple[float, Vector]:
        """What a margin is of, as a function of the end of its leg, and its row."""
        equations, leg = self.map, self.own.leg
        if self.own.kind == MarginKind.length:
            at = equations.legs * equations.flow.size + leg
            return float(point[at]), np.eye(len(point))[at]
        parts, event = equations.parts(point), equations.events[leg]
        time = parts.start + float(parts.durations[: leg + 1].sum())
        flow, n = equations.flow, equations.flow.size
        condition = self.own.which if self.own.kind == MarginKind.condition else None
        value, *slopes = flow.quantity(
            parts.values, event, condition, parts.path.ends[leg], time
        )
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
            return {Meeting.cusp: self._cusp, Meeting.fold_flip: self._flip}
        if self.label == Label.period_doubling:
            return {Meeting.fold_flip: self._fold}
        if self.label == Label.torus:
            return {
                Meeting.resonance_1_3: lambda z: z[-1] - 2.0 * np.pi / 3.0,
                Meeting.resonance_1_4: lambda z: z[-1] - np.pi / 2.0,
            }
        if self.label == Label.grazing and self.map.events[self.own.leg].switch == FREE:
            # the touch is the section, or changes nothing: multipliers are those of the motion
            return {Meeting.fold_grazing: self._fold, Meeting.flip_grazing: self._flip}
        if self.label == Label.grazing:
            return {
                Meeting.fold_grazing: lambda z: self.determinant(z, 1.0),
                Meeting.flip_grazing: lambda z: self.determinant(z, -1.0),
            }
        return {}

    def _fold(self, point: Vector) -> float:
        return float(np.prod(self.cycle(point).nontrivial - 1.0).real)

    def _flip(self, point: Vector) -> float:
        return flip(self.cycle(point))

    def _cusp(self, point: Vector) -> float:
        size, jacobian = self.map.size, self.evaluate(point)[1]
        null, _ = self._null(jacobian[:size], 1.0)
        return float(jacobian[-1, :size] @ null[:size])

    def least_margin(self, point: Vector) -> tuple[float, Margin | None]:
        """The margin next to zero that is not the curve's own."""
        found = {k: v for k, v in margins(self.cycle(point)).items() if k != self.own}
        key = min(found, key=lambda k: found[k], default=None)
        return (np.inf, None) if key is None else (found[key], key)


def _real(vector: Vector) -> Vector:
    """The longest real part of a complex vector, whose phase is free."""
    part = (vector * np.exp(-0.5j * np.angle(vector @ vector))).real
    return np.asarray(part / np.linalg.norm(part))


def _curve_of(cycle: Cycle, label: Label) -> tuple[Curve, Vector]:
    """The equations of the curve through a cycle with two followed parameters, and a guess."""
    equations = cycle.map
    if label == Label.torus:
        first = cycle.nontrivial[np.argmin(np.abs(np.abs(cycle.nontrivial) - 1.0))]
        return Curve(equations, label), np.append(cycle.point, abs(np.angle(first)))
    if label in RETURNS:
        return Curve(equations, label), cycle.point
    near = {
        k: abs(v)
        for k, v in margins(cycle).items()
        if abs(v) < _NEAR and k.kind != MarginKind.edge
    }
    near = {k: v for k, v in near.items() if label_of(cycle, {k: 0.0}) == label}
    if not near:
        raise ValueError(f"start: no condition of {label.name} just holds there")
    own = min(near, key=lambda k: near[k])
    if own.kind != MarginKind.touch:
        return Curve(equations, label, own), cycle.point
    # the leg is cut where it touches: there the switch's event has no speed, if it stays there
    parts, leg, event = cycle.parts, own.leg, equations.events[own.leg]
    first = len(equations.flow.system.traced.variables)
    traced = equations.flow.system.traced
    inside = [turn for turn in parts.path.turns[first + own.which] if turn.leg == leg]
    turn = min(inside, key=lambda each: abs(each.value))
    joint = equations.flow.system.joint
    falls = joint.falls(event.before)[own.which] >= 0
    watched = (joint.falls if falls else joint.rises)(event.before)
    number = int(watched[own.which])
    targets = traced.switches[number].targets if number < len(traced.switches) else ()
    stays = (
        len(targets) == 1 and joint.entered(event.before, targets[0][0]) == event.before
    )
    kind = targets[0][2] if stays else FREE
    touch = LegEnd(
        number if stays else FREE,
        own.which,
        1.0 if falls else -1.0,
        event.before,
        event.before,
        kind,
    )
    states, _ = cycle.states_at(np.array([cycle.clocks[leg] + turn.time]))
    start, durations = parts.start, parts.durations
    if event.surface == FREE:
        # without events the section is the touch
        events: tuple[LegEnd, ...] = (touch,)
        start, leg = start + turn.time, 0
    else:
        events = (*equations.events[:leg], touch, *equations.events[leg:])
        states = np.insert(parts.states, leg + 1, states, axis=0)
        durations = np.insert(durations, leg, turn.time)
        durations[leg + 1] -= turn.time
    made = replace(equations, events=events, section=None)
    own = Margin(MarginKind.speed, leg, own.which)
    return Curve(made, label, own), made.pack(states, durations, start, cycle.followed)


@dataclass(frozen=True)
class CurvePoint:
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
        """Distance from the limits, over the units, and of a torus from real multipliers."""
        equations = self.curve.map
        values = dict(
            zip(equations.flow.followed, point[equations.size :], strict=False)
        )
        units = dict(zip(equations.flow.followed, equations.units, strict=True))
        found = [
            side
            for name, (low, high) in self.limits.items()
            for side in (
                values[name] - low / units[name],
                high / units[name] - values[name],
            )
        ]
        return float(min([*found, self._turns(point)]))

    def _turns(self, point: Vector) -> float:
        angle = point[-1] if self.curve.label == Label.torus else np.nan
        return float(np.fmin(np.inf, min(angle, np.pi - angle)))

    def points(self, state: ContinuationState) -> Iterator[CurvePoint]:
        """The points after a first one."""
        while True:
            self.curve.renew(state.point)
            following = self.algorithm.advance(self.curve, state, self._is_cycle)
            if following is None:
                self.end = "curve_lost"
                return
            line = Line(
                self.algorithm,
                self.curve,
                (state, self._cycle(state)),
                (following, self._cycle(following)),
                self.curve.cycle,
            )
            found = self._met(line)
            end = self._end(line)
            for share in sorted(found):
                if end is None or share < end[0] - 1e-6:
                    yield self._point(line.at(share)[0], found[share])
            if end is not None:
                changed = self._point(line.at(end[0])[0], end[1])
                following = (
                    self._goes_on(line, end[0]) if end[2].startswith("order") else None
                )
                if following is not None and end[1] == Meeting.end:
                    changed = replace(changed, label=Meeting.regular)
                yield changed
                if following is None:
                    self.end = end[2]
                    return
            yield self._point(following, Meeting.regular)
            state = following

    def _met(self, line: Line[Cycle]) -> dict[float, Meeting]:
        """Shares of a step at which something else happens."""
        found: dict[float, Meeting] = {}
        first, last = (line.known[share][0].point for share in (0.0, 1.0))
        for label, test in self.curve.tests().items():
            if test(first) * test(last) < 0.0:
                share = line.root(partial(_at_point, test))
                # with two states folds and period doublings meet a grazing at the same point
                if share is not None and all(
                    abs(share - other) > 1e-6 for other in found
                ):
                    found[share] = label
        return found

    def _goes_on(self, line: Line[Cycle], share: float) -> ContinuationState | None:
        """The curve's next point with the events that motions have beyond where these change."""
        here, old = line.at(share), self.curve
        for beyond in (1e-6, 1e-4, 1e-2) if old.label in RETURNS else ():
            try:
                state, cycle = line.at(share + beyond)
            except ArithmeticError:
                continue
            found = run_of(cycle)
            if found is None or order_of(found[0].events) == order_of(cycle.map.events):
                continue
            self.curve = replace(old, map=found[0])
            angle = state.point[len(old.known(state.point)) :]
            guess = np.append(found[1], angle)
            normal = np.zeros(len(found[1]) + len(angle))
            size = found[0].size
            normal[size : size + 2] = state.tangent[old.map.size : old.map.size + 2]
            self.curve.renew(guess)
            algorithm = replace(
                self.algorithm, settings=replace(PRECISE, max_iterations=20)
            )
            new = algorithm.solve(self.curve, guess, normal, STEPS.first_step)
            if new is not None:
                moved = (
                    new.point[size : size + 2]
                    - here[0].point[old.map.size : old.map.size + 2]
                )
                near = np.abs(moved).max() < _JUMP * line.reach + 10.0 * beyond
                if near and self._is_cycle(new) and is_motion(self._cycle(new)):
                    return new
        self.curve = old
        return None

    def _is_cycle(self, state: ContinuationState) -> bool:
        return self._cycle(state).period > 0.0

    def _end(self, line: Line[Cycle]) -> tuple[float, Meeting, str] | None:
        """(share of the step, label, reason) where the curve ends."""
        ends, point = [], line.known[1.0][0].point
        if self.inside(point) <= 0.0:
            share = line.root(partial(_at_point, self.inside))
            share = 1.0 if share is None else share
            met = Meeting.end
            why = "end_of_range"
            if self._turns(point) <= 0.0:
                met = (
                    Meeting.resonance_1_1 if point[-1] < 1.0 else Meeting.resonance_1_2
                )
                why = "multipliers_are_real"
            ends.append((share, met, why))
        least, key = self.curve.least_margin(point)
        if least < -MARGIN_ROUND_OFF and key is not None:
            share = line.root(lambda there, _: self.curve.least_margin(there.point)[0])
            share = 0.0 if share is None else share
            state, cycle = line.at(share)
            ends.append(
                (share, *self._changed(cycle, self.curve.least_margin(state.point)[1]))
            )
        return min(ends, default=None)

    def _changed(self, cycle: Cycle, key: Margin | None) -> tuple[Meeting, str]:
        if key is None:
            return Meeting.end, "curve_lost"
        label = label_of(cycle, {key: 0.0})
        met = Meeting.end
        if key.kind == MarginKind.length:
            met = Meeting.end_of_leg
        elif label == Label.stick_onset:
            met = Meeting.stick_onset
        elif label == Label.grazing:
            met = GRAZINGS.get(self.curve.label, met)
        system, event = cycle.map.flow.system, cycle.map.events[key.leg]
        watched = (system.joint.falls, system.joint.rises)
        number = event.switch
        if key.kind in {MarginKind.touch, MarginKind.edge}:
            number = int(max(of(event.before)[key.which] for of in watched))
        names = [*(each.name for each in system.switches), *system.stops]
        return met, f"order_changes_{key.kind.name}_of_{names[number]}".replace(
            " ", "_"
        )

    def _cycle(self, state: ContinuationState) -> Cycle:
        return self.curve.cycle(state.point)

    def _point(self, state: ContinuationState, label: Meeting) -> CurvePoint:
        return CurvePoint(self._cycle(state), state.residual, label)


LABELS = (*RETURNS, Label.grazing, Label.stick_onset)


def check(
    known: Iterable[str],
    label: str,
    parameters: Sequence[str],
    to: Mapping[str, Sequence[float]],
) -> None:
    """Refuse a curve that there is not."""
    names = [each.name for each in LABELS]
    if label not in names:
        raise ValueError(f"label {label!r}: {suggestion(str(label), names)}")
    if len(set(parameters)) != 2 or len(parameters) != 2:
        raise ValueError(f"parameters = {parameters!r}: two names are needed")
    for name in parameters:
        if name not in known:
            raise ValueError(
                f"parameter {name!r} is unknown; {suggestion(name, known)}"
            )
    for name, limits in to.items():
        if name not in parameters:
            raise ValueError(f"to: {name!r} is unknown; {suggestion(name, parameters)}")
        if limits[0] >= limits[1]:
            raise ValueError(
                f"to: {name} = {limits!r}: two numbers that ascend are needed"
            )


def point_of(start: xr.Dataset, label: str) -> xr.Dataset:
    """The first point of a branch with a label, or the one that is given."""
    if "label" not in start:
        raise ValueError(
            "start: a branch of cycle_branch or one of its points is needed"
        )
    at = np.flatnonzero(np.atleast_1d(start["label"].values) == Label[label])
    if not len(at):
        raise ValueError(f"start has no point of {label}")
    return start.isel(point=int(at[0])) if "point" in start.dims else start


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
        label: ``fold``, ``period_doubling``, ``torus``, ``grazing`` or ``stick_onset``.
        parameters: names of the two that vary.
        start: a branch, whose first point of that label is taken, or one point of it.
        to: parameter → (lowest, highest) value at which the curve ends.
        n_points: most points, of both directions together.

    Returns:
        Dataset over ``point``: both parameters by name, ``period``, ``residual`` and ``label``
        (what else happens there), ``events`` (their number); and over ``side`` (first, last)
        ``outcome``, why the curve ended: ``order_changes_…`` names what changes their order where
        it does not go on with the new one.

    Raises:
        ValueError: an unknown label or parameter, limits that do not ascend or leave the start out,
            or no such point in ``start``.
    """
    limits = dict(to or {})
    check(system.parameters, label, parameters, limits)
    cycle = started(system, point_of(start, label))
    points, ends = follow_curve(cycle, Label[label], parameters, limits, n_points)
    return _dataset(system, label, points, parameters, ends)


def follow_curve(
    cycle: Cycle,
    label: Label,
    parameters: Sequence[str],
    limits: Mapping[str, tuple[float, float]],
    n_points: int,
) -> tuple[list[CurvePoint], list[str]]:
    """The points of a curve through a cycle, and why it ended at both sides."""
    units = np.array([max(abs(cycle.parts.values[name]), 1e-3) for name in parameters])
    flow = Flow(cycle.map.flow.system, tuple(parameters))
    curve, guess = _curve_of(Cycle.at(*cycle.followed_in(flow, units)), label)
    curve.renew(guess)
    algorithm = PseudoArclength(
        replace(PRECISE, max_iterations=20), 0, own_tangent=True
    )
    normals = np.eye(len(guess))[[curve.map.size + 1, curve.map.size]]
    starts = (
        algorithm.solve(curve, guess, normal, STEPS.first_step) for normal in normals
    )
    first = next((found for found in starts if found is not None), None)
    if first is None:
        raise ValueError(f"start: no curve of {label.name} is found there")
    ways = [_Way(replace(curve), limits) for _ in range(2)]
    if ways[0].inside(first.point) < 0.0:
        raise ValueError(f"to = {limits!r}: the start lies outside")
    runs_of = [
        way.points(replace(first, tangent=sign * first.tangent))
        for way, sign in zip(ways, (-1.0, 1.0), strict=True)
    ]
    found: list[list[CurvePoint]] = [[], []]
    open_ways, count = [0, 1], 1
    while open_ways and count < n_points:
        for side in list(open_ways):
            point = next(runs_of[side], None) if count < n_points else None
            if point is not None:
                found[side].append(point)
                count += 1
            elif count < n_points:
                open_ways.remove(side)
    middle = CurvePoint(curve.cycle(first.point), first.residual)
    return [*found[0][::-1], middle, *found[1]], [way.end for way in ways]


def _dataset(
    system: System,
    label: str,
    points: list[CurvePoint],
    parameters: Sequence[str],
    ends: list[str],
) -> xr.Dataset:
    found: dict[str, Any] = {}
    cycles = [point.cycle for point in points]
    for name in parameters:
        values = [cycle.parts.values[name] for cycle in cycles]
        found[name] = ("point", values, labels(f"{name} along the curve", "1"))
    periods = [cycle.period for cycle in cycles]
    events = [len(cycle.events) for cycle in cycles]
    found["period"] = ("point", periods, labels("period", "s"))
    found["events"] = ("point", events, labels("events of the cycle", "1"))
    text = "largest residual of the equations, without units"
    residuals = [point.residual for point in points]
    found["residual"] = ("point", residuals, labels(text, "1"))
    text = "what else happens at the point"
    meetings = [point.label for point in points]
    found["label"] = flag(text, "point", meetings, flag_table(Meeting))
    names = [*ENDS, *sorted(set(ends) - set(ENDS))]
    found["outcome"] = flag(
        "why the curve ended",
        "side",
        [names.index(end) for end in ends],
        dict(enumerate(names)),
    )
    attributes = attributes_of(system, "cycle curve", cycles[0].parts.values, 1e-14)
    return xr.Dataset(
        found,
        attrs=attributes
        | {"curve": label, "parameters_followed": " ".join(parameters)},
    )
