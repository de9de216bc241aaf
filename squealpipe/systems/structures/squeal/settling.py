"""What starts settle to: windows of growing length, until two in succession agree.

The first is as long as the slowest unstable mode needs to grow from a small push to the nonlinear,
so that none of it enters a number. The others grow to twice their length each time. A run has
settled when its statistics in two windows agree and none of its modes still grows.
"""

from collections import Counter
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol

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

GROWTH = np.log(1e4)
"""What small motions grow by before statistics begin: from a hundredth to beyond all bounds."""
FIRST = 100.0
"""Length of the first window of statistics, in periods of the slowest unstable mode."""
LONGEST_GROWTH, MOST = 4_000.0, 8_000.0
"""Most periods in which a push may grow, and of a run, if no other end is given."""
FEWEST = 4.0
"""Fewest periods of a run: the first windows are a quarter of it."""
AGREE = 0.03
"""Largest difference of the statistics of two windows that agree: of modal velocities over the
total, and of shares of time."""
STILL_GROWS = np.log(1.5)
"""Growth of a mode's rms velocity from one window to the next that is no scatter."""
SMALLEST = 1e-9
"""Velocity of a mode, over the total, below which it is not looked at."""
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
    growing, length, most = horizon(plant, t_end)
    count = len(states)
    settled: dict[int, SettledMotion] = {}
    before: list[Rows | None] = [None] * count
    energies: list[list[np.ndarray]] = [[] for _ in range(count)]
    instants: list[list[np.ndarray]] = [[] for _ in range(count)]
    states = states.copy()
    regimes: np.ndarray | None = None
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
    """What starts have settled to until now, in a line."""
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
    if before is None or not stays(before, now):
        return None
    return SettledMotion(False, True, now, difference(before, now), 0.0)


class Statistics(Protocol):
    """What windows are compared by; see :class:`Rows`."""

    @property
    def modal(self) -> np.ndarray: ...  # noqa: D102

    @property
    def total(self) -> Any: ...  # noqa: D102

    @property
    def separated(self) -> np.ndarray: ...  # noqa: D102

    @property
    def stuck(self) -> np.ndarray: ...  # noqa: D102


def stays(before: Statistics, now: Statistics) -> bool:
    """Whether two windows in succession agree and no mode still grows."""
    with np.errstate(divide="ignore"):
        grown = np.log(now.modal) - np.log(before.modal)
    seen = before.modal > SMALLEST * now.total
    still = bool((grown[seen] > STILL_GROWS).any())
    return difference(before, now) <= AGREE and not still


def difference(one: Statistics, other: Statistics) -> float:
    """The largest difference of statistics: of velocities over the total, and of shares."""
    total = max(float(one.total), float(other.total), np.finfo(float).tiny)
    return float(
        max(
            np.abs(one.modal - other.modal).max() / total,
            np.abs(one.separated - other.separated).max(),
            np.abs(one.stuck - other.stuck).max(),
        )
    )
