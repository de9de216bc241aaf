"""Find cycles of systems without forcing: a run comes back to where it was, after an unknown time.

Idea: a run is sampled in windows that grow. A near return gives a guess of the events and the
period, and Newton's method on the map of events closes it. A run that shrinks at the rate of its
state of rest, or moves no more, has none. Invariant: a cycle is accepted only if its states agree
with the run that it was found in, since Newton's method may lead to another motion. Cost: the run
until it has settled; closing a cycle takes a few runs of one period.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.systems.cycles.described import SETTLED_ON
from squealpipe.systems.cycles.event_map import PhaseCondition
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.forced import SETTLE
from squealpipe.systems.cycles.guess import (
    Repeat,
    follow,
    guess_of,
    once_round,
    sizes_at,
    solved,
)
from squealpipe.systems.cycles.legs import LegEnd, Vector
from squealpipe.systems.cycles.settled import (
    Approach,
    ApproachRules,
    approach,
    distances_from_orbit,
)
from squealpipe.systems.cycles.solution import Cycle, scale_of
from squealpipe.systems.datasets import Outcome
from squealpipe.systems.motion import AT_REST
from squealpipe.systems.record import RunRecord
from squealpipe.systems.recurrence import crossings


@dataclass(frozen=True)
class FreeCycleSearch:
    """Limits of the search for a cycle of a system without forcing. Times are in the system's
    unit of time, distances relative to the motion's extent.
    """

    windows: tuple[float, ...] = (40.0, 160.0, 640.0)
    """The run is searched for a return within the first time, then the next; a longer one finds
    slower cycles, and costs as much more."""
    extension: float = 4.0
    """After the last window the run goes on for so many times as long: once if it comes nearer to
    a cycle but is still far from it, as often as its steps allow if it has not come back."""
    near_return: float = 0.05
    """A return this close ends the search within a window. Doubled, worse guesses reach Newton's
    method, which may lead astray."""
    far_return: float = 0.3
    """A return this far is none; a cycle whose period is off by this share is another one."""
    astray: float = 0.5
    """A cycle this far from the state that was to be near it is another one."""
    tries: int = 4
    """Returns that are handed to Newton's method; each try with many events takes seconds."""
    samples: int = 2000
    """Samples of a run, evenly; a return between two is refined."""
    compared_samples: int = 16
    """Samples of each quarter of a run that are compared with a cycle."""
    second_return: float = 3.0
    """A settled run may be so many times farther off after two periods than after one; a chaotic
    one is farther."""
    most_events: int = 48
    """A cycle of more events is sought only if the run goes through it twice and returns closely:
    a chaotic run has such returns, and Newton's method on hundreds of legs takes a minute."""
    most_unknowns: int = 20_000
    """A return with more unknowns, events times states, is passed over: the matrix of Newton's
    method would take 3 GB, and with twice as many four times that."""
    close_return: float = 1e-3
    """Largest distance of such a close return."""
    rest: float = 1e-9
    """A motion whose extent over its size is less is at rest: round-off."""
    soon: float = 10.0
    """A motion comes to rest only if, at the rate at which it shrinks, it is there within so many
    times as long as it has run; a slower one may have a cycle ahead."""


search = FreeCycleSearch()


@dataclass(frozen=True)
class Stretch:
    """A run from a state, evenly sampled."""

    flow: Flow
    values: Mapping[str, float]
    motion: RunRecord
    times: Vector
    scale: Vector

    def rests(self) -> bool:
        """Return whether nothing moves in the second half."""
        late = self.motion.path[len(self.motion.path) // 2 :]
        first = self.motion.path[0], int(self.motion.regimes[0])
        return _rests(late, sizes_at(self.flow, self.values, *first))

    def comes_back(self) -> bool:
        """Return whether the run returns at all, near or far; a slow cycle may be longer than the
        stretch.
        """
        return next(_returns(self, self.motion.path[0]), None) is not None

    def comes_to_rest(self, ran: float) -> bool:
        """Return whether a motion in one regime shrinks towards a stable state of rest.

        It has to be there, at the rate at which it shrinks, within ten times the time that it has
        run; a slower one may have a cycle ahead.
        """
        flow, values, path = self.flow, self.values, self.motion.path
        if len(self.motion.times):
            return False
        regime = int(self.motion.regimes[0])
        halves = np.split(path[: len(path) // 2 * 2], 2)
        first, second = (np.ptp(half, axis=0) for half in halves)
        place = middle = path[len(path) // 2 :].mean(axis=0)
        scale = np.maximum(np.abs(path).max(axis=0), 1e-300)
        with np.errstate(all="ignore"):
            for _ in range(20):
                slopes = flow.jacobian(values, regime, place)[:, : flow.size] * scale
                rate = flow.field(values, regime, place, 0.0)
                if not (np.isfinite(slopes).all() and np.isfinite(rate).all()):
                    return False  # Newton's method has left where the field is smooth
                place = place - np.linalg.lstsq(slopes, rate, rcond=None)[0] * scale
        far = np.abs(place - middle) > second + 1e-9 * scale
        if not np.isfinite(place).all() or far.any():
            return False
        rates = np.linalg.eigvals(flow.jacobian(values, regime, place)[:, : flow.size])
        decays = rates.real.max() < -1e-9 * np.abs(rates).max()
        with np.errstate(divide="ignore"):
            rate = np.log(second / np.maximum(first, 1e-300)) * 2.0 / self.times[-1]
        shrinks = (second <= 1e-12 * scale) | (
            search.soon * ran * rate <= np.log(AT_REST)
        )
        return bool(decays and shrinks.all())

    def approach(self, cycle: Cycle) -> Approach:
        """Return how the run goes on next to a cycle: it settles, comes nearer, or leaves."""
        path = self.motion.path
        quarter = len(path) // ApproachRules.quarters
        inside = np.linspace(
            0, quarter, search.compared_samples, endpoint=False, dtype=int
        )
        places = (np.arange(ApproachRules.quarters)[:, None] * quarter + inside).ravel()
        off = distances_from_orbit(cycle, path[places])
        # a sample next to an event may be measured poorly
        distances = np.quantile(off.reshape(ApproachRules.quarters, -1), 0.75, axis=1)
        return approach(
            cycle, distances, self.times[-1] / ApproachRules.quarters / cycle.period
        )


def settled_free(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    returns: int,
    t_settle: float | None,
    unit: float,
    most_steps: int,
) -> tuple[Cycle | None, int]:
    """The cycle that a run from a state settles on, and an outcome.

    Args:
        returns: to its section at most; 0 for any number.
        most_steps: of the run that settles, and of each that looks for returns after it.
    """
    settle = SETTLE * unit if t_settle is None else t_settle
    run = follow(flow, values, state, settle, most_steps=most_steps)
    if run.outcome:
        return None, run.outcome
    at_rest, ran = False, settle
    window: float | None = search.windows[0]
    while window is not None:
        regime = int(run.regimes[-1])
        stretch = _stretch(flow, values, run.final, regime, window * unit, most_steps)
        if stretch == Outcome.step_limit and window > search.windows[0]:
            break  # it has settled on nothing for as long as that
        if isinstance(stretch, int):
            return None, stretch
        ran += window * unit
        at_rest = stretch.comes_to_rest(ran)
        nears = False
        far = search.near_return if window < search.windows[-1] else search.far_return
        for cycle in _cycles(stretch, far, [], settled=True):
            if _rests(cycle.extremes[:, : flow.size], 0.0):
                continue  # where it comes to rest, if it does; the run has not
            course = stretch.approach(cycle)
            nears |= course == Approach.nears
            if course == Approach.settles:
                number = _least(cycle.events)
                many = 0 < returns < number
                return (
                    (None, SETTLED_ON + number) if many else (cycle, Outcome.converged)
                )
        back = stretch.comes_back()
        if (
            window >= search.windows[-1]
            and back
            and (not nears or window > search.windows[-1])
        ):
            break
        run = stretch.motion
        window = _next_window(window, run.steps, most_steps)
    return None, Outcome.equilibrium if at_rest else Outcome.unsettled


def near_free(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    regime: int | None,
    unit: float,
    most_steps: int,
) -> tuple[Cycle | None, int]:
    """A cycle near a state, and an outcome."""
    tried: list[float] = []
    at_rest = False
    window: float | None = search.windows[0]
    while window is not None:
        stretch = _stretch(flow, values, state, regime, window * unit, most_steps)
        if stretch == Outcome.step_limit and window > search.windows[-1]:
            break
        if isinstance(stretch, int):
            return None, stretch
        at_rest = stretch.comes_to_rest(window * unit)
        for cycle in _cycles(
            stretch,
            search.near_return if window < search.windows[-1] else search.far_return,
            tried,
        ):
            if _rests(cycle.extremes[:, : flow.size], 0.0):
                return None, Outcome.equilibrium
            if not _is_astray(cycle, state, stretch.scale):
                return cycle, Outcome.converged
        if window >= search.windows[-1] and stretch.comes_back():
            break
        window = _next_window(window, stretch.motion.steps, most_steps)
    return None, Outcome.equilibrium if at_rest else Outcome.no_convergence


def _next_window(window: float, steps: int, most_steps: int) -> float | None:
    """Return the next time, in units, to look for a return in; None if steps do not suffice."""
    if window in search.windows[:-1]:
        return search.windows[search.windows.index(window) + 1]
    return window * search.extension if steps * search.extension <= most_steps else None


def _stretch(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    regime: int | None,
    duration: float,
    most_steps: int,
) -> Stretch | int:
    """A run from a state; an outcome where it ends early or at rest."""
    times = np.linspace(0.0, duration, search.samples)
    options = {"regime": regime, "times": times, "most_steps": most_steps}
    run = follow(flow, values, state, duration, **options)
    if run.outcome or not np.isfinite(run.path).all():
        return run.outcome or Outcome.not_finite
    scale = scale_of(np.concatenate([run.path, run.states]), flow.sizes(values))
    stretch = Stretch(flow, values, run, times, scale)
    return Outcome.equilibrium if stretch.rests() else stretch


def _cycles(
    stretch: Stretch, far: float, tried: list[float], *, settled: bool = False
) -> Iterator[Cycle]:
    """Solutions next to near returns of a run, run through once.

    Args:
        settled: the run is to be on the cycle, and not only next to one at its start.
    """
    flow, values, state = stretch.flow, stretch.values, stretch.motion.path[0]
    for count, period, distance in _returns(stretch, state, settled=settled):
        if distance > far:
            return
        if any(abs(period - other) < 1e-3 * period for other in tried):
            continue
        if count * (flow.size + 1) > search.most_unknowns:
            continue
        tried.append(period)
        if not count:
            period = _exact_return(stretch, state, period)
        repeat = Repeat(period, 0, stretch.scale, events=count)
        guess = guess_of(flow, values, stretch.motion, state, repeat)
        cycle = None if guess is None else solved(*guess)
        if (
            cycle is not None
            and abs(cycle.period - period) <= search.far_return * period
        ):
            yield once_round(cycle)


def _is_astray(cycle: Cycle, state: Vector, scale: Vector) -> bool:
    """Return whether Newton's method has led to another motion than the one that was meant."""
    off = distances_from_orbit(cycle, state[None]) * cycle.extent.max()
    return bool(off[0] > search.astray * scale.max())


def _rests(path: Vector, sizes: Any) -> bool:
    """Return whether a motion is within round-off."""
    largest = np.maximum(np.abs(path).max(axis=0), sizes)
    return bool((np.ptp(path, axis=0) <= search.rest * largest).all())


def _least(events: tuple[LegEnd, ...]) -> int:
    """Return how often the rarest event of a cycle occurs: its returns to a section."""
    kinds = [(event.switch, event.after) for event in events]
    return min((kinds.count(kind) for kind in kinds), default=1)


def _exact_return(stretch: Stretch, state: Vector, time: float) -> float:
    """The instant next to one at which a motion without events is back on its section.

    Of a family of cycles another member would be met after another time.
    """
    flow, values, regime = stretch.flow, stretch.values, int(stretch.motion.regimes[0])
    rate = flow.field(values, regime, state, 0.0)
    section = PhaseCondition(state, rate / stretch.scale**2)
    width = float(stretch.times[1])
    for _ in range(3):
        times = np.linspace(max(time - width, 0.0), time + width, 9)
        run = follow(flow, values, state, times[-1], regime=regime, times=times)
        returns, _ = crossings(times, run.path, section.state, section.normal)
        time = min(returns.tolist(), key=lambda at: abs(at - time), default=time)
        width /= 200.0
    return time


def _returns(
    stretch: Stretch, state: Vector, *, settled: bool = False
) -> Iterator[tuple[int, float, float]]:
    """(events, period, distance) of near returns, the best and earliest first.

    Args:
        settled: leave out those after whose time the run does not come back once more, or which
            have many events and no second time in the run. A chaotic run has such returns, and
            Newton's method on hundreds of legs takes a minute.
    """
    run, times, scale = stretch.motion, stretch.times, stretch.scale
    returns: list[tuple[int, float, float]] = []
    if len(run.times):
        keys = np.column_stack([run.kinds, run.regimes[:-1], run.regimes[1:]])
        off = np.abs((run.states - run.states[0]) / scale).max(axis=1)
        for count in (np.flatnonzero((keys[1:] == keys[0]).all(axis=1)) + 1).tolist():
            again = 2 * count
            once = again >= len(off)
            if (
                settled
                and not once
                and off[again]
                > search.second_return * off[count] + ApproachRules.on_cycle
            ):
                continue
            if (
                settled
                and count > search.most_events
                and (once or off[count] > search.close_return)
            ):
                continue
            returns.append(
                (count, float(run.times[count] - run.times[0]), float(off[count]))
            )
    else:
        rate = stretch.flow.field(stretch.values, int(run.regimes[0]), state, 0.0)
        section = PhaseCondition(state, rate / scale**2)
        instants, there = crossings(times, run.path, state, section.normal)
        distances = np.abs((there - state) / scale).max(axis=1, initial=0.0)
        returns += [
            (0, *each)
            for each in zip(instants.tolist(), distances.tolist(), strict=True)
        ]
    nearest = 3.0 * min((each[2] for each in returns), default=0.0) + 1e-4
    returns.sort(
        key=lambda each: (each[2] >= nearest, each[1] if each[2] < nearest else each[2])
    )
    yield from returns[: search.tries]
