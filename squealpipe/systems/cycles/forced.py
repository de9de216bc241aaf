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
    QUARTERS,
    Approach,
    approach,
    distances_in_step,
)
from squealpipe.systems.cycles.solution import Cycle, scale_of
from squealpipe.systems.datasets import Outcome
from squealpipe.systems.record import RunRecord

SETTLE = 200.0
"""Forcing periods, or units of time, after which a run counts as settled."""
MOST_PERIODS = 64
"""Most forcing periods after which a settled motion is looked for again."""
_WATCHED, _SAMPLES = 128, 16
"""Periods over which its returns are followed, and samples in each."""
_LONGER, _EXTENSIONS = 4, 3
"""A run that still changes goes on for so many times as long, no more often than this."""
_LONG = 100_000
"""Steps of a run that is not made longer."""
_FAR = 0.3
"""A return as far as this, over the motion's extent, is none."""
_TRIED = 4
_MOST_EVENTS = 48
"""Events of a cycle of several periods beyond which none is sought: each try takes seconds."""
_LEFT_OUT = 2
"""Legs that are left out before a solution is given up: the run has the cycle's own events."""
_SURE = 1e-6
"""Share of a period between an event and an end of that period that is not round-off."""


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
        moved = scale_of(self.states, self.flow.system.sizes_in(self.values))
        return np.asarray(np.maximum(moved, 1e-9 * np.abs(self.states).max(axis=0)))

    @property
    def rests(self) -> bool:
        """Whether nothing moves."""
        largest = np.abs(self.states).max(axis=0) + 1e-300
        return bool((np.ptp(self.states, axis=0) <= 1e-6 * largest).all())

    def lags(self) -> list[int]:
        """Numbers of periods after which all states of the second half may have come back."""
        half = _WATCHED // 2 * _SAMPLES
        late = self.states[half:-1]
        found = np.empty(MOST_PERIODS)
        for lag in range(1, MOST_PERIODS + 1):
            before = self.states[half - lag * _SAMPLES : -1 - lag * _SAMPLES]
            off = np.abs((late - before) / self.extent).max(axis=1)
            found[lag - 1] = _typical(off)[()]
        near = np.flatnonzero(found < _FAR) + 1
        best = near[np.argsort(found[near - 1], kind="stable")][:_TRIED]
        # at first the distance may be less after several periods: one is always tried
        return sorted({1, *near[:_TRIED].tolist(), *best.tolist()})

    def cycle(self, periods: int) -> Cycle | None:
        """The cycle of some forcing periods next to the last ones of the run."""
        duration, origin = periods * self.forcing, self.origin(periods)
        path = self.states[-1 - 2 * periods * _SAMPLES :]
        first, count = _one_period(self.motion.times, origin, duration)
        if periods > 1 and count > _MOST_EVENTS:
            return None
        scale = scale_of(path, self.flow.system.sizes_in(self.values))
        repeat = Repeat(duration, periods, scale, first, count, origin)
        found = guess_of(self.flow, self.values, self.motion, path[0], repeat)
        point = None if found is None else found[0].solve(found[1])
        if found is not None and point is not None:
            return as_motion(Cycle.at(found[0], point), tries=_LEFT_OUT)
        if periods > 1:
            return None
        at = np.searchsorted(self.motion.times, origin, side="right")
        regime = int(self.motion.regimes[at])
        return near_forced(self.flow, self.values, path[0], regime, periods)[0]

    def origin(self, periods: int) -> float:
        """An instant of the run that is t = 0 of a cycle of some periods next to its end, s."""
        return (self.last - 2 * periods) * self.forcing

    def approach(self, cycle: Cycle, periods: int) -> Approach:
        """How the run goes on beside a cycle of some periods, next to its last ones."""
        if self.rests:
            return Approach.settles
        clock = self.times - self.origin(periods)
        off = distances_in_step(cycle, clock[:-1], self.states[:-1])
        quarters = np.array([_typical(part) for part in np.split(off, QUARTERS)])
        return approach(cycle, quarters, _WATCHED / QUARTERS / periods)


def _typical(distances: Vector) -> Vector:
    """The largest distance of any period, at the instants between which it is typical.

    Beside an event two motions are far apart however close they are: one has jumped already.
    """
    return np.asarray(np.median(distances.reshape(-1, _SAMPLES).max(axis=0)))


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
    """Whether an event is at an end of a period."""
    off = np.minimum(times % duration, -times % duration)
    return bool((off < _SURE * duration).any())


def _watch(
    flow: Flow, values: Mapping[str, float], state: Vector, last: int, most_steps: int
) -> Watched | int:
    """A run of so many periods, seen in its last ones; an outcome where it ends early."""
    forcing = forcing_period(flow, values)
    number = np.arange(_WATCHED * _SAMPLES + 1)
    times = (last - _WATCHED + number / _SAMPLES) * forcing
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
    longer, steps = _WATCHED, 0
    for _ in range(1 + _EXTENSIONS * (t_settle is None)):
        if steps * _LONGER > _LONG:
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
        longer, steps = longer * _LONGER, watched.motion.steps
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
        scale = scale_of(np.concatenate([path, passed]), flow.system.sizes_in(values))
        repeat = Repeat(duration, periods, scale, first, count)
        found = guess_of(flow, values, run, state, repeat)
        point = None if found is None else found[0].solve(found[1])
        if found is None or point is None:
            # perhaps other events are those of the cycle: nearer to it once more
            state, regime = after, int(run.regimes[first + count])
            continue
        cycle = Cycle.at(found[0], point)
        motion = as_motion(cycle)
        if motion is not None:
            return motion, Outcome.converged
        state, regime = cycle.start()
    return None, Outcome.no_convergence
