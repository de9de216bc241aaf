"""Make equations and a guess of a cycle, from a run that nearly repeats or from another cycle.

Idea: a cycle is a sequence of legs, each in one regime and ended by one event; its unknowns are the
state at the first event and the durations. A run that repeats after some events gives the order of
the events, the states and the durations. Where an event is about to vanish, round-off decides
whether a run has it, so guesses without brief legs, or with neighbouring ones merged, are made as
well. Invariant: only what :func:`as_motion` accepts counts as a cycle: its legs stay inside their
regimes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from squealpipe.systems.cycles.admissible import is_motion
from squealpipe.systems.cycles.event_map import FREE, EventMap, PhaseCondition
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.legs import LegEnd, Vector
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.integrate import RunOptions
from squealpipe.systems.record import RunRecord, single_run

if TYPE_CHECKING:
    from squealpipe.systems.tracing import TracedSystem as System


def follow(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    duration: float,
    **options: Any,
) -> RunRecord:
    """Run a system from a state at t = 0 with all events."""
    system, regime = flow.system, options.pop("regime", None)
    first = None if regime is None else np.array([system.joint.regimes(regime)])
    states = dict(zip(system.states, map(float, state), strict=True))
    with np.errstate(all="ignore"):
        return single_run(
            system,
            {**values, **states},
            duration,
            RunOptions(
                regime=first,
                unit_sizes=sizes_at(flow, values, state, regime or 0),
                **options,
            ),
            tol=1e-13,
        )


def sizes_at(
    flow: Flow, values: Mapping[str, float], state: Vector, regime: int
) -> Vector:
    """Sizes of the states in a motion that may be far smaller than the system's own sizes."""
    sizes, unit = flow.sizes(values), flow.unit(values)
    with np.errstate(all="ignore"):
        rates = flow.field(values, regime, state, 0.0) * unit
        largest = max(float(np.abs(each / sizes).max()) for each in (state, rates))
    return sizes * min(1.0, largest) if 0.0 < largest < np.inf else sizes


def events_of(
    system: System, motion: RunRecord, first: int, count: int
) -> tuple[LegEnd, ...]:
    """Some events of a run, each with its switch."""
    t, joint = system.traced, system.joint
    ends_of_legs: list[LegEnd] = []
    for i in range(first, first + count):
        before, after, kind, entered = (
            int(v)
            for v in (*motion.regimes[i : i + 2], motion.kinds[i], motion.entered[i])
        )
        fitting = (
            LegEnd(int(switch), surface, sign, before, after, kind)
            for watched, sign in (
                (joint.falls(before), 1.0),
                (joint.rises(before), -1.0),
            )
            for surface, switch in enumerate(watched)
            if 0 <= switch < len(t.switches)
            and any(
                (to, name) == (entered, kind)
                for to, _, name in t.switches[switch].targets
            )
        )
        ends_of_legs += islice(fitting, 1)
    return tuple(ends_of_legs)


def marked_at_once(
    flow: Flow,
    values: Mapping[str, float],
    motion: RunRecord,
    events: Sequence[LegEnd],
    first: int,
) -> tuple[LegEnd, ...]:
    """Events of a run, with those that fired where their regime was entered marked.

    The first of a run has none before it, by which its regime would be entered.
    """
    marked = []
    for number, event in enumerate(events, first):
        if number and motion.times[number] == motion.times[number - 1]:
            state, time = motion.states[number - 1], float(motion.times[number])
            regimes = event.before, event.after
            there = flow.crossing(
                values, event.switch, event.surface, regimes, state, time
            )
            beyond = there.is_beyond(state, flow.sizes(values))
            is_clock = flow.system.traced.clocks[event.surface] != 0
            event = event._replace(at_once=beyond and not is_clock)
        marked.append(event)
    return tuple(marked)


class Repeat(NamedTuple):
    """Near repetition of a run: its period, events and units.

    Attributes:
        period: after which it does, s.
        periods: of the forcing in it; 0 without.
        first, events: the events of one period and their number; by default all of the run.
        origin: instant of the run that is t = 0 of the forcing.
    """

    period: float
    periods: int
    scale: Vector
    first: int = 0
    events: int | None = None
    origin: float = 0.0


def guess_of(
    flow: Flow,
    values: Mapping[str, float],
    motion: RunRecord,
    state: Vector,
    repeat: Repeat,
) -> tuple[EventMap, Vector] | None:
    """Equations and guess from a run that is nearly periodic; None where its regimes are not.

    Args:
        state: at ``origin``, of a cycle without events.
    """
    period, periods, scale, first, count, origin = repeat
    count = len(motion.times) if count is None else count
    # a leg may need four times the steps that the run took for a whole period
    needed = 4 * motion.steps * period / max(motion.reached, period)
    flow.most_steps = max(flow.most_steps, int(needed))
    units = np.array([max(abs(values[name]), 1e-300) for name in flow.followed])
    followed = np.array([values[name] for name in flow.followed])
    if motion.regimes[first] != motion.regimes[first + count]:
        return None
    equations = EventMap(flow, (), values, scale, period, units, periods)
    if count == 0:
        regime = int(motion.regimes[first])
        return eventless(equations, state, regime, period, followed)
    events = events_of(flow.system, motion, first, count)
    if len(events) < count:
        return None
    events = marked_at_once(flow, values, motion, events, first)
    chosen = slice(first, first + count)
    times = motion.times[chosen] - origin
    durations = np.append(np.diff(times), times[0] + period - times[-1])
    # legs begin after each event: the last ends at the first event
    events = (*events[1:], events[0])
    # nor does a cycle begin between two events at one instant
    begin = next((i for i, event in enumerate(events) if not event.at_once), 0)
    equations = replace(equations, events=(*events[begin:], *events[:begin]))
    states = np.roll(motion.states[chosen], -begin, axis=0)
    durations = np.roll(durations, -begin)
    return equations, equations.pack(states, durations, float(times[begin]), followed)


def eventless(
    equations: EventMap, state: Vector, regime: int, period: float, followed: Vector
) -> tuple[EventMap, Vector]:
    """Equations and guess of a cycle through a state that stays in one regime."""
    section = None
    if not equations.periods:
        heading = (
            equations.flow.field(equations.values, regime, state, 0.0) / equations.scale
        )
        section = PhaseCondition(state, heading / np.linalg.norm(heading))
    free = LegEnd(FREE, FREE, 1.0, regime, regime, FREE)
    made = replace(equations, events=(free,), section=section)
    return made, made.pack(state[None], np.array([period]), 0.0, followed)


def solved(equations: EventMap, guess: Vector) -> Cycle | None:
    """The cycle near a guess, if it is a motion of the system."""
    point = equations.solve(guess)
    return None if point is None else as_motion(Cycle.at(equations, point))


def as_motion(cycle: Cycle, tries: int = 8) -> Cycle | None:
    """A solution if it is a motion of the system, perhaps without a pair of events.

    Next to a touch round-off decides whether a run has a pair there.

    Args:
        tries: legs that are left out, one after the other, before the solution is given up.
    """
    waiting = [cycle]
    while waiting:
        here = waiting.pop()
        if here.period > 0.0 and is_motion(here):
            closed = here.closed()
            return None if closed.drifts else closed
        shorter = []
        for equations, guess in islice(without_brief_legs(here), max(tries, 0)):
            tries -= 1
            point = equations.solve(guess)
            if point is not None:
                shorter.append(Cycle.at(equations, point))
        waiting += reversed(shorter)
    return None


def without_brief_legs(cycle: Cycle) -> Iterator[tuple[EventMap, Vector]]:
    """Equations and guess without one of the legs that may have vanished."""
    events = cycle.map.events
    # a leg of less than a thousandth of the period may have vanished
    for leg in np.flatnonzero(cycle.parts.durations < 1e-3 * cycle.period).tolist():
        if events[leg - 1].before == events[leg].after and len(events) > 1:
            yield merged(cycle, (leg - 1) % len(events), 2)


def merged(cycle: Cycle, leg: int, count: int) -> tuple[EventMap, Vector]:
    """Equations and guess in which a leg goes on through the next ones, without events between."""
    equations, parts = cycle.map, cycle.parts
    if count >= equations.legs:
        state, _ = cycle.start()
        made = replace(equations, values=parts.values)
        regime = equations.events[leg].before
        return eventless(made, state, regime, cycle.period, cycle.followed)
    absorbed = [(leg + k) % equations.legs for k in range(1, count + 1)]
    keep = [i for i in range(equations.legs) if i not in absorbed]
    events, durations = list(equations.events), parts.durations.copy()
    events[leg] = events[absorbed[-1]]
    durations[leg] += durations[absorbed].sum()
    fewer = replace(equations, events=tuple(events[i] for i in keep))
    start = parts.start + float(cycle.clocks[keep[0]])
    return fewer, fewer.pack(parts.states[keep], durations[keep], start, cycle.followed)


def once_round(cycle: Cycle) -> Cycle:
    """Return the cycle run through once, where it was found after several rounds."""
    equations, parts = cycle.map, cycle.parts
    times = np.arange(8) / 8.0 * cycle.period
    here, _ = cycle.states_at(times)
    # a cycle may be run through up to 32 times in the period that was guessed
    for rounds in range(32, 1, -1):
        after, _ = cycle.states_at((times + cycle.period / rounds) % cycle.period)
        if equations.legs % rounds and cycle.events:
            continue
        if (np.abs(here - after) > 1e-6 * equations.scale).any():
            continue
        legs = max(equations.legs // rounds, 1)
        durations = parts.durations[:legs] / (1 if cycle.events else rounds)
        fewer = replace(equations, events=equations.events[:legs])
        guess = fewer.pack(parts.states[:legs], durations, parts.start, np.empty(0))
        return solved(fewer, guess) or cycle
    return cycle
