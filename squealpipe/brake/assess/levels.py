"""Level, frequency and picture of a settled motion, from one more run of it.

An irregular motion is run on in blocks: its numbers are means over them, with the error that their
scatter leaves, and its spectrum is the mean of theirs (Welch's method).
"""

import math
from typing import Any

import numpy as np
from scipy.special import stdtrit

from squealpipe.brake.a1.ensemble import PEAK, Ensemble, run_ensemble
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.schema.assess import (
    HARMONICS,
    LINES,
    MEAN_SQUARES,
    MEANS,
    SAMPLES,
    WITH_ERROR,
    error_of,
)
from squealpipe.codes import Regime, Verdict
from squealpipe.laws.contact import normal_force
from squealpipe.schema import Outcome
from squealpipe.systems.recurrence import repeats_after
from squealpipe.vibration.parabola import largest
from squealpipe.vibration.settled_runs import SettledRun
from squealpipe.vibration.settling import tapered
from squealpipe.vibration.spectrum import amplitude_spectrum, highest_peaks

PERIODS = 400.0
"""Length of the run, in periods."""
FINE = 32
"""Samples in each period."""
SHOWN = 12.0
"""Periods that the picture shows."""
PADDING = 4
"""How much finer the grid of the peaks is than the resolution."""
REPEATS = 1e-4
"""Largest difference of event intervals of a periodic motion, over their mean."""
ALIKE = 1e-2
"""Largest distance, over the motion's size, at which states one period apart are the same."""
MOST_EVENTS = 20_000
BLOCKS = 16
"""Runs of :data:`PERIODS` that measure an irregular motion; a torus gets no more."""


def still() -> dict[str, Any]:
    """The scalars of a motion that has died out."""
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


def levels(
    design: Design, settled: SettledRun, sliding: Sliding | None, *, tol: float
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Scalars of a settled motion, and its spectrum and path.

    Of a motion that has died out the scalars are those of steady sliding, and there is no spectrum.
    """
    run, times = _run(design, settled.last.final, tol)
    spectrum = _spectrum(design, [run], times)
    strongest = spectrum["harmonic_frequency"][0]
    periodic = settled.verdict is not Verdict.quiet and _repeats(run, times, strongest)
    blocks = [run]
    wanted = _blocks(design, settled, periodic)
    while len(blocks) < wanted and blocks[-1].outcome == Outcome.converged:
        blocks.append(_run(design, blocks[-1].final_state, tol)[0])
    scalars = _means([_scalars(design, block) for block in blocks])
    scalars |= {"frequency": np.nan, error_of("frequency"): 0.0}
    if len(blocks) > 1:
        lines = [_strongest(design, block, times) for block in blocks]
        scalars[error_of("frequency")] = float(np.std(lines, ddof=1))
        spectrum = _spectrum(design, blocks, times)
        strongest = spectrum["harmonic_frequency"][0]
    if settled.verdict is Verdict.undetermined:
        scalars |= dict.fromkeys(map(error_of, WITH_ERROR), np.nan)
    if settled.verdict is Verdict.quiet:
        force = scalars["peak_contact_force"] if sliding is None else sliding.force
        load = design.params.k3 * design.params.preload
        scalars |= still() | {
            "peak_contact_force": force,
            "peak_contact_force_over_preload": force / load,
        }
    else:
        scalars |= {"frequency": strongest, "periodic": periodic}
    scalars["settled_by"] = settled.elapsed
    scalars["verdict"] = settled.verdict
    return scalars, spectrum | _path(design, run, times)


def _blocks(design: Design, settled: SettledRun, periodic: bool) -> int:
    """Return how many runs measure a motion.

    A torus is measured for as long as it took to settle: its beat may be longer than one run.
    """
    if settled.irregular:
        return BLOCKS
    if periodic or settled.verdict in (Verdict.quiet, Verdict.undetermined):
        return 1
    settled_in = settled.elapsed / (PERIODS * design.period)
    return int(min(max(np.ceil(settled_in), 2), BLOCKS))


def _strongest(design: Design, run: Ensemble, times: np.ndarray) -> float:
    """Strongest line of a run, Hz."""
    return float(_spectrum(design, [run], times)["harmonic_frequency"][0])


def _run(design: Design, state: np.ndarray, tol: float) -> tuple[Ensemble, np.ndarray]:
    length = PERIODS * design.period
    times = np.linspace(0.0, length, int(PERIODS * FINE) + 1)[1:]
    run = run_ensemble(
        design.params,
        design.alpha1,
        design.alpha2,
        t_end=length,
        times=times,
        initial_state=state,
        tol=tol,
        tracked=(PEAK,),
        sums=True,
        log_events=MOST_EVENTS,
        workers=1,
    )
    return run, times


def _scalars(design: Design, run: Ensemble) -> dict[str, Any]:
    """Scalars of a run, tapered: a low line has few periods in it, whose last is cut off."""
    known = np.isfinite(run.samples[:, 0])
    count = int(known.sum())
    if not count:  # a run that is lost at once, as at a pivot
        return dict.fromkeys(still(), np.nan) | dict.fromkeys(
            ("peak_contact_force", "peak_contact_force_over_preload"), np.nan
        )
    place, velocity = np.split(run.samples[known], 2, axis=1)
    step = float(run.time) / count
    along, across = np.sqrt(tapered(velocity**2))
    rates = {
        name: float(tapered(np.diff(total[known], prepend=0.0)) / step)
        for name, total in (
            ("impact_rate", run.sample_contacts),
            ("separated_fraction", run.sample_separated_time),
            ("stick_fraction", run.sample_stick_time),
        )
    }
    load = design.params.k3 * design.params.preload
    return {
        "velocity_rms_along": float(along),
        "velocity_rms_across": float(across),
        "displacement_peak": float(largest(np.hypot(*(place - tapered(place)).T))),
        "peak_contact_force": float(run.peak_contact_force) * load,
        "peak_contact_force_over_preload": float(run.peak_contact_force),
        "impact_speed": float(run.impact_speed),
        **rates,
    }


def _means(blocks: list[dict[str, float]]) -> dict[str, float]:
    """Scalars of a motion by those of its blocks, and their statistical errors.

    Mean squares and shares are averaged, the largest of what is a largest value is kept.
    """
    found = {}
    for name in blocks[0]:
        values = np.array([block[name] for block in blocks])
        if name not in MEANS:
            found[name] = float(np.fmax.reduce(values))
            continue
        power = 2 if name in MEAN_SQUARES else 1
        powers = values**power
        mean = float(np.mean(powers)) ** (1.0 / power)
        found[name], found[error_of(name)] = mean, 0.0
        if values.size > 1 and mean > 0.0:
            error = error_of_mean(powers)
            found[error_of(name)] = error / (power * mean ** (power - 1))
    return found


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


def _force(design: Design, run: Ensemble) -> np.ndarray:
    """Contact force over k3 l_pre at the samples."""
    params = design.params
    _, y, _, vy = run.samples.T
    force = normal_force(y, vy, params) / (params.k3 * params.preload)
    off = run.sample_regimes == Regime.separated.value
    return np.where(off, 0.0, force)


def _spectrum(
    design: Design, blocks: list[Ensemble], times: np.ndarray
) -> dict[str, Any]:
    step = float(times[1] - times[0])
    signals = np.stack(
        [[*run.samples[:, 2:].T, _force(design, run)] for run in blocks], axis=1
    )
    if not np.isfinite(signals).all():
        return {
            "frequency_resolution": np.nan,
            **dict.fromkeys(
                ("harmonic_frequency", "harmonic_velocity"), np.full(HARMONICS, np.nan)
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
    frequency, amplitude = amplitude_spectrum(signals, step, padding=PADDING)
    amplitude = np.sqrt((amplitude**2).mean(axis=1))
    frequency = frequency / (2.0 * np.pi)
    deviation = np.sqrt((signals.var(axis=2)).mean(axis=1))
    louder = int(deviation[1] > deviation[0])
    peaks, _ = highest_peaks(frequency, amplitude[louder], 1)
    strongest = float(peaks[0]) if peaks.size else np.nan
    resolution = 1.0 / float(times[-1])
    multiples = strongest * np.arange(1, HARMONICS + 1)
    near = np.abs(frequency[:, None] - multiples) <= resolution
    heights = np.where(near, amplitude[louder][:, None], 0.0).max(axis=0)
    # lines as far apart as the resolution: peaks keep their heights, whatever lies between is less
    lines = amplitude[:, : LINES * PADDING].reshape(3, LINES, PADDING).max(axis=2)
    return {
        "frequency_resolution": resolution,
        "harmonic_frequency": multiples,
        "harmonic_velocity": np.where(np.isfinite(multiples), heights, np.nan),
        "line_frequency": frequency[: LINES * PADDING : PADDING],
        "velocity_spectrum_along": lines[0],
        "velocity_spectrum_across": lines[1],
        "force_spectrum": lines[2],
    }


def _path(design: Design, run: Ensemble, times: np.ndarray) -> dict[str, Any]:
    """The last periods, at :data:`SAMPLES` instants of the samples."""
    first = times.size - int(SHOWN * FINE) - 1
    at = np.unique(np.linspace(first, times.size - 1, SAMPLES).astype(int))
    at = np.concatenate([np.full(SAMPLES - at.size, at[0]), at])
    return {
        "path_time": times[at] - times[at[0]],
        "path_x": run.samples[at, 0],
        "path_y": run.samples[at, 1],
        "path_force": _force(design, run)[at],
        "path_regime": run.sample_regimes[at],
    }


def _repeats(run: Ensemble, times: np.ndarray, frequency: float) -> bool:
    """Return whether the motion is periodic: by its events, or, where it has
    none, by its states.
    """
    if not np.isfinite(frequency):
        return False
    count = min(int(run.events), MOST_EVENTS)
    if count:
        logged = run.event_times[:count], run.event_kinds[:count]
        return bool(repeats_after(*logged, REPEATS))
    path = run.samples
    later = times - times[0] >= 1.0 / frequency
    before = np.stack(
        [np.interp(times[later] - 1.0 / frequency, times, each) for each in path.T], -1
    )
    return bool((np.abs(path[later] - before) <= ALIKE * np.ptp(path, axis=0)).all())
