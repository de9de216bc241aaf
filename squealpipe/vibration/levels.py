"""Measure a settled motion: level, frequency, shares of contact loss and stick, spectrum, picture.

Idea: the motion is run on from where it has settled and recorded at uniform instants. Means are
tapered, so that neither end of the record counts. An irregular motion is recorded in blocks: its
numbers are means over them, with the error that their scatter leaves, and its spectrum is the mean
of theirs (Welch's method).

Invariant: a motion that has died out has the level 0 exactly, and the force of steady sliding.
Cost: 400 periods of a regular motion, sixteen times as many of an irregular one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.special import stdtrit

from squealpipe.codes import Verdict
from squealpipe.systems.recurrence import repeats_after
from squealpipe.vibration.parabola import largest
from squealpipe.vibration.schema import LINES, MEAN_SQUARES, MEANS, WITH_ERROR, error_of
from squealpipe.vibration.settled_runs import SettledRun
from squealpipe.vibration.settling import tapered
from squealpipe.vibration.spectrum import (
    amplitude_spectrum,
    loudest,
    loudest_line,
    strongest_line,
)


@dataclass(frozen=True)
class Measurement:
    """Lengths and thresholds of a measurement; each comment says what another value would do."""

    periods: float = 400.0
    """Length of a record, in periods. Twice as long: twice the resolution of frequencies."""
    fine: int = 32
    """Samples in each period. Half as many: peaks of displacement are off by 1 %."""
    shown: float = 12.0
    """Periods that the picture shows."""
    shown_instants: int = 800
    """Instants of the picture. Half as many: corners of impacts are cut off."""
    harmonics: int = 5
    """Multiples of the strongest line that are reported."""
    padding: int = 4
    """Resolution over the step of the grid in which peaks are sought. 2: frequencies are off by a
    hundredth of the resolution."""
    repeats: float = 1e-4
    """Largest difference of event intervals of a periodic motion, over their mean. Ten times as
    much: a torus near a resonance passes for periodic."""
    alike: float = 1e-2
    """Largest distance, over the motion's size, at which states one period apart are the same."""
    most_events: int = 20_000
    """Events of a record by which it is called periodic."""
    blocks: int = 16
    """Records that measure an irregular motion; a torus gets no more."""
    same_line: float = 0.05
    """A record's strongest line counts as a multiple of the motion's strongest line if it is within
    this relative distance of it. Twice as much: from the fifth multiple on all lines would."""


@dataclass(frozen=True)
class Record:
    """A settled motion at uniform instants.

    Attributes:
        times: (samples,), s, the first one step after the begin.
        states: what a periodic motion repeats, (samples, states).
        displacements, velocities: along and across the belt, (samples, contacts, 2), m and m/s.
        forces: contact forces over their preloads, (samples, contacts).
        regimes: of each contact, (samples, contacts); codes of ``Regime``.
        open_time, stick_time: time that has added up, (samples, contacts), s.
        landings: returns to contact that have added up, (samples, contacts).
        peak_forces: largest force of each contact, (contacts,), N.
        impact_speed: largest speed towards the belt at a return, m/s; NaN without any.
        event_times, event_kinds: of the first events, (events,).
        end: what the next record goes on from.
        duration: time that was run, s.
        finished: whether the run reached its end.
    """

    times: np.ndarray
    states: np.ndarray
    displacements: np.ndarray
    velocities: np.ndarray
    forces: np.ndarray
    regimes: np.ndarray
    open_time: np.ndarray
    stick_time: np.ndarray
    landings: np.ndarray
    peak_forces: np.ndarray
    impact_speed: float
    event_times: np.ndarray
    event_kinds: np.ndarray
    end: Any
    duration: float
    finished: bool

    def for_spectrum(self) -> Record:
        """Return the record without what a spectrum does not need, three quarters of it."""
        nothing = np.empty(0)
        return replace(
            self,
            states=nothing,
            displacements=nothing,
            regimes=nothing,
            open_time=nothing,
            stick_time=nothing,
            landings=nothing,
        )

    @property
    def signals(self) -> Any:
        """Velocities of all contacts along the belt, then across it, (2, contacts, samples)."""
        return np.moveaxis(self.velocities, 0, -1).swapaxes(0, 1)


def levels(
    record: Callable[[Any], Record],
    settled: SettledRun,
    *,
    begin: Any,
    period: float,
    loads: np.ndarray,
    sliding_forces: np.ndarray | None,
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return scalars of a settled motion, and its spectrum, path and values by contact.

    Of a motion that has died out the scalars are those of steady sliding, and there is no spectrum.
    Of several contacts levels along and across the belt are root mean squares, all other scalars
    are the largest.

    Args:
        record: runs the motion on for 400 periods, from ``begin`` or the end of another record.
        period: unit of the lengths, s.
        loads: preload of each contact, N.
        sliding_forces: force of each contact in steady sliding, N; None if there is none.
    """
    first = record(begin)
    spectrum = _spectrum([first])
    strongest = spectrum["harmonic_frequency"][0]
    periodic = not settled.quiet and _repeats(first, strongest)
    blocks, rows, contacts = [first], [_scalars(first, loads)], [_of_contacts(first)]
    wanted = _blocks(settled, period, periodic)
    while len(blocks) < wanted and blocks[-1].finished:
        block = record(blocks[-1].end)
        if not block.finished:  # it ended early: it has no spectrum
            break
        rows.append(_scalars(block, loads))
        contacts.append(_of_contacts(block))
        blocks.append(block.for_spectrum())
    by_contact = _by_contact(contacts)
    scalars = _means(rows)
    scalars |= {"frequency": np.nan, error_of("frequency"): 0.0}
    if len(blocks) > 1:
        lines = [loudest_line([block.signals], _step(block)) for block in blocks]
        spectrum = _spectrum(blocks)
        strongest = spectrum["harmonic_frequency"][0]
        scalars[error_of("frequency")] = _scatter(np.array(lines), strongest)
    if settled.verdict is Verdict.undetermined:
        scalars |= dict.fromkeys(map(error_of, WITH_ERROR), np.nan)
    if settled.quiet:
        forces = (
            np.array([scalars["peak_contact_force"]])
            if sliding_forces is None
            else sliding_forces
        )
        scalars |= still() | {
            "peak_contact_force": float(forces.max()),
            "peak_contact_force_over_preload": float((forces / loads).max()),
        }
        by_contact = {name: np.zeros_like(value) for name, value in by_contact.items()}
        by_contact["contact_peak_force"] = forces
    else:
        scalars |= {"frequency": strongest, "periodic": periodic}
    scalars["settled_by"] = settled.elapsed
    scalars["verdict"] = settled.verdict
    return scalars, spectrum | _path(first, period) | by_contact


def still() -> dict[str, Any]:
    """Return the scalars of a motion that has died out."""
    return {
        "periodic": False,
        "frequency": np.nan,
        "velocity_rms_along": 0.0,
        "velocity_rms_across": 0.0,
        "displacement_peak": 0.0,
        "impact_speed": np.nan,
        "impact_rate": 0.0,
        "separated_fraction": 0.0,
        "stick_fraction": 0.0,
        **dict.fromkeys(map(error_of, WITH_ERROR), 0.0),
    }


def _blocks(settled: SettledRun, period: float, periodic: bool) -> int:
    """Return how many records measure a motion.

    A torus is measured for as long as it took to settle: its beat may be longer than one record.
    """
    if settled.irregular:
        return Measurement.blocks
    if periodic or settled.verdict in (Verdict.quiet, Verdict.undetermined):
        return 1
    settled_in = settled.elapsed / (Measurement.periods * period)
    return int(min(max(np.ceil(settled_in), 2), Measurement.blocks))


def _known(record: Record) -> np.ndarray:
    """Samples that the run has reached, (samples,)."""
    return np.asarray(np.isfinite(record.states[:, 0]))


def _scalars(record: Record, loads: np.ndarray) -> dict[str, Any]:
    """Scalars of a record, tapered: a low line has few periods in it, whose last is cut off."""
    known = _known(record)
    count = int(known.sum())
    if not count:  # a run that is lost at once, as at a pivot
        return dict.fromkeys(still(), np.nan) | dict.fromkeys(
            ("peak_contact_force", "peak_contact_force_over_preload"), np.nan
        )
    displacement, velocity = record.displacements[known], record.velocities[known]
    along, across = np.sqrt(tapered(velocity**2).mean(axis=0))
    rates = _rates(record, known, count)
    away = np.hypot(*np.moveaxis(displacement - tapered(displacement), -1, 0))
    return {
        "velocity_rms_along": float(along),
        "velocity_rms_across": float(across),
        "displacement_peak": float(largest(away.T).max()),
        "peak_contact_force": float(record.peak_forces.max()),
        "peak_contact_force_over_preload": float((record.peak_forces / loads).max()),
        "impact_speed": record.impact_speed,
        **{name: float(value.max()) for name, value in rates.items()},
    }


def _rates(record: Record, known: np.ndarray, count: int) -> dict[str, np.ndarray]:
    """Return tapered impact rates and shares of the time of each contact."""
    step = record.duration / count
    return {
        name: tapered(np.diff(total[known], prepend=0.0, axis=0)) / step
        for name, total in (
            ("impact_rate", record.landings),
            ("separated_fraction", record.open_time),
            ("stick_fraction", record.stick_time),
        )
    }


def _of_contacts(record: Record) -> dict[str, np.ndarray]:
    """Mean squares of velocities, shares and forces of each contact in one record."""
    known = _known(record)
    count = int(known.sum())
    forces = {"peak_force": record.peak_forces}
    if not count:
        return forces
    rates = _rates(record, known, count)
    return forces | {
        "square": tapered(record.velocities[known] ** 2),
        "opened": rates["separated_fraction"],
        "stuck": rates["stick_fraction"],
    }


def _by_contact(blocks: Sequence[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Return levels, shares and forces of each contact, means over the blocks."""
    known = [block for block in blocks if "square" in block]
    forces = np.max([block["peak_force"] for block in blocks], axis=0)
    nothing = np.full(forces.size, np.nan)

    def mean(name: str) -> Any:
        return np.mean([block[name] for block in known], axis=0)

    return {
        "contact_velocity_rms": np.sqrt(mean("square"))
        if known
        else np.full((forces.size, 2), np.nan),
        "contact_separated_fraction": mean("opened") if known else nothing,
        "contact_stick_fraction": mean("stuck") if known else nothing,
        "contact_peak_force": forces,
    }


def _means(blocks: list[dict[str, float]]) -> dict[str, float]:
    """Scalars of a motion by those of its blocks, and their statistical errors.

    Mean squares and shares are averaged, the largest of what is a largest value is kept.
    """
    means = {}
    for name in blocks[0]:
        values = np.array([block[name] for block in blocks])
        if name not in MEANS:
            means[name] = float(np.fmax.reduce(values))
            continue
        power = 2 if name in MEAN_SQUARES else 1
        powers = values**power
        mean = float(np.mean(powers)) ** (1.0 / power)
        means[name], means[error_of(name)] = mean, 0.0
        if values.size > 1 and mean > 0.0:
            error = error_of_mean(powers)
            means[error_of(name)] = error / (power * mean ** (power - 1))
    return means


def error_of_mean(values: np.ndarray) -> float:
    """Return half of the 95 % interval of the mean of blocks that may depend on one another.

    Neighbours are merged, which keeps the error where they are independent and makes it larger
    where they are not (Flyvbjerg and Petersen, Journal of Chemical Physics 91 (1989)
    461-466); the largest counts.
    """
    error, size = 0.0, len(values)
    while size >= 2:
        deviation = float(np.std(values, ddof=1)) / math.sqrt(size)
        error = max(error, float(stdtrit(size - 1, 0.975)) * deviation)
        if size < 8:  # the scatter of fewer blocks is too uncertain itself
            break
        size //= 2
        values = values[: 2 * size].reshape(size, 2).mean(axis=1)
    return error


def _scatter(lines: np.ndarray, strongest: float) -> float:
    """Return the standard deviation of the strongest lines of blocks, Hz.

    Where impacts are hard, a multiple may be higher than the line itself in some blocks, although
    the motion keeps its pace: such a line counts as the one that it is a multiple of.
    """
    multiple = np.clip(np.rint(lines / strongest), 1, Measurement.harmonics)
    base = lines / multiple
    same = np.abs(base / strongest - 1.0) <= Measurement.same_line
    return float(np.std(np.where(same, base, lines), ddof=1))


def _spectrum(blocks: Sequence[Record]) -> dict[str, Any]:
    """Return lines and harmonics of the contact that moves most, by its louder component."""
    step = _step(blocks[0])
    variances = np.mean([block.signals.var(axis=-1) for block in blocks], axis=0)
    if not np.isfinite(variances).all():
        return _no_spectrum()
    contact, louder = loudest(variances)
    signals = np.stack(
        [[*block.signals[:, contact], block.forces[:, contact]] for block in blocks],
        axis=1,
    )
    if not np.isfinite(signals).all():
        return _no_spectrum()
    padding = Measurement.padding
    frequency, amplitude = amplitude_spectrum(signals, step, padding=padding)
    amplitude = np.sqrt((amplitude**2).mean(axis=1))
    frequency = frequency / (2.0 * np.pi)
    strongest = strongest_line(signals[louder], step)
    resolution = 1.0 / float(blocks[0].times[-1])
    multiples = strongest * np.arange(1, Measurement.harmonics + 1)
    near = np.abs(frequency[:, None] - multiples) <= resolution
    heights = np.where(near, amplitude[louder][:, None], 0.0).max(axis=0)
    # lines as far apart as the resolution, or more: peaks keep their heights
    merged = padding * max(1, math.ceil((frequency.size - 1) / (padding * LINES * 2)))
    count = min(LINES, (frequency.size - 1) // merged)
    lines = np.full((3, LINES), np.nan)
    lines[:, :count] = (
        amplitude[:, : count * merged].reshape(3, count, merged).max(axis=2)
    )
    line_frequencies = np.full(LINES, np.nan)
    line_frequencies[:count] = frequency[: count * merged : merged]
    return {
        "frequency_resolution": resolution,
        "harmonic_frequency": multiples,
        "harmonic_velocity": np.where(np.isfinite(multiples), heights, np.nan),
        "line_frequency": line_frequencies,
        "velocity_spectrum_along": lines[0],
        "velocity_spectrum_across": lines[1],
        "force_spectrum": lines[2],
    }


def _step(record: Record) -> float:
    """Return the time between samples, s."""
    return float(record.times[1] - record.times[0])


def _no_spectrum() -> dict[str, Any]:
    return {
        "frequency_resolution": np.nan,
        **dict.fromkeys(
            ("harmonic_frequency", "harmonic_velocity"),
            np.full(Measurement.harmonics, np.nan),
        ),
        **dict.fromkeys(
            (
                "line_frequency",
                "velocity_spectrum_along",
                "velocity_spectrum_across",
                "force_spectrum",
            ),
            np.full(LINES, np.nan),
        ),
    }


def _path(record: Record, period: float) -> dict[str, Any]:
    """Return the last periods of the contact that moves most, at evenly spaced instants."""
    times = record.times
    deviation = np.nan_to_num(record.signals.var(axis=-1)).sum(axis=0)
    contact = int(np.argmax(deviation))
    per_period = period / float(times[1] - times[0])
    first = max(times.size - int(Measurement.shown * per_period + 1e-6) - 1, 0)
    # instants of the settled motion that a dataset keeps
    samples = Measurement.shown_instants
    at = np.unique(np.linspace(first, times.size - 1, samples).astype(int))
    at = np.concatenate([np.full(samples - at.size, at[0]), at])
    return {
        "path_time": times[at] - times[at[0]],
        "path_x": record.displacements[at, contact, 0],
        "path_y": record.displacements[at, contact, 1],
        "path_force": record.forces[at, contact],
        "path_regime": record.regimes[at, contact],
    }


def _repeats(record: Record, frequency: float) -> bool:
    """Tell whether the motion is periodic: by its events, or, where it has none, by its states."""
    if not np.isfinite(frequency):
        return False
    if record.event_times.size:
        logged = record.event_times, record.event_kinds
        return bool(repeats_after(*logged, Measurement.repeats))
    path, times = record.states, record.times
    later = times - times[0] >= 1.0 / frequency
    before = np.stack(
        [np.interp(times[later] - 1.0 / frequency, times, each) for each in path.T], -1
    )
    near = np.abs(path[later] - before) <= Measurement.alike * np.ptp(path, axis=0)
    return bool(near.all())
