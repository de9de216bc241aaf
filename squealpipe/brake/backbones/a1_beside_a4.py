"""Runs of model A1 that start on periodic motions of model A4."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.brake.a4.orbits import find_orbit
from squealpipe.brake.a4.system import scaled_system
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.orbits.orbit_shape import sample
from squealpipe.brake.schema.backbones import a1_beside_a4_schema
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.vibration.spectrum import amplitude_spectrum, highest_peaks

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class ComparisonRun:
    """Run of A1 that starts on a periodic motion of A4, and its spectrum."""

    periods: int = 32
    """Periods of the run; more resolve the spectrum better."""
    samples: int = 64
    """Samples of each period."""
    shown_periods: int = 4
    """Periods that are kept as a time history."""
    orders: int = 5
    """Multiples of the frequency that the spectrum reaches."""
    padding: int = 4
    """Times that the spectrum's grid is finer than its resolution: smooth peaks."""
    neighbourhood: float = 0.5
    """Orders around 1 in which the strongest line is sought."""


run_settings = ComparisonRun()


def a1_beside_a4(
    params: Parameters,
    branches: Mapping[str, tuple[float, float, int]],
    *,
    peak: float,
    length_ratios: Sequence[float],
) -> xr.Dataset:
    """Histories and spectra of y in A1 and A4 from the same start, over spring lengths.

    A4 is the limit of long springs; how soon A1 leaves its orbit shows what the exact geometry
    and friction do at that amplitude.

    Args:
        branches: name → (alpha1, alpha2, mode).
        peak: y_peak over l_pre; length_ratios: spring lengths over l_pre.
    """
    phases = (
        np.arange(run_settings.periods * run_settings.samples) / run_settings.samples
    )
    kept = phases < run_settings.shown_periods
    orders = np.arange(
        run_settings.orders * run_settings.periods * run_settings.padding
    ) / (run_settings.periods * run_settings.padding)
    near = np.abs(orders - 1.0) < run_settings.neighbourhood
    shape = len(branches), len(length_ratios)
    histories = np.full((*shape, int(kept.sum())), np.nan)
    spectra = np.full((*shape, len(orders)), np.nan)
    dominant = np.full(shape, np.nan)
    outcome = np.full(shape, Outcome.converged, dtype=int)
    omegas, references = [], []

    def spectrum(history: Vector) -> Vector:
        return amplitude_spectrum(history, 1.0, padding=run_settings.padding)[1][
            ..., : len(orders)
        ]

    for i, (name, (alpha1, alpha2, mode)) in enumerate(branches.items()):
        scene = scaled_system(params, alpha1, alpha2)
        orbit, why = find_orbit(scene, mode, peak)
        if orbit is None:
            raise ValueError(f"{name}: no orbit of A4 at peak {peak!r} ({why.name})")
        omega = orbit.omega * scene.frequency
        omegas.append(omega)
        references.append(_repeated(scene.system.rows, orbit.point) * scene.length)
        for j, ratio in enumerate(length_ratios):
            length = ratio * params.preload
            run = simulate(
                params.with_(length1=length, length2=length),
                alpha1,
                alpha2,
                t_end=float(2.0 * math.pi / omega * phases[-1]),
                times=2.0 * math.pi / omega * phases,
                initial_state=(*(orbit.point[:2] * scene.length), 0.0, 0.0),
            )
            outcome[i, j] = int(run.outcome)
            histories[i, j] = run.y.values[kept]
            if np.isfinite(run.y.values).all():
                spectra[i, j] = spectrum(run.y.values)
                peaks, _ = highest_peaks(orders[near], spectra[i, j, near], 1)
                dominant[i, j] = omega * next(iter(peaks), np.nan)
    return build(
        a1_beside_a4_schema,
        {
            "omega": omegas,
            "y_a4": np.array([history[kept] for history in references]),
            "y_a1": histories,
            "spectrum_a4": spectrum(np.array(references)),
            "spectrum_a1": spectra,
            "omega_a1": dominant,
            "outcome": outcome,
        },
        {
            "scene": list(branches),
            "length_ratio": np.asarray(length_ratios, float),
            "period": phases[kept],
            "order": orders,
        },
    )


def _repeated(rows: NDArray[np.void], point: Vector) -> Vector:
    """y over all periods of the run, from half a period by symmetry."""
    half = sample(
        rows, point, np.linspace(0.0, math.pi, run_settings.samples // 2 + 1)
    )[:, 1]
    return np.tile(np.concatenate([half, half[-2:0:-1]]), run_settings.periods)
