"""Starts of a structure, and what they settle to.

The first window is as long as the slowest unstable mode needs to grow from a small push to the
nonlinear, so that none of it enters a number.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from squealpipe.codes import Verdict
from squealpipe.structures.squeal.plant import PUSH_OF_A_MODE, Plant
from squealpipe.structures.squeal.windows import BLOCKS, Running, run_windows
from squealpipe.systems.progress import partial_answer
from squealpipe.units import engineering
from squealpipe.vibration.settled_runs import Horizon, SettledRun, Start
from squealpipe.vibration.settled_runs import settle as settle_runs
from squealpipe.vibration.settling import FOR_VERDICTS

GROWTH = np.log(1e4)
"""Growth of a small push before statistics start (ln; from 1 % of the static deformation to
saturation)."""


@dataclass(frozen=True)
class RunLengths:
    """Lengths of the runs that settle."""

    first_window: float = 100.0
    """Length of the first window of statistics, in periods of the slowest unstable mode."""
    longest_growth: float = 4_000.0
    """Longest time that small motions get to grow, in periods of the slowest mode that grows."""
    most_periods: float = 8_000.0
    """Most periods in which a push may grow, and of a run, if no other end is given."""
    fewest_periods: float = 4.0
    """Fewest periods of a run: the first windows are a quarter of it."""


RUN_LENGTHS = RunLengths()


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
    if t_end is not None and t_end < RUN_LENGTHS.fewest_periods * period:
        raise ValueError(
            f"t_end = {t_end!r}: {RUN_LENGTHS.fewest_periods:g} periods of the slowest mode are "
            f"needed at least, {RUN_LENGTHS.fewest_periods * period:.3g} s"
        )
    first = RUN_LENGTHS.first_window * period
    growing = 0.0
    if plant.unstable.size:
        rate = plant.spectrum.values.real[plant.unstable].min()
        growing = min(GROWTH / rate, RUN_LENGTHS.longest_growth * period)
    most = RUN_LENGTHS.most_periods * period + growing if t_end is None else t_end
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


def settle(
    plant: Plant, states: np.ndarray, t_end: float | None, how: Running
) -> list[SettledRun]:
    """Run all starts until each has settled, or the time has passed."""
    starts = [start_at(plant, state) for state in states]
    return _settle(starts, horizon(plant, t_end), how)


def settle_on(
    plant: Plant, settled: list[SettledRun], t_end: float | None, how: Running
) -> list[SettledRun]:
    """Continue runs that seemed to have settled but still leave a motion that repels them.

    The first window has twice the length of the longest last one, and comes after as long without
    statistics: what was seen to grow by a factor grows there by its square or more.
    """
    _, _, most = horizon(plant, t_end)
    if t_end is None:
        # a run that leaves what it seemed to have settled on goes on for so many periods
        most *= 20_000.0 / RUN_LENGTHS.most_periods
    length = 2.0 * max(float(run.last.length) for run in settled)
    left = most - max(run.elapsed for run in settled)
    if (
        left < RUN_LENGTHS.fewest_periods * length
    ):  # without statistics, and two windows
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
    times: tuple[float, float, float],
    how: Running,
    regimes: np.ndarray | None = None,
) -> list[SettledRun]:
    """Run starts of one structure until each has settled.

    Args:
        times: lengths of the run without statistics, of the first window, and of all, s.
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

    growing, first, most = (np.full(len(starts), time) for time in times)
    lengths = Horizon(growing, first, most, grows_first=True)

    def told(settled: dict[int, SettledRun], elapsed: np.ndarray) -> None:
        partial_answer(
            partial(_so_far, plant, settled, len(starts), float(elapsed.max()))
        )

    return settle_runs(
        starts, advance, lengths, FOR_VERDICTS, regimes=regimes, told=told
    )


def _so_far(
    plant: Plant, settled: dict[int, SettledRun], count: int, elapsed: float
) -> str:
    """Say in a line what starts have settled to so far."""
    omega = plant.rest[0]
    ends: Counter[str] = Counter()
    for motion in settled.values():
        if not motion.agrees:
            ends["not settled"] += 1
        elif motion.quiet:
            ends["steady sliding"] += 1
        else:
            mode = int(motion.last.velocities.argmax())
            ends[f"near {engineering(omega[mode] / (2 * np.pi), 'Hz')}"] += 1
    told = ", ".join(f"{number} {where}" for where, number in ends.most_common())
    done = sum(motion.agrees for motion in settled.values())
    return (
        f"after {engineering(elapsed, 's')}: {done} of {count} starts have settled"
        + (f" ({told})" if told else "")
    )
