"""Level, frequency and picture of a settled motion, from one more run of it."""

from typing import Any

import numpy as np

from squealpipe.codes import Regime
from squealpipe.laws.contact import normal_force
from squealpipe.methods.parabola import largest
from squealpipe.methods.recurrence import repeats_after
from squealpipe.methods.spectrum import amplitude_spectrum, highest_peaks
from squealpipe.schema.assess import HARMONICS, LINES, SAMPLES, Verdict
from squealpipe.solvers.a1.ensemble import PEAK, Ensemble, run_ensemble
from squealpipe.tasks.assess.settling import Settled
from squealpipe.tasks.assess.sliding import Design, Sliding

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
    }


def levels(
    design: Design, settled: Settled, sliding: Sliding | None, *, tol: float
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Scalars of a settled motion, and its spectrum and path.

    Of a motion that has died out the scalars are those of steady sliding, and there is no spectrum.
    """
    run, times = _run(design, settled.last.final, tol)
    scalars = _scalars(design, run)
    if settled.verdict is Verdict.quiet:
        force = scalars["peak_contact_force"] if sliding is None else sliding.force
        load = design.params.k3 * design.params.preload
        scalars |= still() | {
            "peak_contact_force": force,
            "peak_contact_force_over_preload": force / load,
        }
    spectrum = _spectrum(design, run, times)
    if settled.verdict is not Verdict.quiet:
        scalars["frequency"] = spectrum["harmonic_frequency"][0]
        scalars["periodic"] = _repeats(run, times, scalars["frequency"])
    scalars["settled_by"] = settled.time
    scalars["verdict"] = settled.verdict
    return scalars, spectrum | _path(design, run, times)


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
        log_events=MOST_EVENTS,
        workers=1,
    )
    return run, times


def _scalars(design: Design, run: Ensemble) -> dict[str, Any]:
    states = run.samples[np.isfinite(run.samples[:, 0])]
    x, y, vx, vy = states.T
    time = max(float(run.time), float(np.finfo(float).tiny))
    load = design.params.k3 * design.params.preload
    return {
        "velocity_rms_along": float(np.sqrt(np.mean(vx**2))),
        "velocity_rms_across": float(np.sqrt(np.mean(vy**2))),
        "displacement_peak": float(largest(np.hypot(x - x.mean(), y - y.mean()))),
        "peak_contact_force": float(run.peak_contact_force) * load,
        "peak_contact_force_over_preload": float(run.peak_contact_force),
        "impact_speed": float(run.impact_speed),
        "impact_rate": float(run.contacts) / time,
        "separated_fraction": float(run.separated_time) / time,
        "stick_fraction": float(run.stick_time) / time,
    }


def _force(design: Design, run: Ensemble) -> np.ndarray:
    """Contact force over k3 l_pre at the samples."""
    params = design.params
    _, y, _, vy = run.samples.T
    force = normal_force(y, vy, params) / (params.k3 * params.preload)
    off = run.sample_regimes == Regime.separated.value
    return np.where(off, 0.0, force)


def _spectrum(design: Design, run: Ensemble, times: np.ndarray) -> dict[str, Any]:
    step = float(times[1] - times[0])
    signals = np.stack([*run.samples[:, 2:].T, _force(design, run)])
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
    frequency = frequency / (2.0 * np.pi)
    louder = int(signals[1].std() > signals[0].std())
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
    """Whether the motion is periodic: by its events, or, where it has none, by its states."""
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
