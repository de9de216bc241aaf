"""What starts settle to: windows of growing length, until two in succession agree.

The first is as long as the slowest unstable mode needs to grow from a small push to the nonlinear,
so that none of it enters a number. The others grow to twice their length each time. A run has
settled when its statistics in two windows agree and none of its modes still grows.
"""

from collections import Counter
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from squealpipe.methods.progress import alone, partial_answer
from squealpipe.systems.structures.squeal.plant import Plant
from squealpipe.systems.structures.squeal.windows import (
    BLOCKS,
    Rows,
    Running,
    run_window,
)
from squealpipe.systems.trace import TIME
from squealpipe.units import engineering
from squealpipe.vibration.settling import FOR_VERDICTS, Agreement, agreement, difference

GROWTH = np.log(1e4)
"""What small motions grow by before statistics begin: from a hundredth to beyond all bounds."""
FIRST = 100.0
"""Length of the first window of statistics, in periods of the slowest unstable mode."""
LONGEST_GROWTH, MOST = 4_000.0, 8_000.0
"""Most periods in which a push may grow, and of a run, if no other end is given."""
MOST_ON = 20_000.0
"""Most periods of a run that goes on because it leaves what it seemed to have settled to."""
FEWEST = 4.0
"""Fewest periods of a run: the first windows are a quarter of it."""
WIDE = 5
"""Fewest runs at once: fewer are done by other code, which would have to be compiled, too."""


@dataclass
class SettledMotion:
    """What one start has settled to.

    Attributes:
        quiet: whether it has died out to steady sliding.
        agrees: whether it has settled at all.
        last: statistics of the last window.
        change: the largest difference to the window before.
        elapsed: time run, s.
        energies, instants: kinetic energy over time, by blocks, J and s.
    """

    quiet: bool
    agrees: bool
    last: Rows
    change: float
    elapsed: float
    energies: np.ndarray = field(default_factory=lambda: np.empty(0))
    instants: np.ndarray = field(default_factory=lambda: np.empty(0))

    def arrival(self) -> float:
        """When the kinetic energy first came to half of what it settles to, s."""
        reached = self.energies >= 0.5 * self.energies[-BLOCKS:].mean()
        return float(self.instants[reached.argmax()])


def horizon(plant: Plant, t_end: float | None) -> tuple[float, float, float]:
    """Time for growth, length of the first window, and the end of all runs, s."""
    period = 1.0 / plant.slowest
    if t_end is not None and t_end < FEWEST * period:
        raise ValueError(
            f"t_end = {t_end!r}: {FEWEST:g} periods of the slowest mode are needed at least, "
            f"{FEWEST * period:.3g} s"
        )
    first = FIRST * period
    growing = 0.0
    if plant.unstable.size:
        rate = plant.spectrum.values.real[plant.unstable].min()
        growing = min(GROWTH / rate, LONGEST_GROWTH * period)
    most = MOST * period + growing if t_end is None else t_end
    growing = min(max(growing, first), 0.25 * most)
    return growing, min(first, 0.25 * most), most


def settle(
    plant: Plant, states: np.ndarray, t_end: float | None, how: Running
) -> list[SettledMotion]:
    """Run all starts until each has settled, or the time has passed."""
    return _run(plant, states, None, horizon(plant, t_end), how)


def settle_on(
    plant: Plant, settled: list[SettledMotion], t_end: float | None, how: Running
) -> list[SettledMotion]:
    """Continue runs that seemed to have settled but still leave a motion that repels them.

    The first window has twice the length of the longest last one, and comes after as long without
    statistics: what was seen to grow by a factor grows there by its square or more.
    """
    _, _, most = horizon(plant, t_end)
    if t_end is None:
        most *= MOST_ON / MOST
    length = 2.0 * max(float(run.last.length) for run in settled)
    left = most - max(run.elapsed for run in settled)
    if left < FEWEST * length:  # without statistics, and two windows
        return [replace(run, agrees=False) for run in settled]
    states = np.array([run.last.final for run in settled])
    regimes = np.array([run.last.regimes for run in settled])
    later = how.turn(100)  # beyond the number of any window: its instants are others
    again = _run(plant, states, regimes, (length, length, left), later)
    for run, now in zip(settled, again, strict=True):
        now.energies = np.concatenate([run.energies, now.energies])
        now.instants = np.concatenate([run.instants, run.elapsed + now.instants])
        now.elapsed += run.elapsed
    return again


def _run(
    plant: Plant,
    states: np.ndarray,
    regimes: np.ndarray | None,
    times: tuple[float, float, float],
    how: Running,
) -> list[SettledMotion]:
    """Run states until each has settled.

    Args:
        regimes: those in which they start; None: whatever fits the states.
        times: lengths of the run without statistics, of the first window, and of all, s.
    """
    growing, length, most = times
    count = len(states)
    settled: dict[int, SettledMotion] = {}
    before: list[Rows | None] = [None] * count
    energies: list[list[np.ndarray]] = [[] for _ in range(count)]
    instants: list[list[np.ndarray]] = [[] for _ in range(count)]
    states = states.copy()
    at_rest = at_rest_regimes(plant)
    elapsed, span, turn = 0.0, growing, 0
    with alone() as show:
        while rows := [row for row in range(count) if row not in settled]:
            show(1.0 - len(rows) / count * (1.0 - elapsed / most))
            wide = np.array([*rows, *rows * WIDE])[: max(len(rows), WIDE)]
            started_in = None if regimes is None else regimes[wide]
            window = run_window(plant, states[wide], span, how.turn(turn), started_in)
            if regimes is None:
                regimes = np.zeros((count, window.regimes.shape[1]), np.int64)
            for place, row in enumerate(rows):
                now = window.at(place)
                energies[row].append(now.kinetic)
                instants[row].append(elapsed + now.block_ends)
                found = _judged(plant, before[row], now, at_rest)
                late = elapsed + span >= (1.0 - 1e-9) * most
                if found is None and (late or not now.finished):
                    found = SettledMotion(False, False, now, np.inf, 0.0)
                if found is not None:
                    found.elapsed = elapsed + span
                    found.energies = np.concatenate(energies[row])
                    found.instants = np.concatenate(instants[row])
                    settled[row] = found
                before[row] = now if turn else None  # what grows is no statistics
                states[row], regimes[row] = now.final, now.regimes
            elapsed += span
            partial_answer(partial(_so_far, plant, settled, count, elapsed))
            span = min(length * 2.0**turn, most - elapsed)
            turn += 1
    return [settled[row] for row in range(count)]


def _so_far(
    plant: Plant, settled: dict[int, SettledMotion], count: int, elapsed: float
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
            mode = int(motion.last.modal.argmax())
            ends[f"near {engineering(omega[mode] / (2 * np.pi), 'Hz')}"] += 1
    told = ", ".join(f"{number} {where}" for where, number in ends.most_common())
    done = sum(motion.agrees for motion in settled.values())
    return (
        f"after {engineering(elapsed, 's')}: {done} of {count} starts have settled"
        + (f" ({told})" if told else "")
    )


def at_rest_regimes(plant: Plant) -> np.ndarray:
    """The regime of each component in steady sliding."""
    system = plant.system
    values = dict(zip(system.states, plant.sliding[:, None], strict=True))
    parameters = {name: np.full(1, value) for name, value in system.parameters.items()}
    named = {**values, **parameters, TIME: np.zeros(1)}
    return np.asarray(system.first_regimes(named, 1)[0])


def _judged(
    plant: Plant, before: Rows | None, now: Rows, at_rest: np.ndarray
) -> SettledMotion | None:
    """What two windows in succession show; None: nothing yet."""
    if not now.finished:
        return None
    if not now.events and (now.regimes == at_rest).all() and plant.decays:
        # nothing switched in a whole window: the motion is linear about steady sliding, and decays
        return SettledMotion(True, True, now, 0.0, 0.0)
    if before is None:
        return None
    levels = before.levels, now.levels
    if agreement(*levels, FOR_VERDICTS) is Agreement.none:
        return None
    return SettledMotion(False, True, now, difference(*levels), 0.0)
