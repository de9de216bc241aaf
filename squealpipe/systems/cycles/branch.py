"""Branches of cycles in one parameter, stable and unstable, with located special points.

Pseudo-arclength continuation of an event map. A step is accepted only if the branch does not turn
round in it and multipliers change by little; a solution that is not a motion of the system ends the
smooth piece where the first margin is zero, and the branch goes on with other events from there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy.interpolate import barycentric_interpolate

from squealpipe.methods.branch_line import Line
from squealpipe.methods.continuation import ContinuationState
from squealpipe.methods.progress import alone
from squealpipe.schema import Outcome, flag_table
from squealpipe.schema.branch_labels import Label
from squealpipe.systems.cycles.admissible import MARGIN_ROUND_OFF, margins
from squealpipe.systems.cycles.described import columns, describe_columns, outcome_of
from squealpipe.systems.cycles.event_map import FREE, EventMap, PhaseCondition
from squealpipe.systems.cycles.event_order import NewOrder, label_of, least_margin
from squealpipe.systems.cycles.find import find_cycle
from squealpipe.systems.cycles.flow import Flow, Vector
from squealpipe.systems.cycles.line import (
    ALONG,
    AT,
    STEPS,
    TESTS,
    Test,
    branching_label,
    explains,
    hides_folds,
    is_torus,
    multiplier_change,
    unstable,
)
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.labels import (
    attributes_of,
    components_of,
    flag,
    labels,
    regime_flag,
)
from squealpipe.validation import Number, Several, checked

if TYPE_CHECKING:
    from squealpipe.systems.definition import System

_EASY, _GROWTH = 3, 3.0
"""With no more than so many iterations the next step may grow, by no more than this factor."""
_TURN = 0.7
"""Turn of the branch over the largest one that the next step is meant for."""
_CHANGE = 1.0
"""Largest change of a multiplier between neighbouring points."""
_COARSE = 1e-6
"""Step below which a branch is taken as it is."""
_AT_REST = 1e-3
"""Size of a cycle, over the largest on its branch, below which one that shrinks comes to rest."""
_MET = 0.03
"""Distance from a cycle of a part of the period, over its extent, where a branch ends on it."""
_GONE = 1e-5
"""The same where it is not followed any further."""
_SAME = 1e-3
"""Distance from an older piece of the branch, over that piece, that is on it."""
_CLOSE = 1e-5
"""Share of a step before a change of the events in which a fold is that change."""
_BEFORE = 1e-9
"""Share before it up to which multipliers are followed."""


_CORNERS = {Label.grazing, Label.stick_onset, Label.border_collision}
"""Where the return map has no derivative."""


@dataclass(frozen=True)
class BranchPoint:
    """A cycle on a branch; ``rest`` is where one that has all but shrunk to rest has no size."""

    state: ContinuationState
    cycle: Cycle
    label: Label = Label.regular
    rest: float | None = None

    @property
    def parameter(self) -> float:
        """Value of the followed parameter."""
        return float(self.cycle.followed[-1]) if self.rest is None else self.rest


def _changes_sign(
    test: Test,
    first: tuple[ContinuationState, Cycle],
    last: tuple[ContinuationState, Cycle],
) -> bool:
    product = test(*first) * test(*last)
    return bool(np.isfinite(product) and product < 0.0)


def _jumps(line: Line[Cycle], share: float, beyond: Cycle) -> bool:
    """Whether the stability is another one beyond a change of the events."""
    if share <= _BEFORE:
        return False
    return line.at(share - _BEFORE)[1].is_stable != beyond.is_stable


def sizes_of(shapes: list[Vector]) -> Vector:
    """The largest extent of each cycle."""
    lowest, highest = np.split(np.array(shapes)[:, 2:], 2, axis=1)
    return np.asarray((highest - lowest).max(axis=1))


def _closeness(offset: Vector, parts: int, _: ContinuationState, cycle: Cycle) -> float:
    return float(offset @ cycle.after_part(parts))


@dataclass(frozen=True)
class BranchStep:
    """What a step has led past, where to, whether that is a point, and whether the branch ends."""

    special: list[BranchPoint]
    state: ContinuationState
    cycle: Cycle
    shows: bool = True
    end: Outcome | None = None


class Follower:
    """A branch as it is followed."""

    def __init__(self, low: float, high: float, most: int) -> None:
        self.low, self.high, self.most = low, high, most
        self.points: list[BranchPoint] = []
        self.shapes: list[Vector] = []

    def run(self, state: ContinuationState, cycle: Cycle) -> Outcome:
        """Follow the branch to its end, and label it."""
        with alone() as show:
            end = self._run(state, cycle, show)
        if end == Outcome.equilibrium:
            self.points[-1] = replace(self.points[-1], rest=self._rest())
        if end == Outcome.tongue_end:
            # at a cycle of a part of the period the parameter turns back, which is not a fold
            self.points[-2:] = [
                replace(point, label=Label.regular) if self._is_met(point) else point
                for point in self.points[-2:]
            ]
        if not self.points[-1].label:
            self.points[-1] = replace(self.points[-1], label=Label.end)
        return end

    def _run(
        self, state: ContinuationState, cycle: Cycle, show: Callable[[float], None]
    ) -> Outcome:
        self._add(BranchPoint(state, cycle))
        while len(self.points) < self.most:
            show(self._share())
            found = self._advance(state, cycle)
            if found is None:
                return self._reason()
            for point in found.special[: self.most - len(self.points)]:
                self._add(point)
            state, cycle = found.state, found.cycle
            if len(self.points) >= self.most:
                break
            if found.end is not None:
                return found.end
            if found.shows:
                self._add(BranchPoint(state, cycle))
            if self._is_at_end(self.points[-1].parameter):
                return Outcome.converged
            if self._has_shrunk(cycle, _GONE):
                return Outcome.equilibrium
            met = self._meets()
            if met is not None:
                return met
        return Outcome.point_limit

    def _share(self) -> float:
        """How much of the way to the end of the range is gone, or of the points."""
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

    def _add(self, point: BranchPoint) -> None:
        self.points.append(point)
        self.shapes.append(self._shape(point.cycle, point.state))

    def _shape(self, cycle: Cycle, state: ContinuationState) -> Vector:
        """What does not depend on the phase: parameter, period, extremes; without units."""
        first = self.points[0].cycle.map if self.points else cycle.map
        extremes = cycle.extremes[:, : len(first.scale)] / first.scale
        return np.array([state.point[-1], cycle.period / first.time, *extremes.ravel()])

    def _meets(self) -> Outcome | None:
        """Whether the last step lies on an older piece of the branch."""
        shapes = np.array(self.shapes)
        if len(shapes) < 6:
            return None
        ahead, pieces = shapes[-1] - shapes[-2], np.diff(shapes[:-3], axis=0)
        squared = np.maximum((pieces**2).sum(axis=1), 1e-300)
        offset = shapes[-1] - shapes[:-4]
        share = np.clip((offset * pieces).sum(axis=1) / squared, 0.0, 1.0)
        distance = np.linalg.norm(offset - share[:, None] * pieces, axis=1)
        length = max(float(np.linalg.norm(ahead)), 1e-300)
        cosine = (pieces @ ahead) / np.sqrt(squared) / length
        near = distance < _SAME * np.minimum(np.sqrt(squared), length)
        if (near & (cosine > 0.99)).any():
            return Outcome.closed
        return Outcome.retraced if (near & (cosine < -0.99)).any() else None

    def _is_met(self, point: BranchPoint) -> bool:
        """Whether a fold is where the branch ends on a cycle of a part of the period."""
        near = (
            min(float(np.linalg.norm(point.cycle.after_part(n))) for n in (2, 3)) < _MET
        )
        return near and point.label == Label.fold

    def _reason(self) -> Outcome:
        """Why no step leads on."""
        cycle = self.points[-1].cycle
        if self._has_shrunk(cycle):
            return Outcome.equilibrium
        second = float(np.abs(cycle.nontrivial - 1.0).min(initial=1.0))
        parts = [float(np.linalg.norm(cycle.after_part(n))) for n in (2, 3)]
        return (
            Outcome.tongue_end
            if min(parts) < _MET and second < _MET
            else Outcome.branch_lost
        )

    def _has_shrunk(self, cycle: Cycle, share: float = _AT_REST) -> bool:
        """Whether a cycle without forcing is next to a state of rest."""
        if cycle.map.periods:
            return False
        sizes = sizes_of([*self.shapes, self._shape(cycle, self.points[-1].state)])
        return bool(sizes[-1] < share * sizes[:-1].max())

    def _rest(self) -> float | None:
        """Where a shrinking cycle is at rest: the parameter is smooth in the square of its size.

        Of the smallest cycles round-off decides the parameter.
        """
        sizes, last = sizes_of(self.shapes), self.points[-1].parameter
        fit = np.flatnonzero(sizes > 0.2 * _AT_REST * sizes.max())[-3:]
        shapes = []
        for state, equations in (
            (self.points[i].state, self.points[i].cycle.map) for i in fit
        ):
            found = AT.solve(equations, state.point, state.tangent, 0.0)
            if found is not None:
                shapes.append(self._shape(Cycle.at(equations, found.point), found))
        if len(shapes) < 3:
            return None
        squares = (sizes_of(shapes) / sizes.max()) ** 2
        unit = float(self.points[-1].cycle.map.units[-1])
        beyond = np.array([shape[0] for shape in shapes]) * unit - last
        rest = float(barycentric_interpolate(squares, beyond, 0.0))
        return last + rest if abs(rest) < _AT_REST * np.abs(beyond).max() else None

    def _advance(self, state: ContinuationState, cycle: Cycle) -> BranchStep | None:
        """The next step that is shown to be on the same branch."""
        step, equations = state.step, cycle.map
        while step >= STEPS.shortest_step:
            trial = replace(state, step=step)
            following = self._edge(equations, trial)
            if following is None:
                following = ALONG.attempt(equations, trial)
            if following is not None:
                reached = Cycle.at(equations, following.point)
                if not self._strays(trial, cycle, following, reached):
                    found = self._examined(trial, cycle, following, reached)
                    if found is not None:
                        return found
            step *= 0.5
        return None

    def _strays(
        self,
        state: ContinuationState,
        cycle: Cycle,
        following: ContinuationState,
        reached: Cycle,
    ) -> bool:
        """Whether a step is too long to be sure of what lies in it."""
        if (
            reached.period <= 0.0
            or float(following.tangent @ state.tangent) < STEPS.least_cosine
        ):
            return True
        section = cycle.map.section
        if section is not None and float(section.normal @ reached.heading) <= 0.0:
            return True  # beyond a state of rest
        if (
            not self.low - MARGIN_ROUND_OFF
            <= reached.followed[-1]
            <= self.high + MARGIN_ROUND_OFF
        ):
            return True
        if state.step < _COARSE:
            return False
        if hides_folds(state, following):
            return True
        one, other = cycle.multipliers, reached.multipliers
        finite = np.isfinite(one).all() and np.isfinite(other).all()
        small = finite and max(np.abs(one).max(), np.abs(other).max()) < 100.0
        return bool(small and multiplier_change(cycle, reached) > _CHANGE)

    def _examined(
        self,
        state: ContinuationState,
        cycle: Cycle,
        following: ContinuationState,
        reached: Cycle,
    ) -> BranchStep | None:
        """A step with what lies in it; None where that is not clear."""
        line = Line(
            AT,
            cycle.map,
            (state, cycle),
            (following, reached),
            partial(Cycle.at, cycle.map),
        )
        before, after = (least_margin(None, each) for each in (cycle, reached))
        last = 1.0 if after >= -MARGIN_ROUND_OFF else line.root(least_margin)
        found = None if last is None else self._smooth(line, last)
        if found is None or last is None:
            return None
        # a step that ends at the change to round-off may not lead past it
        if last < 1.0 or after < MARGIN_ROUND_OFF < 0.5 * before:
            return self._changed(line, found, last)
        near, share = self._shorter(line, cycle, reached)
        if near and share is None and state.step > _COARSE:
            return None
        if share is not None:
            special = [
                BranchPoint(*line.at(at), label)
                for at, label in found
                if at < share - _CLOSE
            ]
            there = line.at(share)
            return BranchStep(
                [*special, BranchPoint(*there)], *there, end=Outcome.tongue_end
            )
        special = [BranchPoint(*line.at(share), label) for share, label in found]
        following = replace(following, step=self._next_length(state, following))
        return BranchStep(special, *renewed(following, reached))

    def _smooth(
        self, line: Line[Cycle], last: float
    ) -> list[tuple[float, Label]] | None:
        """Shares and labels of what happens in a step, in order; None where one is not found."""
        first, reached, found = line.known[0.0], line.known[1.0], []
        if self._has_shrunk(reached[1]):
            return []
        # a grazing takes multipliers through infinity: they are followed up to it alone
        before = 1.0 if last >= 1.0 else last - _BEFORE
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
            if share < last - _CLOSE * (label == Label.fold and last < 1.0):
                found.append((share, label))
        return sorted(found) if self._explains(line, before, found) else None

    def _is_new(self, label: Label, line: Line[Cycle], end: float) -> bool:
        """Whether a sign change is not that of a fold, or the noise of a family of cycles."""
        if label != Label.pitchfork:
            return True
        ends = line.known[0.0], line.at(end)
        folds = ends[0][0].tangent[-1] * ends[1][0].tangent[-1] < 0.0
        return not (folds or any(cycle.is_family_member for _, cycle in ends))

    def _explains(
        self, line: Line[Cycle], end: float, found: list[tuple[float, Label]]
    ) -> bool:
        """Whether the labels are why the number of unstable multipliers changes."""
        (state, cycle), (_, reached) = line.known[0.0], line.known[1.0]
        if end <= 0.0 or state.step < _COARSE:
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
        if self._has_shrunk(there[1]):
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
        if state.step > 1e3 * STEPS.shortest_step:
            return None
        return BranchStep(
            special, *there, end=Outcome.tangency if label else self._reason()
        )

    def _shorter(
        self, line: Line[Cycle], cycle: Cycle, reached: Cycle
    ) -> tuple[bool, float | None]:
        """Whether a cycle of a part of the period may lie in a step, and where it is met."""
        for parts in (2, 3):
            offset, later = cycle.after_part(parts), reached.after_part(parts)
            if offset @ later < -0.2 * float(offset @ offset):
                return True, line.root(partial(_closeness, offset, parts))
            if np.linalg.norm(later - offset) > 0.7 * np.linalg.norm(offset):
                return True, None
        return False, None

    def _next_length(
        self, state: ContinuationState, following: ContinuationState
    ) -> float:
        """The step after this one: longer, but not so that the branch turns by too much in it."""
        most = np.arccos(STEPS.least_cosine)
        turn = float(np.linalg.norm(following.tangent - state.tangent))
        growth = _GROWTH if following.iterations <= _EASY else 1.0
        length = state.step * float(
            np.clip(_TURN * most / max(turn, 1e-300), 0.5, growth)
        )
        return min(length, STEPS.longest_step)

    def _edge(
        self, equations: EventMap, state: ContinuationState
    ) -> ContinuationState | None:
        """The point at the end of the parameter's range, if the next step would leave it."""
        unit = float(equations.units[-1])
        length = state.step * (1.0 + float(np.linalg.norm(state.point)))
        ahead = float(state.point[-1] + length * state.tangent[-1]) * unit
        if self.low < ahead < self.high:
            return None
        edge = self.low if ahead <= self.low else self.high
        share = (edge / unit - state.point[-1]) / state.tangent[-1]
        if share <= 0.0:
            return None
        guess = state.point + share * state.tangent
        guess[-1] = edge / unit
        normal = math.copysign(1.0, state.tangent[-1]) * np.eye(len(guess))[-1]
        found = ALONG.solve(equations, guess, normal, state.step)
        if found is None or float(np.linalg.norm(found.point - guess)) > 0.3 * length:
            return None
        return found


def renewed(state: ContinuationState, cycle: Cycle) -> tuple[ContinuationState, Cycle]:
    """The same point of a branch without events, with a section of its own."""
    equations = cycle.map
    if equations.section is None:
        return state, cycle
    normal = cycle.heading / np.linalg.norm(cycle.heading)
    section = PhaseCondition(cycle.parts.states[0], normal)
    tangent = state.tangent.copy()
    tangent[: len(normal)] -= normal * (normal @ tangent[: len(normal)])
    state = replace(state, tangent=tangent / np.linalg.norm(tangent))
    return state, replace(cycle, map=replace(equations, section=section))


@checked
def cycle_branch(
    system: Any, parameter: str, to: Number, *, start: Any, n_points: Several = 100
) -> xr.Dataset:
    """The branch of cycles through a start, in one parameter, stable and unstable parts.

    It goes round folds and through changes of the order of events. Folds, pitchforks (where two
    branches cross without a symmetry: transcritical points), period doublings, torus bifurcations,
    grazings and onsets of stick are located and are points of their own, and so is a
    ``border_collision``: any other change of the events at which the stability jumps.

    Args:
        to: value at which the branch ends.
        start: a dataset of ``limit_cycle`` or one point of a branch; the other parameters are its.

    Returns:
        Dataset over ``point`` with what :func:`limit_cycle` gives of a cycle, a variable of the
        parameter's name, ``label``, ``events`` (their number) and ``end``, why the branch ended.
        A special point has the stability of the point before it; a grazing and an onset of
        sticking, where the return map has no derivative, have no multipliers (NaN).
    """
    system.check_parameter(parameter)
    cycle = started(system, start)
    begin = cycle.parts.values[parameter]
    if math.isclose(to, begin, rel_tol=1e-11):
        raise ValueError(f"to = {to!r}: another value than that of the start is needed")
    low, high = (-math.inf, to) if to > begin else (to, math.inf)
    first = first_point(cycle, parameter, to)
    follower = Follower(low, high, n_points)
    end = Outcome.no_convergence if first is None else follower.run(*first)
    return dataset(system, follower.points, end, parameter)


def started(system: System, start: xr.Dataset) -> Cycle:
    """The cycle of a dataset."""
    import json

    names = [f"{name}_start" for name in system.states]
    if not isinstance(start, xr.Dataset) or any(name not in start for name in names):
        raise ValueError(
            "start: a dataset of limit_cycle or one point of a branch is needed"
        )
    if start[names[0]].ndim:
        raise ValueError("start has many points; give one, as start.isel(point=…)")
    values = {**system.parameters, **json.loads(start.attrs["parameters"])}
    values |= {name: float(start[name]) for name in system.parameters if name in start}
    state = np.array([float(start[name]) for name in names])
    if not np.isfinite(state).all():
        raise ValueError("start holds no cycle")
    cycle, _ = find_cycle(
        system,
        values,
        state,
        guess=True,
        periods=int(start["periods"]),
        regime=system.joint.number(np.atleast_1d(start["start_regime"]).tolist()),
    )
    if cycle is None:
        raise ValueError("no cycle is found from start")
    return cycle


def first_point(
    cycle: Cycle, parameter: str, to: float
) -> tuple[ContinuationState, Cycle] | None:
    """A cycle as a point of its branch, with a tangent towards a value of the parameter."""
    begin = cycle.parts.values[parameter]
    flow = Flow(cycle.map.flow.system, (parameter,))
    equations, guess = cycle.followed_in(flow, np.array([max(abs(begin), abs(to))]))
    normal = math.copysign(1.0, to - begin) * np.eye(len(guess))[-1]
    state = AT.solve(equations, guess, normal, STEPS.first_step)
    return None if state is None else (state, Cycle.at(equations, state.point))


def doubled_start(point: BranchPoint) -> tuple[ContinuationState, Cycle] | None:
    """The first point of the branch of twice the period that leaves at a period doubling."""
    cycle = point.cycle
    equations, parts, n = cycle.map, cycle.parts, cycle.map.flow.size
    values, vectors = np.linalg.eig(cycle.monodromy)
    shift = np.real(vectors[:, int(np.argmin(np.abs(values + 1.0)))]) * equations.scale
    shifts, delays = [], []
    for event, slopes, crossing in zip(
        equations.events, parts.slopes, parts.crossings, strict=True
    ):
        shifts.append(shift)
        moved = slopes[:, :n] @ shift
        hit = event.switch != FREE
        delays.append(
            -float(crossing.height_by_state @ moved) / crossing.speed if hit else 0.0
        )
        shift = crossing.saltation @ moved if hit else moved
    # a leg begins when the event before it comes, which is late by its own delay
    late = np.array([-delays[-1], *delays])
    lengths, starts = np.diff(late), []
    for leg, begun in enumerate(late[:-1]):
        event = equations.events[leg]
        rate = equations.flow.field(
            parts.values,
            event.before,
            parts.states[leg],
            parts.start + cycle.clocks[leg],
        )
        starts.append(shifts[leg] + rate * begun)
    twice = replace(
        equations, events=equations.events * 2, periods=2 * equations.periods
    )
    followed = cycle.followed
    base = twice.pack(
        np.tile(parts.states, (2, 1)),
        np.tile(parts.durations, 2),
        parts.start,
        followed,
    )
    direction = twice.pack(
        np.concatenate([starts, np.negative(starts)]),
        np.concatenate([lengths, -lengths]),
        float(late[0]),
        0.0 * followed,
    )
    if twice.section is not None:
        direction[:n] -= twice.section.normal * (twice.section.normal @ direction[:n])
    direction /= np.linalg.norm(direction)
    for length in (1e-3, 3e-3, 1e-2):
        state = ALONG.solve(
            twice, base + length * direction, direction, STEPS.first_step
        )
        if state is not None:
            return state, Cycle.at(twice, state.point)
    return None


def in_rows(
    points: list[BranchPoint], numbers: Callable[[Cycle], dict[str, Any]]
) -> list[dict[str, Any]]:
    """The numbers of each point of a branch.

    A special point has the stability of the point before it, as round-off would decide where a
    multiplier is on the unit circle. At a grazing and at an onset of sticking the return map has no
    derivative, so there are no multipliers.
    """
    rows = [numbers(point.cycle) for point in points]
    for i, (row, point) in enumerate(zip(rows, points, strict=True)):
        if point.label not in {Label.regular, Label.end}:
            row["stable"] = rows[max(i - 1, 0)]["stable"]
        if point.label in _CORNERS:
            row |= {
                name: row[name] * np.nan
                for name in ("multiplier_real", "multiplier_imag")
            }
    return rows


def dataset(
    system: System, points: list[BranchPoint], end: int, parameter: str
) -> xr.Dataset:
    """A branch as a dataset."""
    rows = in_rows(points, lambda cycle: columns(cycle, system))
    found: dict[str, Any] = describe_columns(system, rows, "point")
    values = points[0].cycle.parts.values if points else {}
    followed = np.array([point.parameter for point in points])
    found[parameter] = ("point", followed, labels(f"{parameter} along the branch", "1"))
    special = [point.label for point in points]
    found["label"] = flag(
        "what is special about the point", "point", special, flag_table(Label)
    )
    found["events"] = (
        "point",
        [len(p.cycle.events) for p in points],
        labels("events of the cycle", "1"),
    )
    starts = [point.cycle.start() for point in points]
    for i, name in enumerate(system.states):
        first = np.array([state[i] for state, _ in starts])
        label = labels(f"{name} at t = 0 of the cycle", system.units[name])
        found[f"{name}_start"] = ("point", first, label)
    regimes = np.array([system.joint.regimes(regime) for _, regime in starts], int)
    found["start_regime"] = regime_flag(
        system,
        "regime at t = 0 of the cycle",
        ("point",),
        regimes.reshape(len(starts), system.traced.n_components),
    )
    periods = points[0].cycle.map.periods or 1 if points else 1
    found["periods"] = ((), periods, labels("forcing periods", "1"))
    found["outcome"] = outcome_of(system, "point", np.zeros(len(points), int))
    found["end"] = outcome_of(system, (), int(end))
    attributes = attributes_of(system, "cycle branch", values, 1e-14)
    return xr.Dataset(
        found, components_of(system), attributes | {"parameter": parameter}
    )
