"""Methods that can be asked what becomes of a push along an unstable mode, and their cost.

All push along their own mode nearest to the one that is asked for, run for the same time, and look
at the last window; complex modes say that each unstable mode rings.
"""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.benchmark.schema import Role
from squealpipe.schema import Outcome
from squealpipe.structures.coordinates import Coordinates, StaticSpace
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.spectrum import Limits, Solver
from squealpipe.structures.squeal.ends import (
    EndSearch,
    PushEnd,
    exact_ends,
    nothing,
    smoothed_end,
    without_mode,
)
from squealpipe.structures.squeal.plant import PUSH_OF_A_MODE, Plant
from squealpipe.structures.squeal.smoothed import Smoothed
from squealpipe.structures.squeal.windows import Running, StructureWindows, run_windows
from squealpipe.systems.taylor.lanes import taylor_terms


@dataclass(frozen=True)
class Horizon:
    """Time for growth, and the length of each of two windows behind it, s."""

    growing: float
    window: float

    @property
    def end(self) -> float:
        """Return the time at which all runs end, s."""
        return self.growing + 2.0 * self.window


@dataclass(frozen=True, kw_only=True)
class Told:
    """Answer of one method at one setting, and its cost.

    Attributes:
        ends: of the push along each mode that was asked for.
    """

    method: str
    setting: str
    role: Role
    n_modes: int
    ends: list[PushEnd]
    cpu_time: float
    compile_time: float = 0.0
    evaluations: int = 0
    widths: tuple[float, float] = (np.nan, np.nan)


def complex_modes_told(
    structure: ContactStructure,
    number: int | None,
    frequencies: np.ndarray,
    frequency_max: float | None,
    repeats: int,
) -> Told:
    """Return the answer of complex modes, of the whole structure or of its lowest modes.

    Args:
        number: modes; None: all.
        frequencies: of the modes that are asked for, Hz.
    """

    def ask() -> np.ndarray:
        if number is not None:
            return Coordinates(StaticSpace(structure, number), number, 0).values()
        solver = Solver(structure, Limits(frequency_max), structure.belt_speed)
        return solver.at(structure.mu).values

    values, spent = _timed(ask, repeats)
    # growth below this share of the modulus is round-off
    at, grows = values.imag / (2.0 * np.pi), values.real > 1e-9 * np.abs(values)
    untold = nothing(structure)
    ends = []
    for frequency in frequencies:
        place = _same(at, grows, frequency)
        rings = place is not None and bool(grows[place])
        ends.append(
            PushEnd(
                outcome=Outcome.converged,
                frequency=float(at[place]) if rings else np.nan,
                quiet=not rings,
                has_mode=place is not None,
                **untold,
            )
        )
    count = structure.size if number is None else number
    return Told(
        method="complex modes",
        setting=f"all {count}" if number is None else str(number),
        role=Role.public,
        n_modes=count,
        ends=ends,
        cpu_time=spent,
    )


def exact_told(
    plant: Plant, frequencies: np.ndarray, horizon: Horizon, tol: float, repeats: int
) -> Told:
    """Runs with every event located, several at once from pushes that differ a little."""
    pushes = _pushes(plant, frequencies)
    known = [push for push in pushes if push is not None]
    # runs from pushes that differ a little: their scatter is an error
    count = 4 if len(known) > 1 else 5
    # each of several pushes is 5 % larger than the one before
    starts = np.array(
        [
            plant.pushed(place, PUSH_OF_A_MODE * (1.0 + 0.05 * turn))
            for place in known
            for turn in range(count)
        ]
    )

    def go(
        span: float, states: np.ndarray, regimes: Any, seed: int
    ) -> StructureWindows:
        return run_windows(plant, states, span, Running(tol, seed, 1), regimes)

    def ask() -> list[StructureWindows]:
        rows = [go(horizon.growing, starts, None, 0)]
        for seed in (1, 2):
            rows.append(go(horizon.window, rows[-1].final, rows[-1].regimes, seed))
        return rows

    ends, spent, compiled, evaluations = [], 0.0, 0.0, 0
    if known:
        short = 1e-3 / plant.fastest
        _, first = _timed(lambda: go(short, starts, None, 0), 1)
        _, again = _timed(lambda: go(short, starts, None, 0), 1)
        compiled = max(first - again, 0.0)
        rows, spent = _timed(ask, repeats)
        evaluations = int(sum(row.steps.sum() for row in rows)) * taylor_terms(tol)
        found = exact_ends(plant, rows[1], rows[2], count, tol)
    for place in pushes:
        if place is None:
            ends.append(without_mode(plant.structure))
        else:
            ends.append(found[known.index(place)])
    return Told(
        method="exact events",
        setting=f"{plant.size} modes",
        role=Role.ours,
        n_modes=plant.size,
        ends=ends,
        cpu_time=spent / count,
        compile_time=compiled,
        evaluations=evaluations // count,
        widths=(0.0, 0.0),
    )


def smoothed_told(
    plant: Plant,
    frequencies: np.ndarray,
    horizon: Horizon,
    widths: tuple[float, float],
    tol: float,
) -> Told:
    """One run after the other without events.

    Args:
        widths: of friction over the belt's speed, and of contact over the preload.
    """
    structure = plant.structure
    belt = np.abs(structure.speeds * structure.belt_speed)
    model = Smoothed(
        plant,
        widths[0] * abs(structure.belt_speed),
        widths[1] * np.nan_to_num(plant.pressed),
    )
    step, times = _instants(plant, horizon)
    ends, spent, evaluations = [], 0.0, 0
    for push in _pushes(plant, frequencies):
        if push is None:
            ends.append(without_mode(structure))
            continue
        start = plant.pushed(push, PUSH_OF_A_MODE)
        samples, once = _timed(lambda start=start: model.run(start, times, tol), 1)  # type: ignore[misc]
        spent, evaluations = spent + once, evaluations + samples.evaluations
        ends.append(smoothed_end(plant, samples, model.friction_width, belt, step))
    both = widths[1] > 0
    return Told(
        method="friction and contact smoothed" if both else "friction smoothed",
        setting=f"{widths[0]:g}, {widths[1]:g}" if both else f"{widths[0]:g}",
        role=Role.public,
        n_modes=plant.size,
        ends=ends,
        cpu_time=spent,
        evaluations=evaluations,
        widths=widths,
    )


def _timed(ask: Callable[[], Any], repeats: int) -> tuple[Any, float]:
    """The result of a call and the median of its CPU times, s; a long one is called once."""
    spent: list[float] = []
    while len(spent) < repeats:
        started = time.process_time()
        result = ask()
        spent.append(time.process_time() - started)
        # s of CPU: a longer run scatters little, and is not repeated
        if spent[0] > 4.0:
            break
    return result, statistics.median(spent)


def _same(frequencies: np.ndarray, grows: np.ndarray, frequency: float) -> int | None:
    """Place of the mode that is another model's at this frequency, Hz: one that grows first."""
    away = np.abs(frequencies - frequency)
    for which in (grows, np.ones(len(away), bool)):
        if which.any():
            place = int(np.where(which, away, np.inf).argmin())
            if away[place] <= EndSearch.same_mode * frequency:
                return place
    return None


def _pushes(plant: Plant, frequencies: np.ndarray) -> list[int | None]:
    grows = np.isin(np.arange(len(plant.frequencies)), plant.unstable)
    return [
        _same(plant.frequencies, grows, float(frequency)) for frequency in frequencies
    ]


def _instants(plant: Plant, horizon: Horizon) -> tuple[float, np.ndarray]:
    """Step and instants, s: 0, and both windows in equal steps."""
    count = int(
        np.ceil(horizon.window * EndSearch.samples_per_fast_period * plant.fastest)
    )
    # in each window
    fewest_samples = 2**14
    count = min(max(count, fewest_samples), EndSearch.most_samples)
    step = horizon.window / count
    late = horizon.growing + step * np.arange(1, 2 * count + 1)
    return step, np.concatenate([[0.0], late])


def distinct(numbers: Sequence[int], fewest: int, most: int) -> list[int]:
    """Numbers of modes that a structure can have, ascending."""
    return sorted({int(n) for n in numbers if fewest <= n <= most})
