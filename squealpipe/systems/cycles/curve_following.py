"""Follow curves of special cycles over two parameters; name what happens on them and at their ends.

Idea: a fold, period doubling or torus of a cycle is one equation more, so over two parameters it
lies on a curve, which pseudo-arclength continuation follows both ways. Between two points,
quantities whose zero means something else (a further multiplier on the circle, an event that
vanishes or appears, a limit of the parameters) are watched for a change of sign, and the place is
located. Invariant: every point solves its equations to round-off of the flow, with events in the
order that the motion has there. Cost: one Newton solution, that is a few runs of one period with
derivatives, for each point.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from squealpipe.systems.branch_labels import Label, Meeting
from squealpipe.systems.branch_line import ZERO_ROUND_OFF, Line
from squealpipe.systems.continuation import ContinuationState, PseudoArclength
from squealpipe.systems.cycles.admissible import Margin, MarginKind, is_motion
from squealpipe.systems.cycles.curve_equations import RETURNS, Curve, Test, curve_of
from squealpipe.systems.cycles.event_order import label_of, order_of, run_of
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.cycles.line import branch_steps, precise_steps
from squealpipe.systems.cycles.solution import Cycle

ENDS = ("point_limit", "end_of_range", "curve_lost", "multipliers_are_real")
"""Reasons why a curve ends where the order of the events does not change."""


@dataclass(frozen=True)
class CurvePoint:
    """A point of a curve."""

    cycle: Cycle
    residual: float
    label: Meeting = Meeting.regular


class _End(NamedTuple):
    """End of a curve within a step, and whether it may go on with other events."""

    share: float
    label: Meeting
    reason: str
    order_changes: bool = False


def _at_point(test: Test, state: ContinuationState, _: Cycle) -> float:
    return test(state.point)


class _Way:
    """A curve in one direction."""

    def __init__(self, curve: Curve, limits: Mapping[str, tuple[float, float]]) -> None:
        self.curve, self.limits = curve, limits
        self.algorithm = PseudoArclength(
            precise_steps, least_iterations=0, own_tangent=True
        )
        self.end = "point_limit"

    def inside(self, point: Vector) -> float:
        """Distance from the limits, over the units, and of a torus from real multipliers."""
        equations = self.curve.map
        values = dict(
            zip(equations.flow.followed, point[equations.size :], strict=False)
        )
        units = dict(zip(equations.flow.followed, equations.units, strict=True))
        inner = [
            side
            for name, (low, high) in self.limits.items()
            for side in (
                values[name] - low / units[name],
                high / units[name] - values[name],
            )
        ]
        return float(min([*inner, self._turns(point)]))

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
            meetings = self._met(line)
            end = self._end(line)
            for share in sorted(meetings):
                if end is None or share < end.share - 1e-6:
                    yield self._point(line.at(share)[0], meetings[share])
            if end is not None:
                changed = self._point(line.at(end.share)[0], end.label)
                following = (
                    self._goes_on(line, end.share) if end.order_changes else None
                )
                if following is not None and end.label == Meeting.end:
                    changed = replace(changed, label=Meeting.regular)
                yield changed
                if following is None:
                    self.end = end.reason
                    return
            yield self._point(following, Meeting.regular)
            state = following

    def _met(self, line: Line[Cycle]) -> dict[float, Meeting]:
        """Shares of a step at which something else happens."""
        by_share: dict[float, Meeting] = {}
        first, last = (line.known[share][0].point for share in (0.0, 1.0))
        if self.curve.label in RETURNS and all(
            abs(self.curve.least_margin(point)[0]) <= ZERO_ROUND_OFF
            for point in (first, last)
        ):
            # all along the curve the branch turns where the events change: the return map has no
            # derivative there, and round-off would decide its multipliers
            return by_share
        for label, test in self.curve.tests().items():
            if test(first) * test(last) < 0.0:
                share = line.root(partial(_at_point, test))
                # with two states folds and period doublings meet a grazing at the same point
                if share is not None and all(
                    abs(share - other) > 1e-6 for other in by_share
                ):
                    by_share[share] = label
        return by_share

    def _goes_on(self, line: Line[Cycle], share: float) -> ContinuationState | None:
        """The curve's next point with the events that motions have beyond where these change."""
        here, old = line.at(share), self.curve
        for beyond in (1e-6, 1e-4, 1e-2) if old.label in RETURNS else ():
            try:
                state, cycle = line.at(share + beyond)
            except ArithmeticError:
                continue
            continued = run_of(cycle)
            if continued is None or order_of(continued[0].events) == order_of(
                cycle.map.events
            ):
                continue
            self.curve = replace(old, map=continued[0])
            angle = state.point[len(old.known(state.point)) :]
            guess = np.append(continued[1], angle)
            normal = np.zeros(len(continued[1]) + len(angle))
            size = continued[0].size
            normal[size : size + 2] = state.tangent[old.map.size : old.map.size + 2]
            self.curve.renew(guess)
            algorithm = replace(
                self.algorithm, settings=replace(precise_steps, max_iterations=20)
            )
            new = algorithm.solve(self.curve, guess, normal, branch_steps.first_step)
            if new is not None:
                moved = (
                    new.point[size : size + 2]
                    - here[0].point[old.map.size : old.map.size + 2]
                )
                # beyond this change of the parameters over a step a point is not next to the
                # change of the events
                near = np.abs(moved).max() < 1.0 * line.reach + 10.0 * beyond
                if near and self._is_cycle(new) and is_motion(self._cycle(new)):
                    return new
        self.curve = old
        return None

    def _is_cycle(self, state: ContinuationState) -> bool:
        return self._cycle(state).period > 0.0

    def _end(self, line: Line[Cycle]) -> _End | None:
        """The first end of the curve within a step."""
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
            ends.append(_End(share, met, why))
        least, key = self.curve.least_margin(point)
        if least < -ZERO_ROUND_OFF and key is not None:
            # a margin that vanishes all along, as that of a symmetric motion's other event, has
            # the sign of round-off
            start = self.curve.least_margin(line.known[0.0][0].point)[0]
            slack = ZERO_ROUND_OFF if start <= ZERO_ROUND_OFF else 0.0
            share = line.root(
                lambda there, _: self.curve.least_margin(there.point)[0] + slack
            )
            share = 0.0 if share is None else share
            state, cycle = line.at(share)
            first = self.curve.least_margin(state.point)[1]
            ends.append(self._changed(share, cycle, first))
        return min(ends, default=None)

    def _changed(self, share: float, cycle: Cycle, key: Margin | None) -> _End:
        if key is None:
            return _End(share, Meeting.end, "curve_lost")
        label = label_of(cycle, {key: 0.0})
        met = Meeting.end
        if key.kind == MarginKind.length:
            met = Meeting.end_of_leg
        elif label == Label.stick_onset:
            met = Meeting.stick_onset
        elif label == Label.grazing:
            met = {
                Label.fold: Meeting.fold_grazing,
                Label.period_doubling: Meeting.flip_grazing,
            }.get(self.curve.label, met)
        system, event = cycle.map.flow.system, cycle.map.events[key.leg]
        watched = (system.joint.falls, system.joint.rises)
        number = event.switch
        if key.kind in {MarginKind.touch, MarginKind.edge}:
            number = int(max(of(event.before)[key.which] for of in watched))
        names = [*(switch.name for switch in system.switches), *system.stops]
        reason = f"order_changes_{key.kind.name}_of_{names[number]}".replace(" ", "_")
        return _End(share, met, reason, order_changes=True)

    def _cycle(self, state: ContinuationState) -> Cycle:
        return self.curve.cycle(state.point)

    def _point(self, state: ContinuationState, label: Meeting) -> CurvePoint:
        return CurvePoint(self._cycle(state), state.residual, label)


def follow_curve(
    cycle: Cycle,
    label: Label,
    parameters: Sequence[str],
    limits: Mapping[str, tuple[float, float]],
    n_points: int,
) -> tuple[list[CurvePoint], list[str]]:
    """Return the points of a curve through a cycle, and why it ended at both sides.

    Args:
        limits: parameter → (lowest, highest), in its unit.
    """
    scaled = {
        name: (low / cycle.scale_of(name), high / cycle.scale_of(name))
        for name, (low, high) in limits.items()
    }
    units = np.array([max(abs(cycle.parts.values[name]), 1e-3) for name in parameters])
    flow = cycle.map.flow.following(*parameters)
    curve, guess = curve_of(Cycle.at(*cycle.followed_in(flow, units)), label)
    curve.renew(guess)
    algorithm = PseudoArclength(
        replace(precise_steps, max_iterations=20), 0, own_tangent=True
    )
    normals = np.eye(len(guess))[[curve.map.size + 1, curve.map.size]]
    starts = (
        algorithm.solve(curve, guess, normal, branch_steps.first_step)
        for normal in normals
    )
    first = next((start for start in starts if start is not None), None)
    if first is None:
        raise ValueError(f"start: no curve of {label.name} is found there")
    ways = [_Way(replace(curve), scaled) for _ in range(2)]
    if ways[0].inside(first.point) < 0.0:
        raise ValueError(f"to = {limits!r}: the start lies outside")
    runs_of = [
        way.points(replace(first, tangent=sign * first.tangent))
        for way, sign in zip(ways, (-1.0, 1.0), strict=True)
    ]
    sides: list[list[CurvePoint]] = [[], []]
    open_ways, count = [0, 1], 1
    while open_ways and count < n_points:
        for side in list(open_ways):
            point = next(runs_of[side], None) if count < n_points else None
            if point is not None:
                sides[side].append(point)
                count += 1
            elif count < n_points:
                open_ways.remove(side)
    middle = CurvePoint(curve.cycle(first.point), first.residual)
    return [*sides[0][::-1], middle, *sides[1]], [way.end for way in ways]
