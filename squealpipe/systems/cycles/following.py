"""A branch of cycles as it is followed: steps that are sure to stay on it, and what lies in them.

Pseudo-arclength continuation of an event map. A step is accepted only if the branch does not turn
round in it and multipliers change by little; a solution that is not a motion of the system ends the
smooth piece where the first margin is zero, and the branch goes on with other events from there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from squealpipe.systems.branch_labels import Label
from squealpipe.systems.branch_line import ZERO_ROUND_OFF, Line
from squealpipe.systems.continuation import ContinuationState
from squealpipe.systems.cycles.admissible import margins
from squealpipe.systems.cycles.event_map import PhaseCondition
from squealpipe.systems.cycles.event_order import NewOrder, label_of, least_margin
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.cycles.line import (
    TESTS,
    Test,
    along_branch,
    at_edge,
    at_special_points,
    branch_steps,
    branching_label,
    explains,
    hides_folds,
    is_torus,
    multiplier_change,
    next_length,
    unstable,
)
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.cycles.trail import BranchPoint, Trail
from squealpipe.systems.datasets import Outcome
from squealpipe.systems.progress import alone


@dataclass(frozen=True)
class BranchFollowing:
    """Limits of the steps along a branch of cycles. Steps are without units; shares are of one
    step.
    """

    multiplier_change: float = 1.0
    """A multiplier may change by so much, relative to itself, in a step; more, and a special point
    might be passed unseen."""
    finest_step: float = 1e-6
    """A shorter step is taken as it is, whatever its multipliers do: next to a singular point they
    change at any step."""
    fold_at_change: float = 1e-5
    """A fold closer than this before a change of the events is that change."""
    vertical: float = 1e-9
    """A branch whose parameter changes by less than this over the cycle is a family of cycles at
    one value."""
    homoclinic: float = 1e-8
    """Relative distance of the parameter from a homoclinic orbit within which round-off decides
    the multipliers."""
    before_change: float = 1e-9
    """Multipliers are followed up to this share before a change of the events; a grazing takes
    them through infinity there."""


limits = BranchFollowing()


def _changes_sign(
    test: Test,
    first: tuple[ContinuationState, Cycle],
    last: tuple[ContinuationState, Cycle],
) -> bool:
    product = test(*first) * test(*last)
    return bool(np.isfinite(product) and product < 0.0)


def _is_vertical(state: ContinuationState, cycle: Cycle) -> bool:
    """Tell whether a branch goes on at one value of the parameter, through a family of cycles."""
    return abs(float(state.tangent[-1])) <= limits.vertical and cycle.is_family_member


def _jumps(line: Line[Cycle], share: float, beyond: Cycle) -> bool:
    """Return whether the stability is another one beyond a change of the events."""
    if share <= limits.before_change:
        return False
    return line.at(share - limits.before_change)[1].is_stable != beyond.is_stable


def _closeness(offset: Vector, parts: int, _: ContinuationState, cycle: Cycle) -> float:
    return float(offset @ cycle.after_part(parts))


@dataclass(frozen=True)
class BranchStep:
    """Result of one step: special points passed, new state, whether to record it, end reason."""

    special: list[BranchPoint]
    state: ContinuationState
    cycle: Cycle
    shows: bool = True
    end: Outcome | None = None


class Follower:
    """A branch as it is followed."""

    def __init__(self, low: float, high: float, most: int) -> None:
        self.low, self.high, self.most = low, high, most
        self.trail = Trail()

    @property
    def points(self) -> list[BranchPoint]:
        """The points so far."""
        return self.trail.points

    def run(self, state: ContinuationState, cycle: Cycle) -> Outcome:
        """Follow the branch to its end, and label it."""
        with alone() as show:
            end = self._run(state, cycle, show)
        if end == Outcome.equilibrium:
            self.points[-1] = replace(self.points[-1], rest=self.trail.rest())
        if end == Outcome.tongue_end:
            # at a cycle of a part of the period the parameter turns back, which is not a fold
            self.points[-2:] = [
                replace(point, label=Label.regular)
                if self.trail.is_met(point)
                else point
                for point in self.points[-2:]
            ]
        if end == Outcome.family_member:
            self._clear_labels(limits.vertical)
            self.points[-1] = replace(self.points[-1], label=Label.family_member)
        if end == Outcome.period_unbounded:
            self._clear_labels(limits.homoclinic)
        if not self.points[-1].label:
            self.points[-1] = replace(self.points[-1], label=Label.end)
        return end

    def _run(
        self, state: ContinuationState, cycle: Cycle, show: Callable[[float], None]
    ) -> Outcome:
        self.trail.add(BranchPoint(state, cycle))
        if _is_vertical(state, cycle):
            return Outcome.family_member  # the start is in the family
        while len(self.points) < self.most:
            show(self._share())
            advance = self._advance(state, cycle)
            if advance is None:
                return self.trail.reason()
            for point in advance.special[: self.most - len(self.points)]:
                self.trail.add(point)
            state, cycle = advance.state, advance.cycle
            if len(self.points) >= self.most:
                break
            if advance.end is not None:
                return advance.end
            if advance.shows:
                self.trail.add(BranchPoint(state, cycle))
            end = self._end_at(state, cycle)
            if end is not None:
                return end
        return Outcome.point_limit

    def _end_at(self, state: ContinuationState, cycle: Cycle) -> Outcome | None:
        """Return why the branch ends at its last point, None if it does not."""
        if _is_vertical(state, cycle):
            return Outcome.family_member
        if self._is_at_end(self.points[-1].parameter):
            return Outcome.converged
        gone = 1e-5
        if self.trail.has_shrunk(cycle, gone):
            return Outcome.equilibrium
        if self.trail.stands_still and self.trail.is_unbounded:
            return Outcome.period_unbounded
        return self.trail.meets()

    def _clear_labels(self, share: float) -> None:
        """Remove the labels of points whose parameter is next to the last one's.

        Round-off turns a vertical piece, whose outermost cycle just touches a surface, into folds,
        and cycles next to a homoclinic orbit into pitchforks.
        """
        here = self.points[-1].parameter
        for i, point in enumerate(self.points):
            if math.isclose(point.parameter, here, rel_tol=share):
                self.points[i] = replace(point, label=Label.regular)

    def _share(self) -> float:
        """Return the share of the range that is followed, or of the points, whichever is larger."""
        first, here = (self.points[i].parameter for i in (0, -1))
        rooms = (self.high - first, first - self.low)
        way = max(abs(here - first) / room for room in rooms if room > 0)
        return max(min(way, 1.0), len(self.points) / self.most)

    def _is_at_end(self, parameter: float) -> bool:
        return any(
            abs(parameter - edge) <= 1e-12 * max(abs(edge), 1e-300)
            for edge in (self.low, self.high)
            if math.isfinite(edge)
        )

    def _advance(self, state: ContinuationState, cycle: Cycle) -> BranchStep | None:
        """The next step that is shown to be on the same branch."""
        step, equations = state.step, cycle.map
        while step >= branch_steps.shortest_step:
            trial = replace(state, step=step)
            following = at_edge(equations, trial, self.low, self.high)
            if following is None:
                following = along_branch.attempt(equations, trial)
            if following is not None:
                reached = Cycle.at(equations, following.point)
                if not self._strays(trial, cycle, following, reached):
                    examined = self._examined(trial, cycle, following, reached)
                    if examined is not None:
                        return examined
            step *= 0.5
        return None

    def _strays(
        self,
        state: ContinuationState,
        cycle: Cycle,
        following: ContinuationState,
        reached: Cycle,
    ) -> bool:
        """Return whether a step is too long to be sure of what lies in it."""
        if (
            reached.period <= 0.0
            or float(following.tangent @ state.tangent) < branch_steps.least_cosine
        ):
            return True
        section = cycle.map.section
        if section is not None and float(section.normal @ reached.heading) <= 0.0:
            return True  # beyond a state of rest
        if (
            not self.low - ZERO_ROUND_OFF
            <= reached.followed[-1]
            <= self.high + ZERO_ROUND_OFF
        ):
            return True
        if state.step < limits.finest_step:
            return False
        if hides_folds(state, following):
            return True
        one, other = cycle.multipliers, reached.multipliers
        finite = np.isfinite(one).all() and np.isfinite(other).all()
        small = finite and max(np.abs(one).max(), np.abs(other).max()) < 100.0
        return bool(
            small and multiplier_change(cycle, reached) > limits.multiplier_change
        )

    def _examined(
        self,
        state: ContinuationState,
        cycle: Cycle,
        following: ContinuationState,
        reached: Cycle,
    ) -> BranchStep | None:
        """A step with what lies in it; None where that is not clear."""
        line = Line(
            at_special_points,
            cycle.map,
            (state, cycle),
            (following, reached),
            partial(Cycle.at, cycle.map),
        )
        before, after = (least_margin(None, each) for each in (cycle, reached))
        last = 1.0 if after >= -ZERO_ROUND_OFF else line.root(least_margin)
        smooth = None if last is None else self._smooth(line, last)
        if smooth is None or last is None:
            return None
        # a step that ends at the change to round-off may not lead past it
        if last < 1.0 or after < ZERO_ROUND_OFF < 0.5 * before:
            return self._changed(line, smooth, last)
        near, share = self._shorter(line, cycle, reached)
        if near and share is None and state.step > limits.finest_step:
            return None
        if share is not None:
            special = [
                BranchPoint(*line.at(at), label)
                for at, label in smooth
                if at < share - limits.fold_at_change
            ]
            there = line.at(share)
            return BranchStep(
                [*special, BranchPoint(*there)], *there, end=Outcome.tongue_end
            )
        special = [BranchPoint(*line.at(share), label) for share, label in smooth]
        following = replace(following, step=next_length(state, following))
        return BranchStep(special, *renewed(following, reached))

    def _smooth(
        self, line: Line[Cycle], last: float
    ) -> list[tuple[float, Label]] | None:
        """Shares and labels of what happens in a step, in order; None where one is not found."""
        first, reached, specials = line.known[0.0], line.known[1.0], []
        if self.trail.has_shrunk(reached[1]):
            return []
        # a grazing takes multipliers through infinity: they are followed up to it alone
        before = 1.0 if last >= 1.0 else last - limits.before_change
        for label, test in TESTS:
            end = 1.0 if label == Label.fold else before
            if end <= 0.0:
                continue
            try:
                crosses = _changes_sign(test, first, line.at(end))
            except ArithmeticError:
                return None
            if not crosses or not self._is_new(label, line, end):
                continue
            share = line.root(test, end)
            if share is None:
                return None
            if label == Label.torus and not is_torus(line.at(share)[1]):
                continue
            if label == Label.pitchfork:
                label = branching_label(line.at(share)[1])
            if share < last - limits.fold_at_change * (
                label == Label.fold and last < 1.0
            ):
                specials.append((share, label))
        return sorted(specials) if self._explains(line, before, specials) else None

    def _is_new(self, label: Label, line: Line[Cycle], end: float) -> bool:
        """Return whether a sign change is neither a fold nor the noise of a family of cycles."""
        if label != Label.pitchfork:
            return True
        ends = line.known[0.0], line.at(end)
        folds = ends[0][0].tangent[-1] * ends[1][0].tangent[-1] < 0.0
        return not (folds or any(cycle.is_family_member for _, cycle in ends))

    def _explains(
        self, line: Line[Cycle], end: float, found: list[tuple[float, Label]]
    ) -> bool:
        """Return whether the labels explain why the number of unstable multipliers changes."""
        (state, cycle), (_, reached) = line.known[0.0], line.known[1.0]
        if end <= 0.0 or state.step < limits.finest_step:
            return True
        if end < 1.0:
            reached = line.at(end)[1]
        multipliers = np.append(cycle.multipliers, reached.multipliers)
        if not np.isfinite(multipliers).all():
            return True
        change = unstable(reached) - unstable(cycle)
        return explains(change, [label for _, label in found])

    def _changed(
        self, line: Line[Cycle], found: list[tuple[float, Label]], last: float
    ) -> BranchStep | None:
        """A step to where the order of the events changes, and round that; None if unclear."""
        state, there = line.known[0.0][0], line.at(last)
        if self.trail.has_shrunk(there[1]):
            return BranchStep([BranchPoint(*there)], *there, end=Outcome.equilibrium)
        zero = {k: v for k, v in margins(there[1]).items() if abs(v) < 1e-7}
        label = label_of(there[1], zero)
        turned = NewOrder(line, last, there, zero).way_on()
        if turned is not None and not label and _jumps(line, last, turned[1]):
            label = Label.border_collision
        special = [BranchPoint(*line.at(share), each) for share, each in found]
        special += [BranchPoint(*there, label)] if label or turned is None else []
        if turned is not None:
            return BranchStep(
                special, replace(turned[0], step=state.step), turned[1], shows=not label
            )
        # no change of the events that is understood: nearer, perhaps
        if state.step > 1e3 * branch_steps.shortest_step:
            return None
        return BranchStep(
            special, *there, end=Outcome.tangency if label else self.trail.reason()
        )

    def _shorter(
        self, line: Line[Cycle], cycle: Cycle, reached: Cycle
    ) -> tuple[bool, float | None]:
        """Return whether a cycle of a part of the period may lie in a step, and at which share it
        is met.
        """
        for parts in (2, 3):
            offset, later = cycle.after_part(parts), reached.after_part(parts)
            if offset @ later < -0.2 * float(offset @ offset):
                return True, line.root(partial(_closeness, offset, parts))
            if np.linalg.norm(later - offset) > 0.7 * np.linalg.norm(offset):
                return True, None
        return False, None


def renewed(state: ContinuationState, cycle: Cycle) -> tuple[ContinuationState, Cycle]:
    """Return the same point of a branch without events, with a section of its own."""
    equations = cycle.map
    if equations.section is None:
        return state, cycle
    normal = cycle.heading / np.linalg.norm(cycle.heading)
    section = PhaseCondition(cycle.parts.states[0], normal)
    tangent = state.tangent.copy()
    tangent[: len(normal)] -= normal * (normal @ tangent[: len(normal)])
    state = replace(state, tangent=tangent / np.linalg.norm(tangent))
    return state, replace(cycle, map=replace(equations, section=section))
