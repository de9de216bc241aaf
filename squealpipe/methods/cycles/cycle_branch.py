"""Branches of periodic motions in one parameter, with located special points.

Pseudo-arclength continuation of the return map. A step is accepted only if at most one change of
the events lies along it, the multipliers and the cycle's shape change by little, and the branch
does not turn round in it, so that a branch cannot be left unnoticed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from squealpipe.methods.continuation import (
    ContinuationSettings,
    ContinuationState,
    PseudoArclength,
)
from squealpipe.methods.cycles.branch_ends import (
    BranchEnd,
    BranchPoint,
    CycleBranchSettings,
    has_shrunk,
)
from squealpipe.methods.cycles.corners import around_corner
from squealpipe.methods.cycles.cycle_equations import (
    CycleEquations,
    anchor,
    cycle_algorithm,
    cycle_at,
)
from squealpipe.methods.cycles.cycles import Cycle, multiplier_change
from squealpipe.methods.cycles.event_changes import EventChange, event_change, same_events
from squealpipe.methods.cycles.event_flow import Touch, Vector
from squealpipe.methods.cycles.labels import Label
from squealpipe.methods.cycles.shorter_cycles import after_part, at_crossing, is_shorter
from squealpipe.methods.cycles.special_points import (
    LABELS,
    Located,
    Test,
    hides_folds,
    locate,
    special_tests,
)

_AT_REST = 1e-6
"""A cycle of this size, over the scale of the branch, is a state of rest."""
_HALVINGS_TO_CORNER = 2
_EASY, _GROWTH = 3, 3.0
"""With no more than so many iterations the next step may grow, by no more than this factor."""
_TURN = 0.7
"""Turn of the branch over the largest one that the next step is meant for."""
_COARSE = 1e-6
"""Step below which several changes of the events at once are one change."""
_KINKS = {Touch.touch, Touch.split}
"""Changes of the events at which a branch may have a corner."""
_MET = 0.03
"""Distance from a shorter cycle, over the scale, below which the equations are next to singular."""
_SAME = 1e-3
"""Distance from an older piece of the branch, over that piece, that is on it."""


@dataclass(frozen=True)
class _Step:
    """An accepted step, the special points that lie in it, and whether the branch ends there."""

    state: ContinuationState
    cycle: Cycle
    located: list[tuple[Label, Located]]
    end: BranchEnd | None = None


class _Refused(IntEnum):
    """Why a step was not accepted."""

    too_long = 0
    several_changes = 1


def follow_cycles(
    equations: CycleEquations,
    start: ContinuationState,
    settings: CycleBranchSettings,
    steps: ContinuationSettings,
) -> tuple[list[BranchPoint], BranchEnd]:
    """Follow a branch until it leaves the range of its parameter.

    Args:
        equations: the return map; its phase condition is renewed at each point.
        start: a solution with an oriented tangent.
        settings: range and limits.
        steps: step control.

    Returns:
        (points, why it ended); the last point is labelled as the end.
    """
    return _Follower(equations, settings, cycle_algorithm(steps)).run(start)


class _Follower:
    """A branch as it is followed."""

    def __init__(
        self, equations: CycleEquations, settings: CycleBranchSettings, algorithm: PseudoArclength
    ) -> None:
        self.equations = equations
        self.settings = settings
        self.algorithm = algorithm
        self.points: list[BranchPoint] = []
        self.shapes: list[Vector] = []
        self.at_rest = False
        self.no_corner = 0.0

    def run(self, start: ContinuationState) -> tuple[list[BranchPoint], BranchEnd]:
        end = self._run(start)
        self.points[-1] = replace(self.points[-1], label=Label.end)
        return self.points, end

    def _run(self, start: ContinuationState) -> BranchEnd:
        equations = self.equations
        state, cycle = anchor(equations, start, cycle_at(equations, start))
        self._add(state, cycle, Label.regular)
        while True:
            step = self._advance(state, cycle)
            if step is None:
                return self._reason(cycle)
            if len(self.points) + len(step.located) + 1 > self.settings.max_points:
                return BranchEnd.point_limit
            for label, (special, there) in step.located:
                self._add(special, there, label)
            state, cycle = anchor(equations, step.state, step.cycle)
            self._add(state, cycle, Label.regular)
            for end in (step.end, self._arrival(), self._meeting()):
                if end is not None:
                    return end

    def _add(self, state: ContinuationState, cycle: Cycle, label: Label) -> None:
        parameter = self.equations.unpack(state.point)[2]
        edges = (self.settings.low, self.settings.high)
        parameter = next((e for e in edges if self._is_at(parameter, e)), parameter)
        self.points.append(BranchPoint(parameter, cycle, label, state))
        self.shapes.append(self._shape(state, cycle))

    def _is_at(self, parameter: float, edge: float) -> bool:
        return abs(parameter - edge) < 1e-12 * self.equations.unit

    def _shape(self, state: ContinuationState, cycle: Cycle) -> Vector:
        """What does not depend on the phase: parameter, period, extrema of x and y; scaled."""
        return np.concatenate([state.point[5:3:-1], cycle.extent.ravel() / cycle.scale[0]])

    def _arrival(self) -> BranchEnd | None:
        """Whether the last point is at an end of the parameter's range."""
        here, start = self.points[-1].parameter, self.points[0].parameter
        if here not in (self.settings.low, self.settings.high):
            return None
        return BranchEnd.returned if self._is_at(here, start) else BranchEnd.arrived

    def _meeting(self) -> BranchEnd | None:
        """Whether the last step lies on an older piece of the branch."""
        shapes = np.array(self.shapes)
        if len(shapes) < 6:
            return None
        ahead = shapes[-1] - shapes[-2]
        pieces = np.diff(shapes[:-3], axis=0)
        squared = np.maximum((pieces**2).sum(axis=1), 1e-300)
        offset = shapes[-1] - shapes[:-4]
        share = np.clip((offset * pieces).sum(axis=1) / squared, 0.0, 1.0)
        distance = np.linalg.norm(offset - share[:, None] * pieces, axis=1)
        cosine = (pieces @ ahead) / np.sqrt(squared) / max(float(np.linalg.norm(ahead)), 1e-300)
        limit = _SAME * np.minimum(np.sqrt(squared), np.linalg.norm(ahead))
        if ((distance < limit) & (cosine > 0.99)).any():
            return BranchEnd.closed
        return BranchEnd.retraced if ((distance < limit) & (cosine < -0.99)).any() else None

    def _advance(self, state: ContinuationState, cycle: Cycle) -> _Step | None:
        """The next point that is shown to be on the same branch; None where there is none.

        A step that is shortened only to separate changes of the events or special points has its
        length back behind them.
        """
        step, shortest = state.step, self.algorithm.settings.shortest_step
        wanted, failures = 0.0, 0
        self.at_rest = False
        while step >= shortest:
            trial = replace(state, step=step)
            following = self._edge(trial)
            if following is None:
                following = self.algorithm.attempt(
                    self.equations, trial, least_cosine=0.1 if failures > 1 else None
                )
            verdict: _Step | _Refused = _Refused.too_long
            if following is not None:
                reached = cycle_at(self.equations, following)
                if self._same_way(cycle, reached):
                    verdict = self._judge(trial, cycle, following, reached)
                elif not cycle.passage.event_kinds and not reached.passage.event_kinds:
                    self.at_rest = True
                    return None
            if isinstance(verdict, _Step):
                length = max(self._next_length(state, step, verdict.state), wanted)
                length = min(length, self.algorithm.settings.longest_step)
                return replace(verdict, state=replace(verdict.state, step=length))
            if verdict == _Refused.several_changes:
                wanted = max(wanted, step)
            else:
                failures += 1
                tried = 0.1 * self.no_corner < step < 10.0 * self.no_corner
                corner = None
                if failures == _HALVINGS_TO_CORNER and not tried:
                    corner, self.no_corner = self._corner(trial, cycle), step
                if corner is not None:
                    self.no_corner = 0.0
                    return replace(corner, state=replace(corner.state, step=state.step))
            step *= 0.5
        return None

    def _next_length(
        self, state: ContinuationState, step: float, following: ContinuationState
    ) -> float:
        """The step after this one: longer, but not so that the branch turns by too much in it."""
        most = np.arccos(self.algorithm.settings.least_cosine)
        turn = float(np.linalg.norm(following.tangent - state.tangent))
        growth = _GROWTH if following.iterations <= _EASY else 1.0
        return step * float(np.clip(_TURN * most / max(turn, 1e-300), 0.5, growth))

    def _judge(
        self,
        state: ContinuationState,
        cycle: Cycle,
        following: ContinuationState,
        reached: Cycle,
    ) -> _Step | _Refused:
        """The step if it is accepted, else why not."""
        parameter = float(following.point[5] * self.equations.unit)
        margin = 1e-9 * self.equations.unit
        if not self.settings.low - margin <= parameter <= self.settings.high + margin:
            return _Refused.too_long
        for parts in (2, 3):
            offset, after = after_part(cycle, parts), after_part(reached, parts)
            if offset @ after < -0.2 * float(offset @ offset):
                return self._shorter((state, cycle), (following, reached), offset, parts)
            if np.linalg.norm(after - offset) > 0.7 * np.linalg.norm(offset):
                return _Refused.too_long  # perhaps on the shorter cycle, or beyond it
        return self._check(state, cycle, following, reached)

    def _check(
        self,
        state: ContinuationState,
        cycle: Cycle,
        following: ContinuationState,
        reached: Cycle,
    ) -> _Step | _Refused:
        """The step with what lies in it, if that is shown to be all."""
        fine = state.step < _COARSE
        change = None if same_events(cycle, reached) else event_change(cycle, reached)
        if change is None and not same_events(cycle, reached) and not fine:
            return _Refused.several_changes
        if self._strays(state, cycle, following, reached, change):
            return _Refused.too_long
        tests = special_tests(state, cycle, following, reached, change)
        if (len(tests) > 1 or hides_folds(state, following)) and not fine:
            return _Refused.several_changes
        step = _Step(following, reached, self._locate((state, cycle), (following, reached), tests))
        if len(step.located) < len(tests) and not fine:
            return _Refused.several_changes
        if change is not None and change.touch in _KINKS:
            return step if self._passes(following, step.located, change) else _Refused.too_long
        return step

    def _strays(
        self,
        state: ContinuationState,
        cycle: Cycle,
        following: ContinuationState,
        reached: Cycle,
        change: EventChange | None,
    ) -> bool:
        """Whether the branch turns by much, or its multipliers or shape change by much."""
        kink = change is not None and change.touch in _KINKS
        turn = float(following.tangent @ state.tangent)
        if not kink and turn < self.algorithm.settings.least_cosine:
            return True
        smooth = change is None and state.step > _COARSE
        if smooth and multiplier_change(cycle, reached) > self.settings.largest_change:
            return True
        return self._turns_round(self._shape(following, reached))

    def _locate(
        self,
        before: Located,
        after: Located,
        tests: list[tuple[Label, Test]],
    ) -> list[tuple[Label, Located]]:
        return [
            (label, special)
            for label, test in tests
            if (special := locate(self.equations, self.algorithm, before, after, test))
        ]

    def _passes(
        self,
        after: ContinuationState,
        located: list[tuple[Label, Located]],
        change: EventChange,
    ) -> bool:
        """Whether a branch with a corner leads through it forwards, not back from it."""
        for label, (corner, cycle) in located:
            if label == LABELS[change.touch]:
                beyond = (after.point - corner.point) @ after.tangent
                size = max(abs(change.distance(self.points[-1].cycle)), 1e-300)
                return bool(beyond > 0.0 and abs(change.distance(cycle)) < 1e-6 * size)
        return False

    def _shorter(
        self, before: Located, after: Located, offset: Vector, parts: int
    ) -> _Step | _Refused:
        """The point where the state after a part of the period is the initial one."""
        met = locate(
            self.equations,
            self.algorithm,
            before,
            after,
            lambda _, here: float(offset @ after_part(here, parts)),
        )
        if met is None or not is_shorter(met[1], parts, 1e-5, 1e-5):
            return _Refused.too_long
        step = self._check(*before, at_crossing(before[0], met[0]), met[1])
        return replace(step, end=BranchEnd.shorter) if isinstance(step, _Step) else step

    def _turns_round(self, shape: Vector) -> bool:
        """Whether the shape goes back where it came from."""
        if len(self.shapes) < 2:
            return False
        before, ahead = self.shapes[-1] - self.shapes[-2], shape - self.shapes[-1]
        product = float(np.linalg.norm(before) * np.linalg.norm(ahead))
        return bool(before @ ahead < -0.5 * product) and product > 1e-18

    def _same_way(self, cycle: Cycle, reached: Cycle) -> bool:
        """Whether two cycles move the same way at their start, and move at all."""
        heading = reached.heading
        return bool(
            heading @ cycle.heading > 0.0 and np.linalg.norm(heading) > _AT_REST * 2.0 * np.pi
        )

    def _corner(self, state: ContinuationState, cycle: Cycle) -> _Step | None:
        """Go round a corner; the touch becomes a point of its own."""
        found = around_corner(self.equations, self.algorithm, state, cycle)
        if found is None:
            return None
        (touched, there), way_on = found
        if way_on is None:
            ends = cycle.system.jumps and cycle.system.is_tangent(there.passage)
            return _Step(touched, there, [], BranchEnd.tangency) if ends else None
        beyond, other, change = way_on
        if self._turns_round_at(self._shape(touched, there), self._shape(beyond, other)):
            return None
        if state.step > _COARSE and hides_folds(state, touched):
            return None
        label = LABELS.get(change.touch, Label.regular)
        tests = special_tests(state, cycle, touched, there, None)
        located = self._locate((state, cycle), (touched, there), tests)
        return _Step(beyond, other, [*located, (label, (touched, there))])

    def _turns_round_at(self, corner: Vector, beyond: Vector) -> bool:
        """Whether the way on from a corner is the way that led to it."""
        before, ahead = self.shapes[-1] - corner, beyond - corner
        product = float(np.linalg.norm(before) * np.linalg.norm(ahead))
        return bool(before @ ahead > (1.0 - 1e-6) * product)

    def _edge(self, state: ContinuationState) -> ContinuationState | None:
        """The point at the end of the parameter's range, if the next step would leave it."""
        equations, settings = self.equations, self.settings
        length = state.step * (1.0 + float(np.linalg.norm(state.point)))
        ahead = (state.point[5] + length * state.tangent[5]) * equations.unit
        if settings.low < ahead < settings.high:
            return None
        edge = settings.low if ahead <= settings.low else settings.high
        share = (edge / equations.unit - state.point[5]) / state.tangent[5]
        if share <= 0.0:
            return None
        guess = state.point + share * state.tangent
        guess[5] = edge / equations.unit
        normal = np.zeros(6)
        normal[5] = np.copysign(1.0, state.tangent[5])
        found = self.algorithm.solve(equations, guess, normal, state.step)
        if found is None or float(np.linalg.norm(found.point - guess)) > 0.3 * length:
            return None
        return found

    def _reason(self, cycle: Cycle) -> BranchEnd:
        """Why no step leads on."""
        if self.at_rest or has_shrunk(self.points):
            return BranchEnd.at_rest
        if any(is_shorter(cycle, parts, _MET, _MET) for parts in (2, 3)):
            return BranchEnd.shorter
        if cycle.system.is_singular(cycle.passage):
            return BranchEnd.singular
        return BranchEnd.tangency if cycle.system.is_tangent(cycle.passage) else BranchEnd.lost
