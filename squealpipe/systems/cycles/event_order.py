"""Name changes of the order of a cycle's events, and go on with the order beyond.

Idea: a leg of zero length, or an event at zero speed, ends the range of one order of events. Which
margins vanish there together says what happened: a grazing, the begin or end of a stick, two events
that change places. Beyond, a run next to the last cycle shows the new order, and the branch goes on
with that if its cycle is a motion of the system. Invariant: the cycle with which it goes on is
within 1 % of the one at the change, over its extent. Cost: a handful of runs of one period, and of
Newton solutions.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from squealpipe.systems.branch_labels import Label
from squealpipe.systems.branch_line import ZERO_ROUND_OFF, Line
from squealpipe.systems.continuation import ContinuationState
from squealpipe.systems.cycles.admissible import Margin, MarginKind, is_motion, margins
from squealpipe.systems.cycles.event_map import EventMap
from squealpipe.systems.cycles.guess import (
    Repeat,
    follow,
    guess_of,
    merged,
    without_brief_legs,
)
from squealpipe.systems.cycles.legs import LegEnd, Vector
from squealpipe.systems.cycles.line import along_branch, branch_steps
from squealpipe.systems.cycles.solution import Cycle

if TYPE_CHECKING:
    from squealpipe.systems.tracing import TracedSystem as System


def label_of(cycle: Cycle, zero: dict[Margin, float]) -> Label:
    """Return the label of a change of the events, from the margins that vanish.

    It is ``stick_onset`` where a regime begins or ends that holds a surface, ``grazing`` where else
    a surface is touched or crossed at zero speed, and ``regular`` for any other change.
    """
    system = cycle.map.flow.system
    joint, label = system.joint, Label.regular
    for margin in zero:
        event = cycle.map.events[margin.leg]
        held = bool(joint.sticks(event.before).any())
        watched = (
            joint.falls(event.before)[margin.which],
            joint.rises(event.before)[margin.which],
        )
        own = margin.kind in {MarginKind.condition, MarginKind.length}
        switch = event.switch if own else int(max(watched))
        crosses = margin.kind in {MarginKind.touch, MarginKind.speed}
        lands = margin.kind == MarginKind.condition
        if (held or crosses or lands) and _of_hold(system, switch, event.before, lands):
            return Label.stick_onset
        if crosses:
            label = Label.grazing
    return label


def _of_hold(system: System, switch: int, among: int, lands: bool) -> bool:
    """Tell whether a switch begins or ends a hold, as stick is one.

    It does if it may lead to a regime in which its surface stays constant, or if all regimes that
    it can leave hold a surface.

    Args:
        lands: whether a hold of any surface of its component counts: a landing may stick.
    """
    t, joint = system.traced, system.joint
    if not 0 <= switch < len(t.switches):
        return False
    leaves, surfaces = np.nonzero((t.falls == switch) | (t.rises == switch))
    own = t.owner == t.owner[surfaces[0]] if lands else surfaces
    targets = [
        joint.entered(among, regime) for regime, _, _ in t.switches[switch].targets
    ]
    left = [joint.entered(among, regime) for regime in leaves.tolist()]
    return any(joint.sticks(target)[own].any() for target in targets) or all(
        joint.sticks(each).any() for each in left
    )


def least_margin(_: ContinuationState | None, cycle: Cycle) -> float:
    """Return the least margin of a cycle; below zero the cycle is no motion of the system."""
    return min(margins(cycle).values(), default=math.inf)


@dataclass
class NewOrder:
    """Continuation of a branch from where the order of its events changes.

    Attributes:
        line: the branch in the old order, from the point before the change to a little beyond.
        share: place of the change on it, over its step.
        there: point and cycle at the change.
        zero: the margins that vanish there, with their values.
    """

    line: Line[Cycle]
    share: float
    there: tuple[ContinuationState, Cycle]
    zero: dict[Margin, float]

    def way_on(self) -> tuple[ContinuationState, Cycle] | None:
        """Return the first point in a new order, with a tangent that leads away, or None."""
        for equations, guess in (*self._runs(), *self._without()):
            started = self._started(equations, guess)
            if started is not None and not self._jumps(equations, guess, started[1]):
                return started
        return None

    def _jumps(self, equations: EventMap, guess: Vector, cycle: Cycle) -> bool:
        """Tell whether a solution is far from the change, as beyond a reset of the state."""
        change = self.there[1]
        moved = (cycle.extremes - change.extremes)[
            :, : len(change.map.scale)
        ] / change.map.scale
        # the margin that is zero at the change is small just beyond it, half of what a solution may
        # move, unless a release there lets a spring jump
        near, there = margins(Cycle.at(equations, guess)), margins(cycle)
        least = min(near, key=lambda key: near[key], default=None)
        apart = least in there and there[least] > 5e-3 + abs(near[least])
        # beyond 1 % of the extent a solution is not next to the change of the events
        return bool(apart or np.abs(moved).max() > 1e-2)

    def _runs(self) -> Iterator[tuple[EventMap, Vector]]:
        """Yield equations and guess of each new order that runs from just beyond show."""
        old = order_of(self.there[1].map.events)
        seen = set()
        for beyond in (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2):
            try:
                cycle = self.line.at(self.share + beyond)[1]
            except ArithmeticError:
                continue
            continued = run_of(cycle)
            if continued is None:
                continue
            order = order_of(continued[0].events)
            if order != old and order not in seen:
                seen.add(order)
                yield continued

    def _without(self) -> Iterator[tuple[EventMap, Vector]]:
        """Yield equations and guess of the same motion without one or two vanished events."""
        cycle = self.there[1]
        for margin in self.zero:
            event = cycle.map.events[margin.leg]
            if margin.kind == MarginKind.speed and event.before == event.after:
                yield merged(cycle, margin.leg, 1)
        yield from without_brief_legs(cycle)

    def _started(
        self, equations: EventMap, guess: Vector
    ) -> tuple[ContinuationState, Cycle] | None:
        """Return the solution that a guess leads to, with the tangent along which it is a motion.

        None where there is no solution, or where it is no motion on either side.
        """
        if not np.isfinite(equations.evaluate(guess)[0]).all():
            return None
        near = margins(Cycle.at(equations, guess))
        known = margins(self.there[1]).items()
        kinds = {MarginKind.speed, MarginKind.length}
        usual = min((v for k, v in known if k.kind in kinds and v > 1e-6), default=1.0)
        # an event whose speed or length is less than a tenth of the least of the others has only
        # just begun
        most = 0.1 * min(1.0, usual)
        weak = {k: v for k, v in near.items() if k.kind in kinds and v < most}
        algorithm = replace(
            along_branch, settings=replace(branch_steps, max_iterations=12)
        )
        normal = np.eye(len(guess))[-1]
        if weak:
            normal = _gradient(equations, guess, min(weak, key=lambda k: weak[k]))
        state = algorithm.solve(equations, guess, normal, branch_steps.first_step)
        if state is None:
            return None
        cycle = Cycle.at(equations, state.point)
        if (
            cycle.period <= 0.0
            or abs(cycle.period - self.there[1].period) > 0.1 * cycle.period
        ):
            return None
        if weak:
            return (state, cycle) if is_motion(cycle) else None
        ways = []
        for sign in (1.0, -1.0):
            trial = replace(state, tangent=sign * state.tangent, step=1e-5)
            ahead = along_branch.attempt(equations, trial)
            if ahead is not None:
                beyond = Cycle.at(equations, ahead.point)
                least = least_margin(None, beyond)
                if least >= -ZERO_ROUND_OFF:
                    ways.append((least, ahead, beyond))
        if not ways:
            return None
        _, state, cycle = max(ways, key=lambda way: way[0])
        return state, cycle


def order_of(events: tuple[LegEnd, ...]) -> tuple[tuple[int, ...], ...]:
    """Return the events in cyclic order; the same whichever of them a cycle begins with."""
    kinds = [(e.switch, e.before, e.after, e.kind) for e in events]
    return min(tuple(kinds[i:] + kinds[:i]) for i in range(len(kinds)))


def run_of(cycle: Cycle) -> tuple[EventMap, Vector] | None:
    """Run the system from a solution for a period; return equations and guess of what it does.

    None where the run ends early, has far too many events or does not repeat.
    """
    equations, parts = cycle.map, cycle.parts
    flow = equations.flow
    state, regime = cycle.start()
    run = follow(flow, parts.values, state, cycle.period, regime=regime)
    if run.outcome or len(run.times) > 4 * equations.legs + 8:
        return None
    repeat = Repeat(cycle.period, equations.periods, equations.scale)
    guess = guess_of(flow, parts.values, run, state, repeat)
    if guess is None:
        return None
    made = replace(guess[0], time=equations.time, units=equations.units)
    return made, made.pack(*guess[0].unpack(guess[1])[:3], cycle.followed)


def _gradient(equations: EventMap, point: Vector, margin: Margin) -> Vector:
    """Return the direction, of length 1, in which a leg's length or an event's speed grows."""
    n, m = equations.flow.size, equations.legs
    if margin.kind == MarginKind.length:
        return np.asarray(np.eye(len(point))[m * n + margin.leg])
    parts, leg = equations.parts(point), margin.leg
    event, end = equations.events[leg], parts.path.ends[leg]
    time = parts.start + float(parts.durations[: leg + 1].sum())
    slopes = equations.flow.quantity(parts.values, event, None, end, time)[1 : n + 1]
    by_end, _ = equations.by_unknowns(parts, leg)
    gradient = -slopes @ by_end * equations.column_units
    return np.asarray(gradient / np.linalg.norm(gradient))
