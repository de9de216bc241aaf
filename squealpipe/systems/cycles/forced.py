"""Cycles of forced systems: the run is seen at the same instants of each forcing period."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from squealpipe.systems.cycles.described import SETTLED_ON
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.guess import Repeat, as_motion, follow, guess_of
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.cycles.settled import (
    Approach,
    ApproachRules,
    approach,
    distances_in_step,
)
from squealpipe.systems.cycles.solution import Cycle, scale_of
from squealpipe.systems.datasets import Outcome
from squealpipe.systems.record import RunRecord

SETTLE = 200.0
"""Forcing periods, or units of time, after which a run counts as settled."""


@dataclass(frozen=True)
class ForcedCycleSearch:
    """Limits of the search for a cycle of a forced system. Lengths count forcing periods,
    distances are relative to the motion's extent.
    """

    most_periods: int = 64
    """A settled motion is compared with itself after up to so many periods; no longer cycle is
    found.
    """
    watched_periods: int = 128
    """Last periods of a run that are compared; twice the longest cycle, so that each is seen
    twice."""
    samples: int = 16
    """Samples of each period; the median over them ignores those next to an event."""
    extension: int = 4
    """A run that still changes goes on for so many times as long."""
    most_extensions: int = 3
    """Extensions of a run, unless its length is given."""
    most_steps: int = 100_000
    """Steps beyond which a run is not extended."""
    far_return: float = 0.3
    """A return as far as this is none."""
    tries: int = 4
    """Numbers of periods that are tried: the shortest, and those that return most closely."""
    most_events: int = 48
    """No cycle of several periods with more events is sought: each try takes seconds."""
    legs_left_out: int = 2
    """Legs that are left out of a solution before it is given up: the run has the cycle's own
    events."""
    sure: float = 1e-6
    """Share of a period by which an event is surely not at the period's end; closer, round-off
    decides."""


search = ForcedCycleSearch()


def forcing_period(flow: Flow, values: Mapping[str, float]) -> float:
    """The period of the forcing, s."""
    period = flow.forcing(values)[0]
    if not 0.0 < period < np.inf:
        raise ValueError(
            f"{flow.system.name}: the period of its forcing must be greater than 0"
        )
    return period


@dataclass(frozen=True)
class Watched:
    """The last periods of a run, sampled at the same instants of each.

    Attributes:
        motion: the whole run, from t = 0.
        forcing: its period, s.
        last: number of forcing periods in it.
        times, states: (periods · samples + 1,) of the periods that are watched.
    """

    flow: Flow
    values: Mapping[str, float]
    motion: RunRecord
    forcing: float
    last: int
    times: Vector
    states: Vector

    @cached_property
    def extent(self) -> Vector:
        """Units of the states: how far they move between any instants of these periods."""
        moved = scale_of(self.states, self.flow.sizes(self.values))
        return np.asarray(np.maximum(moved, 1e-9 * np.abs(self.states).max(axis=0)))

    @property
    def rests(self) -> bool:
        """True if nothing moves."""
        largest = np.abs(self.states).max(axis=0) + 1e-300
        return bool((np.ptp(self.states, axis=0) <= 1e-6 * largest).all())

    def lags(self) -> list[int]:
        """Numbers of periods after which all states of the second half may have come back."""
        half = search.watched_periods // 2 * search.samples
        late = self.states[half:-1]
        distances = np.empty(search.most_periods)
        for lag in range(1, search.most_periods + 1):
            before = self.states[
                half - lag * search.samples : -1 - lag * search.samples
            ]
            off = np.abs((late - before) / self.extent).max(axis=1)
            distances[lag - 1] = _typical(off)[()]
        near = np.flatnonzero(distances < search.far_return) + 1
        best = near[np.argsort(distances[near - 1], kind="stable")][: search.tries]
        # at first the distance may be less after several periods: one is always tried
        return sorted({1, *near[: search.tries].tolist(), *best.tolist()})

    def cycle(self, periods: int) -> Cycle | None:
        """The cycle of some forcing periods next to the last ones of the run."""
        duration, origin = periods * self.forcing, self.origin(periods)
        path = self.states[-1 - 2 * periods * search.samples :]
        first, count = _one_period(self.motion.times, origin, duration)
        if periods > 1 and count > search.most_events:
            return None
        scale = scale_of(path, self.flow.sizes(self.values))
        repeat = Repeat(duration, periods, scale, first, count, origin)
        guess = guess_of(self.flow, self.values, self.motion, path[0], repeat)
        point = None if guess is None else guess[0].solve(guess[1])
        if guess is not None and point is not None:
            return as_motion(Cycle.at(guess[0], point), tries=search.legs_left_out)
        if periods > 1:
            return None
        at = np.searchsorted(self.motion.times, origin, side="right")
        regime = int(self.motion.regimes[at])
        return near_forced(self.flow, self.values, path[0], regime, periods)[0]

    def origin(self, periods: int) -> float:
        """An instant of the run that is t = 0 of a cycle of some periods next to its end, s."""
        return (self.last - 2 * periods) * self.forcing

    def approach(self, cycle: Cycle, periods: int) -> Approach:
        """Return how the run goes on next to a cycle of some periods, in its last ones."""
        if self.rests:
            return Approach.settles
        clock = self.times - self.origin(periods)
        off = distances_in_step(cycle, clock[:-1], self.states[:-1])
        quarters = np.array(
            [_typical(part) for part in np.split(off, ApproachRules.quarters)]
        )
        return approach(
            cycle, quarters, search.watched_periods / ApproachRules.quarters / periods
        )


def _typical(distances: Vector) -> Vector:
    """The largest distance of any period, at the instants between which it is typical.

    Beside an event two motions are far apart however close they are: one has jumped already.
    """
    return np.asarray(np.median(distances.reshape(-1, search.samples).max(axis=0)))


def _one_period(times: Vector, origin: float, duration: float) -> tuple[int, int]:
    """(first, count) of the events in a period that begins at its origin, or a little later.

    Of an event at its very end round-off decides whether it is in it.
    """
    later = times[(times >= origin) & (times <= origin + 2.0 * duration)] - origin
    inside = np.unique(later % duration)
    begin = origin
    if _is_unsure(inside, duration):
        ends = np.concatenate([[0.0], inside, [duration]])
        gap = int(np.argmax(np.diff(ends)))
        begin += 0.5 * float(ends[gap] + ends[gap + 1])
    first, last = np.searchsorted(times, [begin, begin + duration], side="right")
    return int(first), int(last - first)


def _is_unsure(times: Vector, duration: float) -> bool:
    """Return whether an event is at an end of a period."""
    off = np.minimum(times % duration, -times % duration)
    return bool((off < search.sure * duration).any())


def _watch(
    flow: Flow, values: Mapping[str, float], state: Vector, last: int, most_steps: int
) -> Watched | int:
    """A run of so many periods, seen in its last ones; an outcome where it ends early."""
    forcing = forcing_period(flow, values)
    number = np.arange(search.watched_periods * search.samples + 1)
    times = (last - search.watched_periods + number / search.samples) * forcing
    duration = float(times[-1])
    run = follow(flow, values, state, duration, times=times, most_steps=most_steps)
    if run.outcome or not np.isfinite(run.path).all():
        return run.outcome or Outcome.not_finite
    return Watched(flow, values, run, forcing, last, times, run.path)


def settled_forced(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    periods: int,
    t_settle: float | None,
    most_steps: int,
) -> tuple[Cycle | None, int]:
    """The cycle that a run from a state settles on, and an outcome."""
    forcing = forcing_period(flow, values)
    rounds = SETTLE if t_settle is None else max(1.0, np.ceil(t_settle / forcing))
    longer, steps = search.watched_periods, 0
    for _ in range(1 + search.most_extensions * (t_settle is None)):
        if steps * search.extension > search.most_steps:
            break
        watched = _watch(flow, values, state, int(rounds) + longer, most_steps)
        if isinstance(watched, int):
            return None, watched
        hopeless: list[int] = []
        for lag in watched.lags():
            if any(lag % other == 0 for other in hopeless):
                continue
            cycle = watched.cycle(lag)
            if cycle is None and lag > 1:
                hopeless.append(lag)
            if cycle is None or watched.approach(cycle, lag) != Approach.settles:
                continue
            if periods % lag:
                return None, SETTLED_ON + lag
            if periods == lag:
                return cycle, Outcome.converged
            place, regime = cycle.start()
            return near_forced(flow, values, place, regime, periods)
        longer, steps = longer * search.extension, watched.motion.steps
    return None, Outcome.unsettled


def near_forced(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    regime: int | None,
    periods: int,
) -> tuple[Cycle | None, int]:
    """A cycle of some forcing periods near a state at t = 0 of the forcing, and an outcome."""
    duration = periods * forcing_period(flow, values)
    for _ in range(3):
        times = np.linspace(0.0, duration, 200)
        run = follow(flow, values, state, duration, regime=regime, times=times)
        after, path = run.final, run.path
        if not run.outcome and _is_unsure(run.times, duration):
            times = np.linspace(0.0, 2.0 * duration, 400)
            run = follow(flow, values, state, times[-1], regime=regime, times=times)
        if run.outcome or not np.isfinite(run.path).all():
            return None, run.outcome or Outcome.not_finite
        first, count = _one_period(run.times, 0.0, duration)
        passed = run.states[first : first + count]
        scale = scale_of(np.concatenate([path, passed]), flow.sizes(values))
        repeat = Repeat(duration, periods, scale, first, count)
        guess = guess_of(flow, values, run, state, repeat)
        point = None if guess is None else guess[0].solve(guess[1])
        if guess is None or point is None:
            # perhaps other events are those of the cycle: nearer to it once more
            state, regime = after, int(run.regimes[first + count])
            continue
        cycle = Cycle.at(guess[0], point)
        motion = as_motion(cycle)
        if motion is not None:
            return motion, Outcome.converged
        state, regime = cycle.start()
    return None, Outcome.no_convergence
