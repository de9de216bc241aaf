"""The kind of a settled motion, and its spectrum: from one run, and others that start beside it.

Beside the motion start some that are off by 1e-8 of it, each in a direction of its own. Where they
run away from it exponentially it is irregular. Where they do not, and it repeats or nears one that
does, the exact map closes it to a cycle, whose multipliers decide and whose statistics are those of
the motion. What neither repeats nor runs away is a torus.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.fft import next_fast_len

from squealpipe.schema import Outcome
from squealpipe.structures.schema.squealing import Kind
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.windows import (
    Running,
    StructureWindows,
    run,
    statistics_of,
)
from squealpipe.systems.cycles.find import find_cycle
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.progress import stop_is_asked
from squealpipe.systems.recurrence import repeats_after
from squealpipe.vibration.settled_runs import SettledRun
from squealpipe.vibration.settling import late_growth, settling_of_numbers
from squealpipe.vibration.spectrum import amplitude_spectrum, strongest_line


@dataclass(frozen=True)
class KindRules:
    """Thresholds that decide the kind of a settled motion."""

    neighbours: int = 7
    """Runs beside the motion whose distances from it are followed."""
    first_distance: float = 1e-8
    """Distance at which they start, over the motion's extent."""
    periods: float = 300.0
    """Length of the run, in periods of the slowest mode that grows. Half as long: slow separation
    is taken for a torus."""
    samples_per_period: float = 6.0
    """Samples in a period of the fastest mode."""
    most_samples: int = 2**16
    """Most samples of the run; a longer one is cut off there."""
    early: int = 8
    """Three neighbours are followed for the run's length over this at first. Then they are followed
    twice as long each time, while they separate fast enough to be lost within the run. Twice as
    large: motions whose neighbours are lost late are looked at once more."""
    exponential_growth: float = 1e3
    """Growth of the distance from which it is exponential and the motion irregular."""
    saturation: float = 1e-2
    """Distance, over the extent, beyond which neighbours separate no further."""
    linear_growth: float = 30.0
    """Growth of the distance up to which it may be one of phases, as on a torus."""
    repeated_intervals: float = 1e-5
    """Largest difference of intervals between events, over their mean, of a motion that repeats."""
    nearly_repeated: float = 1e-3
    """Largest such difference of a motion whose cycle is worth a search."""
    slowly_neared: float = 1e-2
    """Such a difference where neighbours draw nearer: what is left of the way to a cycle. A tenth:
    that cycle is taken for a torus. Ten times: tori are searched for cycles, for minutes."""
    cycle_periods: int = 31
    """Periods of a cycle that are run for its statistics."""
    cycle_samples: int = 2048
    """Samples of them; with no factor in common with their number, all are at phases of their own.
    Half as many: the largest speed is off by four times as much, 3e-6."""


@dataclass(frozen=True)
class Described:
    """A settled motion.

    Attributes:
        kind: of motion.
        frequency: strongest line of the kinetic energy, Hz; NaN where nothing moves.
        resolution: of the spectrum, Hz.
        exponent: growth rate of the distance of neighbours, 1/s; NaN where it was not measured.
        cycle: closed by the exact map, where it is one.
        lines, amplitudes: the spectrum, Hz and √J.
        late_growth: ln of the growth of the area that neighbours span, from the third to the last
            quarter of the run.
        leaves: whether the motion is about to leave what repels it: neighbours run away, but the
            run is too short for that to grow from round-off.
        window: statistics of whole periods of the cycle; else of a run that begins where the motion
            has settled, so that nothing of what it settled from is in them; None where it has died
            out.
    """

    kind: Kind
    frequency: float
    resolution: float
    exponent: float
    cycle: Cycle | None
    lines: np.ndarray
    amplitudes: np.ndarray
    late_growth: float = 0.0
    leaves: bool = False
    window: StructureWindows | None = None


def described(
    plant: Plant, settled: SettledRun, how: Running, before: float = 0.0
) -> Described:
    """Run on from where a start has settled.

    Args:
        before: the late growth that an earlier, shorter run showed.
    """
    nothing = np.empty(0)
    if settled.quiet:
        return Described(
            Kind.steady_sliding, np.nan, np.nan, np.nan, None, nothing, nothing
        )
    beside = _beside(plant, settled, how)
    times, stopped, lost, apart = beside.times, stop_is_asked(), False, _Apart()
    if stopped:  # a kind takes longer than somebody waits who has asked for an end
        times = beside.early
    else:
        apart = _early_apart(plant, settled, beside, how)
        lost = apart.loses_neighbours
    length = float(times[-1])
    room = int(2.0 * length * settled.last.events / settled.last.length) + 64
    logged = 0 if lost else room
    states, regimes = beside.states, beside.regimes
    raw = run(plant, states[:1], times, how, regime=regimes[:1], log_events=logged)
    if not lost and not stopped:
        others = run(plant, states[1:], times, how, regime=regimes[1:])["samples"]
        apart = _apart(plant, [*raw["samples"], *others], times, beside.extent)
        lost = apart.grown >= KindRules.exponential_growth
    window = statistics_of(plant, raw, length).row(0)
    modal = plant.modal_velocities(raw["samples"][0])
    step, resolution = float(times[0]), 1.0 / length
    omega, amplitude = amplitude_spectrum(modal.T, step)
    power = np.sqrt((amplitude**2).sum(axis=0))
    frequency = strongest_line(modal.T, step)
    kind, cycle = Kind.undetermined, None
    rules, late = settling_of_numbers, apart.late_growth
    leaves = late > rules.still_grows and late > rules.proportional * before
    if lost:
        kind = Kind.irregular
        leaves = apart.exponent * float(settled.last.length) < rules.irregular
    elif not stopped:
        # on a torus near returns are many, and closing each takes minutes; there the area that
        # neighbours span does not shrink for long, as it does where a cycle is neared slowly
        if _repeats(raw, length, _within(late)):
            cycle = _closed(plant, settled, raw, frequency)
        if cycle is not None:
            kind, leaves = Kind.cycle, False
            window = _of_cycle(plant, cycle, how, window)
        elif apart.grown <= KindRules.linear_growth and not _repeats(
            raw, length, KindRules.repeated_intervals
        ):
            kind = Kind.torus
    lines = omega / (2.0 * np.pi)
    if leaves:
        kind = Kind.undetermined
    return Described(
        kind,
        frequency,
        resolution,
        apart.exponent,
        cycle,
        lines,
        power,
        late,
        leaves,
        window,
    )


def _within(late_growth: float) -> float:
    """Return the difference of intervals up to which a cycle is searched for."""
    if late_growth < -settling_of_numbers.still_grows:
        return KindRules.slowly_neared
    return KindRules.nearly_repeated


def _of_cycle(
    plant: Plant, cycle: Cycle, how: Running, ended: StructureWindows
) -> StructureWindows:
    """Return the statistics of whole periods of a cycle, and the end of the run that came to it."""
    state, number = cycle.start()
    regimes = np.atleast_2d(cycle.map.flow.system.joint.regimes(number))
    length = KindRules.cycle_periods * cycle.period
    count = KindRules.cycle_samples
    times = length * np.append((np.arange(count) + 0.5) / count, 1.0)
    raw = run(plant, state[None], times, how, regime=regimes)
    whole = statistics_of(plant, raw, length).row(0)
    # not in the middle of a leg, where what is sampled in step with the period is symmetric
    return replace(whole, final=ended.final, regimes=ended.regimes)


def is_irregular(plant: Plant, settled: SettledRun, how: Running) -> bool:
    """Tell whether neighbours of a settled motion are lost soon, and not as it leaves a cycle."""
    if settled.quiet or not settled.agrees:
        return False
    apart = _early_apart(plant, settled, _beside(plant, settled, how), how)
    stays = apart.exponent * float(settled.last.length) >= settling_of_numbers.irregular
    return bool(apart.loses_neighbours and stays)


class _Beside(NamedTuple):
    """A motion and its neighbours: states (runs, 2 n) and regimes where they start, instants at
    which they are looked at (s), and the size of the motion.
    """

    states: np.ndarray
    regimes: np.ndarray
    times: np.ndarray
    extent: float

    @property
    def early(self) -> np.ndarray:
        """Return the instants of the first part of the run."""
        return self.times[: len(self.times) // KindRules.early]


def _beside(plant: Plant, settled: SettledRun, how: Running) -> _Beside:
    """Return where a motion goes on from its last window, and neighbours at random beside it."""
    length = max(KindRules.periods / plant.slowest, 0.5 * float(settled.last.length))
    step = 1.0 / (KindRules.samples_per_period * plant.fastest)
    # a number of instants whose spectrum is computed fast
    count = min(next_fast_len(int(np.ceil(length / step))), KindRules.most_samples)
    rng = np.random.default_rng(how.seed)
    base = settled.last.final
    extent = float(plant.sizes(base - plant.sliding))
    directions = rng.standard_normal((KindRules.neighbours, base.size)) * np.abs(
        base - plant.sliding
    )
    directions *= KindRules.first_distance * extent / plant.sizes(directions)[:, None]
    states = np.concatenate([base[None], base + directions])
    # all start in the regimes of the motion, but for a contact that is just at a switch
    regimes = np.tile(settled.last.regimes, (len(states), 1))
    return _Beside(states, regimes, step * np.arange(1, count + 1), extent)


class _Apart(NamedTuple):
    """Distance of neighbours: its largest growth, growth rate (1/s), the late growth of the area
    that they span (ln), and whether they have separated as far as they can.
    """

    grown: float = np.nan
    exponent: float = np.nan
    late_growth: float = 0.0
    saturates: bool = False

    @property
    def loses_neighbours(self) -> bool:
        """Tell whether neighbours have run away exponentially, as far as they can."""
        return self.saturates and self.grown >= KindRules.exponential_growth


def _early_apart(
    plant: Plant, settled: SettledRun, beside: _Beside, how: Running
) -> _Apart:
    """Look at three neighbours until they are lost, or seem not to be within the run."""
    for one, known in plant.neighbours:
        if one is settled:
            return _Apart(*known)
    states, regimes, times = beside.states[:4], beside.regimes[:4], beside.times
    parts, begin, end = [], 0, len(beside.early)
    while True:
        instants = times[begin:end] - (times[begin - 1] if begin else 0.0)
        raw = run(plant, states, instants, how, regime=regimes)
        parts.append(raw["samples"])
        states, regimes = raw["final"], raw["sample_regimes"][:, -1].copy()
        samples = np.concatenate(parts, axis=1)
        apart = _apart(plant, [*samples], times[:end], beside.extent)
        lost = KindRules.saturation / KindRules.first_distance
        is_soon = apart.grown ** (len(times) / end) >= lost
        if apart.loses_neighbours or not is_soon or end == len(times):
            plant.neighbours.append((settled, apart))
            return apart
        begin, end = end, min(2 * end, len(times))


def _apart(
    plant: Plant, runs: Sequence[np.ndarray], times: np.ndarray, extent: float
) -> _Apart:
    """Return how far neighbours have run away from the first run, and how fast.

    The distance is the median over all neighbours. Its part along the motion keeps its size, which
    hides what grows slowly beside it; an area spanned with that direction shows it at once.
    """
    samples = np.asarray(runs)
    # many periods at once: distances swing within each
    blocks = np.array_split(np.arange(len(times)), 40)
    spread, areas = np.empty(len(blocks)), np.empty(len(blocks))
    for index, block in enumerate(blocks):
        away = plant.coordinates(samples[1:, block] - samples[:1, block]) / extent
        gram = np.einsum("itk,jtk->tij", away, away)
        square = np.einsum("tii->ti", gram)
        spread[index] = np.median(np.sqrt(square.max(axis=0)))
        # the sum of all areas of two, by the second elementary symmetric polynomial of the roots
        area = square.sum(axis=1) ** 2 - (gram**2).sum(axis=(1, 2))
        areas[index] = np.sqrt(max(0.5 * float(area.max()), 0.0))
    middles = np.array([times[block].mean() for block in blocks])
    grown = float(spread.max() / spread[0])
    far = np.flatnonzero(spread > KindRules.saturation)
    grows = slice(max(int(far[0]), 3) + 1 if far.size else None)
    rate = np.polyfit(middles[grows], np.log(spread[grows] + 1e-300), 1)[0]
    late = float(late_growth(np.log(areas + 1e-300)))
    return _Apart(grown, float(rate), late, bool(far.size))


def _repeats(raw: dict[str, np.ndarray], length: float, within: float) -> bool:
    """Return whether the second half has a period, by its events."""
    count = int(raw["n_events"][0])
    at, kinds = raw["event_times"][0, :count], raw["event_kinds"][0, :count]
    late = at > 0.5 * length
    return repeats_after(at[late], kinds[late], within) > 0


def stable_cycle(
    plant: Plant,
    state: np.ndarray,
    regimes: np.ndarray,
    frequency: float,
    **parameters: float,
) -> Cycle | None:
    """The stable cycle near a state, if the exact map closes one there.

    Args:
        frequency: of the motion, Hz.
        parameters: of the system, where they are not its own.
    """
    system = plant.traced_system
    if system is None:
        return None
    values: dict[str, Any] = {**system.parameters, **parameters}
    regime = system.joint.number(regimes.tolist())
    cycle, outcome = find_cycle(
        system, values, state, guess=True, regime=regime, unit=1.0 / frequency
    )
    if cycle is None or outcome != Outcome.converged or not cycle.is_stable:
        return None
    return cycle


def _closed(
    plant: Plant, settled: SettledRun, raw: dict[str, np.ndarray], frequency: float
) -> Cycle | None:
    """The stable cycle through the end of the run, if the exact map finds it there."""
    if raw["outcome"][0] != Outcome.converged or not np.isfinite(frequency):
        return None
    cycle = stable_cycle(
        plant, raw["final"][0], raw["sample_regimes"][0, -1], frequency
    )
    if cycle is None:
        return None
    # the same motion: as many events in a period as in the run
    rate = len(cycle.events) / cycle.period
    seen = float(settled.last.events / settled.last.length)
    return cycle if abs(rate - seen) <= 0.05 * seen else None
