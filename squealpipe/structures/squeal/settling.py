"""Starts of a structure, and what they settle to.

Idea: a push gets as long as its own mode needs to grow from small to nonlinear, and a random start
as long as the mode that grows fastest. Windows of statistics follow: so many periods of the motion,
and long enough to see the slowest mode grow. A start whose last windows have the statistics of a
motion that is known to be irregular has come to it, also before the end of that growth.

Invariant: another mode that takes over later is seen, at the latest by what starts beside the
settled motion (:mod:`squealpipe.structures.squeal.kinds`), and such runs go on
(:func:`settle_on`). Cost: that of the runs, which is measured before they begin.
"""

import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np

from squealpipe.codes import Verdict
from squealpipe.structures.squeal.attractors import is_same
from squealpipe.structures.squeal.kinds import is_irregular
from squealpipe.structures.squeal.plant import PUSH_OF_A_MODE, Plant
from squealpipe.structures.squeal.windows import (
    BLOCKS,
    Running,
    StructureWindows,
    merged,
    run,
    run_windows,
)
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.processes import available_cores
from squealpipe.systems.progress import partial_answer, stop_is_asked, with_progress
from squealpipe.vibration.settled_runs import Horizon, Quietness, SettledRun, Start
from squealpipe.vibration.settled_runs import settle as settle_runs
from squealpipe.vibration.settling import settling_of_verdicts

GROWTH = np.log(1e4)
"""Growth of a small push before statistics start (ln; from 1 % of the static deformation to
saturation)."""


@dataclass(frozen=True)
class RunLengths:
    """Lengths of the runs that settle."""

    first_window: float = 100.0
    """Longest first window of statistics, in periods of the slowest unstable mode; and its length
    in periods of the motion. Half as long: beats pass for two motions that agree."""
    fewest_in_window: float = 25.0
    """Fewest periods of the slowest unstable mode in it."""
    longest_growth: float = 4_000.0
    """Longest time that small motions get to grow, in periods of the slowest mode that grows."""
    most_periods: float = 8_000.0
    """Most periods in which a push may grow, and of a run, if no other end is given."""
    most_periods_of_leaving: float = 100_000.0
    """Most periods of a run that leaves what it seemed to have settled on. A fifth as many: motions
    whose neighbours take 650 periods to part by a factor of e stay undetermined."""
    fewest_periods: float = 4.0
    """Fewest periods of a run: the first windows are a quarter of it."""
    long: float = 10.0
    """CPU time of all runs, s, from which they are long: they use all cores, starts settle a few at
    a time, so that the first answers are seen early, and an interrupt is heard within a window."""
    side_by_side: int = 16
    """Starts that settle side by side then."""
    first_starts: int = 2
    """Starts that settle first. What comes to an irregular motion that another start has settled to
    needs no second window that agrees: it is compared with all windows of what has. Twice as many:
    more windows are run before one is known."""


def arrival(run: SettledRun) -> float:
    """Return when the kinetic energy first came to half of what it settles to, s."""
    energies = np.concatenate([window.kinetic for window in run.windows])
    ends = np.cumsum([0.0, *(float(window.length) for window in run.windows)])
    instants = np.concatenate(
        [
            end + window.block_ends
            for end, window in zip(ends, run.windows, strict=False)
        ]
    )
    reached = energies >= 0.5 * energies[-BLOCKS:].mean()
    return float(instants[reached.argmax()])


def horizon(plant: Plant, t_end: float | None) -> tuple[float, float, float]:
    """Time for growth, length of the first window, and the end of all runs, s."""
    period = 1.0 / plant.slowest
    if t_end is not None and t_end < RunLengths.fewest_periods * period:
        raise ValueError(
            f"t_end = {t_end!r}: {RunLengths.fewest_periods:g} periods of the slowest mode are "
            f"needed at least, {RunLengths.fewest_periods * period:.3g} s"
        )
    first = RunLengths.first_window * period
    growing = 0.0
    if plant.unstable.size:
        rate = plant.spectrum.values.real[plant.unstable].min()
        growing = min(GROWTH / rate, RunLengths.longest_growth * period)
    most = RunLengths.most_periods * period + growing if t_end is None else t_end
    growing = min(max(growing, first), 0.25 * most)
    return growing, min(first, 0.25 * most), most


def start_at(plant: Plant, state: np.ndarray) -> Start:
    """Return a start of a structure, at a state (2 n,)."""
    return Start(
        subject=plant,
        state=state,
        sliding=plant.sliding,
        period=1.0 / plant.slowest,
        speed=PUSH_OF_A_MODE * float(np.sqrt(2.0 * plant.energy)),
        rate=plant.rate,
        is_linear=plant.is_linear,
        measure=lambda away: float(np.sqrt(2.0) * plant.sizes(away)),
    )


def times_of(
    plant: Plant, rates: np.ndarray, t_end: float | None
) -> tuple[np.ndarray, float, float, float]:
    """Return times for growth (runs,), the shortest and longest first window, and the end, s.

    Args:
        rates: growth rate of what grows first in each start, 1/s; 0 where nothing does.
    """
    slowest_growing, first, most = horizon(plant, t_end)
    if not plant.unstable.size:
        return np.full(len(rates), slowest_growing), first, first, most
    period = 1.0 / plant.slowest
    slowest = plant.spectrum.values.real[plant.asked].min()
    shortest = max(Quietness.shown / slowest, RunLengths.fewest_in_window * period)
    shortest = min(shortest, first)
    longest = min(RunLengths.longest_growth * period, 0.25 * most)
    return np.clip(GROWTH / rates, first, longest), shortest, first, most


def settings_of(
    plant: Plant,
    state: np.ndarray,
    rates: np.ndarray,
    t_end: float | None,
    how: Running,
) -> tuple[Running, float]:
    """Return the settings of long runs, and the CPU time that they will take, s, by some steps.

    Args:
        state: a start, from which these steps are run.
        rates: see :func:`times_of`.
    """
    growing, shortest, longest, _ = times_of(plant, rates, t_end)
    # two windows that agree, the second of twice the length
    span = growing.sum() + 3.0 * len(rates) * np.sqrt(shortest * longest)
    alone = replace(how, workers=1)
    few_steps = 100
    run(plant, state[None], span * np.ones(1), alone, most_steps=1)  # is compiled
    began = time.process_time()
    raw = run(plant, state[None], span * np.ones(1), alone, most_steps=few_steps)
    cost = (time.process_time() - began) / float(raw["reached"][0])
    seconds = cost * span
    if seconds < RunLengths.long:
        return how, seconds
    return replace(how, workers=how.workers or available_cores(), cost=cost), seconds


def settle(
    plant: Plant,
    states: np.ndarray,
    rates: np.ndarray,
    t_end: float | None,
    how: Running,
) -> list[SettledRun]:
    """Run all starts until each has settled, or the time has passed.

    Args:
        rates: see :func:`times_of`.
    """
    starts = [start_at(plant, state) for state in states]
    growing, shortest, longest, most = times_of(plant, rates, t_end)

    def second(_: int, window: StructureWindows) -> float:
        frequency = plant.rest[0][window.velocities.argmax()] / (2.0 * np.pi)
        wanted = max(RunLengths.first_window / max(frequency, plant.slowest), shortest)
        # by halves: windows of all starts then have the same lengths in the end
        return float(longest * 2.0 ** min(np.ceil(np.log2(wanted / longest)), 0.0))

    settled: list[SettledRun] = []
    seen: list[SettledRun] = []
    irregular: list[SettledRun] = []
    known: list[SettledRun] = []

    def learn(runs: Sequence[SettledRun]) -> None:
        """Note the irregular motions, to which other starts may come, with all their windows."""
        for one in sorted(runs, key=lambda each: -each.elapsed):
            if one.agrees and not any(is_same(one, each) for each in seen):
                seen.append(one)
                if is_irregular(plant, one, how):
                    irregular.append(one)
        own = [run for run in runs if run.agrees and not run.arrived]
        known[:] = [
            # a motion has settled where two windows agree: both belong to it
            replace(
                one,
                last=merged(
                    [
                        window
                        for run in own
                        if is_same(run, one)
                        for window in run.windows[-2:]
                    ]
                ),
            )
            for one in irregular
        ]

    count = RunLengths.side_by_side if how.cost else len(starts)
    # the first few show to which irregular motions the others may come
    few = min(RunLengths.first_starts, count, len(starts))
    bounds = sorted({*range(0, len(starts), count), few, len(starts)})
    for begin, end in with_progress(list(pairwise(bounds))):
        if stop_is_asked() and settled:
            break
        several = int(growing[begin:end].min() // longest) if known else 1
        settled += _settle(
            starts[begin:end],
            (growing[begin:end], longest, most),
            how,
            growth_windows=several,
            second=second,
            known=known,
            learn=learn,
            before=settled,
            count=len(starts),
        )
    never_run = SettledRun(Verdict.undetermined, None, 0.0, change=np.inf)
    return settled + [never_run] * (len(starts) - len(settled))


def settle_on(
    plant: Plant, settled: list[SettledRun], t_end: float | None, how: Running
) -> list[SettledRun]:
    """Continue runs that seemed to have settled but still leave a motion that repels them.

    The first window has twice the length of the longest last one, and comes after as long without
    statistics: what was seen to grow by a factor grows there by its square or more.
    """
    _, _, most = horizon(plant, t_end)
    if t_end is None:
        most *= RunLengths.most_periods_of_leaving / RunLengths.most_periods
    length = 2.0 * max(float(run.last.length) for run in settled)
    left = most - max(run.elapsed for run in settled)
    if left < RunLengths.fewest_periods * length:  # without statistics, and two windows
        return [replace(run, verdict=Verdict.undetermined) for run in settled]
    starts = [start_at(plant, run.last.final) for run in settled]
    regimes = np.array([run.last.regimes for run in settled])
    later = how.turn(100)  # beyond the number of any window: its instants are others
    again = _settle(starts, (length, length, left), later, regimes)
    return [
        replace(
            now, windows=[*run.windows, *now.windows], elapsed=run.elapsed + now.elapsed
        )
        for run, now in zip(settled, again, strict=True)
    ]


def _settle(
    starts: Sequence[Start],
    times: tuple[np.ndarray | float, float, float],
    how: Running,
    regimes: np.ndarray | None = None,
    *,
    growth_windows: int = 1,
    second: Callable[[int, StructureWindows], float] | None = None,
    known: Sequence[SettledRun] = (),
    learn: Callable[[Sequence[SettledRun]], None] | None = None,
    before: Sequence[SettledRun] = (),
    count: int | None = None,
) -> list[SettledRun]:
    """Run starts of one structure until each has settled.

    Args:
        times: lengths of the run in which a push grows, of the first window, and of all, s.
        growth_windows: number of equal windows of that run.
        second, known: see :func:`squealpipe.vibration.settled_runs.settle`.
        learn: takes the runs that have settled, while others have not; it may add to ``known``.
        before: runs that have settled already, for partial answers.
        count: number of all starts; None: of these.
    """
    plant: Plant = starts[0].subject

    def advance(
        rows: list[int],
        states: np.ndarray,
        begun: np.ndarray | None,
        seconds: np.ndarray,
        turn: int,
    ) -> object:
        return run_windows(plant, states, seconds, how.turn(turn), begun)

    growing, first, most = (np.zeros(len(starts)) + time for time in times)
    lengths = Horizon(growing / growth_windows, first, most, growth_windows)

    def told(settled: dict[int, SettledRun], elapsed: np.ndarray) -> None:
        done, number = [*before, *settled.values()], count or len(starts)
        partial_answer(partial(so_far, plant, done, number, float(elapsed.max())))
        if learn is not None and len(done) < number and not stop_is_asked():
            learn(done)

    return settle_runs(
        starts,
        advance,
        lengths,
        settling_of_verdicts,
        regimes=regimes,
        told=told,
        second=second,
        known=known,
        merged=merged,
    )


def so_far(
    plant: Plant, settled: Sequence[SettledRun], count: int, elapsed: float
) -> str:
    """Say in a line what starts have settled to so far."""
    ends: Counter[str] = Counter()
    for motion in settled:
        if motion.last is None:
            ends["not begun"] += 1
        elif motion.quiet:
            ends["steady sliding"] += 1
        else:
            omega = plant.rest[0][motion.last.velocities.argmax()]
            near = f"near {engineering(omega / (2 * np.pi), 'Hz')}"
            ends[near if motion.agrees else f"not settled, {near}"] += 1
    told = ", ".join(f"{number} {where}" for where, number in ends.most_common())
    done = sum(motion.agrees for motion in settled)
    return (
        f"after {engineering(elapsed, 's')} of motion: {done} of {count} starts have settled"
        + (f" ({told})" if told else "")
    )
