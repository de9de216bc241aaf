"""The paper's own form of harmonic balance against exact orbits."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.brake.a4.orbits import find_orbit
from squealpipe.brake.a4.system import ScaledSystem, scaled_system
from squealpipe.brake.balance.harmonic_balance import cosines_of
from squealpipe.brake.balance.sampled_balance import SampledBalance
from squealpipe.brake.orbits.orbit_shape import sample
from squealpipe.brake.orbits.orbits import Orbit
from squealpipe.brake.schema.backbones import Form, harmonic_forms_schema
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build

Vector = NDArray[np.float64]
Branches = Mapping[str, tuple[float, float, int]]
"""Name → (alpha1, alpha2, mode)."""

FORM_HARMONICS = 8


@dataclass(frozen=True)
class ExactMotion:
    """An exact orbit with its cosine coefficients, scaled."""

    scene: ScaledSystem
    orbit: Orbit
    x: Vector
    y: Vector


def exact_motion(
    params: Parameters, alpha1: float, alpha2: float, mode: int, peak: float
) -> ExactMotion:
    """The exact orbit of a mode at y_peak = peak·l_pre."""
    scene = scaled_system(params, alpha1, alpha2)
    orbit, outcome = find_orbit(scene, mode, peak)
    if orbit is None:
        raise ValueError(
            f"alpha1 = {alpha1!r}, alpha2 = {alpha2!r}, mode = {mode!r}, peak = {peak!r}: no "
            f"orbit ({outcome.name}); choose another scene, mode or peak"
        )
    # intervals of half a period from which an exact orbit's cosines are taken
    states = sample(
        scene.system.rows, orbit.point, np.linspace(0.0, math.pi, (2**14) + 1)
    )
    return ExactMotion(scene, orbit, cosines_of(states[:, 0]), cosines_of(states[:, 1]))


def compare_harmonic_forms(params: Parameters, branches: Branches) -> xr.Dataset:
    """The paper's balance, corrected and with Eq. (34) as printed, started at the exact orbit.

    Returns:
        Per branch and form what was found; per N the rank of Γ and the spread over the phase
        of the start on the last branch, for want of a phase condition.
    """
    forms = (Form.mended, Form.as_printed)
    sigma = params.sigma * params.preload
    # y_peak of the orbits, over l_pre
    motions = [exact_motion(params, *branch, 2.0) for branch in branches.values()]
    solved = []
    for motion in motions:
        system, omega = motion.scene.system, motion.orbit.omega
        balances = [
            SampledBalance(
                system, FORM_HARMONICS, 34, sigma, as_printed=form == Form.as_printed
            )
            for form in forms
        ]
        solved.append(
            [b.solve(b.start_from_cosines(motion.x, motion.y, omega)) for b in balances]
        )
    unit = np.array([motion.scene.frequency for motion in motions])
    counts = [2 * FORM_HARMONICS + extra for extra in (0, 1, 2)] + [
        4 * FORM_HARMONICS + 2
    ]
    counts += [16 * FORM_HARMONICS, 64 * FORM_HARMONICS]
    spreads = [_phase_spread(motions[-1], n, sigma) for n in counts]
    return build(
        harmonic_forms_schema,
        {
            "omega": np.array([[s.omega for s in row] for row in solved])
            * unit[:, None],
            "omega_exact": np.array([motion.orbit.omega for motion in motions]) * unit,
            "rank_deficit": [[s.rank_deficit for s in row] for row in solved],
            "outcome": [
                [
                    Outcome.converged if s.converged else Outcome.no_convergence
                    for s in row
                ]
                for row in solved
            ],
            "n_harmonics": FORM_HARMONICS,
            "fourier_columns": 2 * FORM_HARMONICS + 1,
            "fourier_rank": [rank for _, _, rank in spreads],
            "phase_spread_y": np.array([y for y, _, _ in spreads]) * params.preload,
            "phase_spread_omega": np.array([omega for _, omega, _ in spreads])
            * unit[-1],
        },
        {"scene": list(branches), "form": list(forms), "samples": counts},
        {"spread_scene": list(branches)[-1]},
    )


def _phase_spread(
    motion: ExactMotion, n_time: int, sigma: float
) -> tuple[float, float, int]:
    """(spread of the largest y, spread of ω, rank of Γ) over the phase of the start."""
    balance = SampledBalance(motion.scene.system, FORM_HARMONICS, n_time, sigma)
    peaks, omegas = [], []
    # not a divisor of the samples, whose own symmetry would hide the spread
    phases = 13
    for phase in 2.0 * math.pi * np.arange(phases) / phases:
        start = balance.start_from_cosines(
            motion.x, motion.y, motion.orbit.omega, float(phase)
        )
        solution = balance.solve(start)
        if solution.converged:
            peaks.append(balance.peak(solution))
            omegas.append(solution.omega)
    rank = int(np.linalg.matrix_rank(balance.fourier))
    if not peaks:
        return math.nan, math.nan, rank
    return max(peaks) - min(peaks), max(omegas) - min(omegas), rank
