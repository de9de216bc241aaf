"""The failure atlas of frequencies and stability: hard scenes asked of ours and public methods."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.methods.balance.harmonic_balance import CosineBalance, contact_of
from squealpipe.methods.balance.hill import hill_multipliers, sampled_share_above
from squealpipe.methods.balance.sampled_balance import SampledBalance
from squealpipe.methods.continuation import Continuation, ContinuationSettings
from squealpipe.models import a3, a4
from squealpipe.parameters import Parameters
from squealpipe.schema import REMEDIES, Outcome
from squealpipe.schema.comparison import Role
from squealpipe.solvers.a4.harmonic_branches import linear_series
from squealpipe.solvers.a4.orbits import find_orbit, linear_orbit
from squealpipe.solvers.a4.system import ScaledSystem, scaled_system
from squealpipe.tasks.backbones.backbone import backbone
from squealpipe.tasks.backbones.orbit import periodic_orbit
from squealpipe.tasks.comparison.failures.verdicts import (
    BASE,
    Answer,
    HardScene,
    Method,
    failure_atlas,
)
from squealpipe.tasks.comparison.work_precision.harmonic import orbit_series
from squealpipe.tasks.comparison.work_precision.stability import OnsetCase
from squealpipe.tasks.linear.maps import quasi_static_map

EXACT, BALANCE = "closed form, exact orbit", "closed-form balance"
COLD, ARC, TANH = "cold Newton, sampled", "arc length, unchecked", "tanh balance, sampled"
PAPER, PRINTED = "paper's balance", "paper's, Eq. (34) as printed"
HILL, NUMERIC = "Hill's method, sampled", "numpy.linalg"
FREQUENCY_METHODS = (
    Method(EXACT, Role.ours),
    Method(BALANCE, Role.ours),
    Method(COLD),
    Method(ARC),
    Method(TANH),
    Method(PAPER),
    Method(PRINTED),
    Method(HILL),
    Method(NUMERIC),
)
TOLERANCE = 1e-5
"""Largest error of ω that counts as right, in √(k1/m)."""
N_HARMONICS = 16
PAPER_SIGMA = 1e3
TRUTH_HARMONICS = 128
"""Their ω is good to 1e-9, ten thousand times better than the tolerance."""
HILL_HARMONICS, HILL_SAMPLES = 16, 80
FARTHEST = 0.01
"""A balance point whose own distance from the exact orbit is larger, over l_pre, warns."""
_REACHED = (Outcome.converged, Outcome.amplitude_reached, Outcome.linear_mode)
_MOST_POINTS = 400
_ONSET = 2.0**-40


@dataclass(frozen=True)
class BranchCase:
    """A point of a backbone at the baseline; ``n_time`` and ``sigma`` of the sampled balances."""

    name: str
    alpha1_over_pi: float
    alpha2_over_pi: float
    mode: int
    y_peak: float
    n_time: int = 16 * N_HARMONICS
    sigma: float | None = None
    warm: bool = False

    @property
    def angles(self) -> tuple[float, float]:
        """In rad."""
        return self.alpha1_over_pi * math.pi, self.alpha2_over_pi * math.pi


CASES = (
    BranchCase("σ too small (balance)", 0.3, 0.9, 1, 3.0, sigma=10.0),
    BranchCase("σ too large (balance)", 0.3, 0.9, 1, 3.0, n_time=40, sigma=1e6),
    BranchCase("aliasing, N ≈ 2N_h", 0.3, 0.9, 1, 3.0, n_time=2 * N_HARMONICS + 2, warm=True),
    BranchCase("pole at ω_x/2", 0.97, 0.97, 1, 1.5),
    BranchCase("tongue end", 0.05, 0.85, 1, 3.0),
    BranchCase("tongue end, slow mode", 0.4, 0.55, 1, 3.0),
    BranchCase("cold start, wrong basin", 0.3, 0.8, 1, 3.0),
)


def judge_balances() -> xr.Dataset:
    """Dataset ``failure_atlas``; the scenes set their own parameters."""
    return failure_atlas(scenes(), FREQUENCY_METHODS)


def scenes() -> list[HardScene]:
    """All scenes with their truth: exact orbits, closed forms or sixty digits."""
    return [_singular_static_state(), _flutter_onset(), *map(_branch, CASES), _period_doubling()]


def _branch(case: BranchCase) -> HardScene:
    params = BASE
    scene = scaled_system(params, *case.angles)
    answers: dict[str, Callable[[], Answer]] = {
        EXACT: lambda: _exact_orbit(params, case),
        BALANCE: lambda: _our_balance(params, case),
    }
    answers[PAPER] = lambda: _paper(scene, case, as_printed=False)
    answers[PRINTED] = lambda: _paper(scene, case, as_printed=True)
    if case.sigma is not None:
        answers[TANH] = lambda: _newton(scene, case)
    else:
        answers[COLD] = lambda: _newton(scene, case)
        answers[ARC] = lambda: _arc_length(scene, case)
    return HardScene(case.name, _true_frequency(scene, case), TOLERANCE, answers)


def _true_frequency(scene: ScaledSystem, case: BranchCase) -> float:
    """ω by a balance of very many harmonics, started at the exact orbit; NaN without a motion."""
    exact, _ = find_orbit(scene, case.mode, case.y_peak)
    if exact is None:
        return math.nan
    balance = CosineBalance(scene.system, contact_of(TRUTH_HARMONICS, 1.0, None, None))
    guess = orbit_series(scene, exact, TRUTH_HARMONICS)
    found = balance.solve(guess, balance.peak_row, case.y_peak)
    return math.nan if found is None else float(found[0][-1]) * scene.frequency


def _exact_orbit(params: Parameters, case: BranchCase) -> Answer:
    found = periodic_orbit(params, *case.angles, mode=case.mode, y_peak=case.y_peak)
    return Answer(float(found.omega), _flag(Outcome(int(found.outcome))))


def _our_balance(params: Parameters, case: BranchCase) -> Answer:
    branch = backbone(
        params, *case.angles, mode=case.mode, y_peak_max=case.y_peak, method="hbm",
        n_harmonics=N_HARMONICS,
    )  # fmt: skip
    flag = _flag(Outcome(int(branch.end)))
    reached = bool(branch.sizes["point"]) and not flag
    if reached and not float(branch.waveform_error[-1]) < FARTHEST * params.preload:
        flag = f"{float(branch.waveform_error[-1]):.2g} away from the exact orbit"
    return Answer(float(branch.omega[-1]) if reached else math.nan, flag)


def _sampled_balance(scene: ScaledSystem, case: BranchCase) -> CosineBalance:
    return CosineBalance(scene.system, contact_of(N_HARMONICS, 1.0, case.n_time, case.sigma))


def _newton(scene: ScaledSystem, case: BranchCase) -> Answer:
    """Newton on a sampled balance, from the linear mode of that peak (or a good start)."""
    balance = _sampled_balance(scene, case)
    with np.errstate(all="ignore"):
        found = balance.solve(_start(scene, case), balance.peak_row, case.y_peak)
    if found is None:
        return Answer(math.nan, "Newton did not converge")
    return Answer(abs(float(found[0][-1])) * scene.frequency)


def _start(scene: ScaledSystem, case: BranchCase) -> NDArray[np.float64]:
    """Cosines to start from: the exact orbit where the form is on trial, else the linear mode."""
    exact, _ = find_orbit(scene, case.mode, case.y_peak)
    if exact is not None and (case.warm or case.sigma is not None):
        return orbit_series(scene, exact, N_HARMONICS)
    linear = linear_orbit(scene, case.mode, case.y_peak)
    return linear_series(scene, case.mode, N_HARMONICS, linear.point)


def _paper(scene: ScaledSystem, case: BranchCase, *, as_printed: bool) -> Answer:
    """Newton on Eqs. (31)–(36), whose peak and phase nobody prescribes.

    What is found is therefore compared with the exact orbit of its own peak, where there is one.
    """
    balance = SampledBalance(
        scene.system, N_HARMONICS, case.n_time, case.sigma or PAPER_SIGMA, as_printed=as_printed
    )
    exact, _ = find_orbit(scene, case.mode, case.y_peak)
    z = _start(scene, case)
    count = N_HARMONICS + 1
    with np.errstate(all="ignore"):
        found = balance.solve(
            balance.start_from_cosines(z[:count], z[count:-1], float(z[-1])), max_iterations=40
        )
    if not found.converged:
        return Answer(math.nan, "Newton did not converge")
    omega, peak = abs(found.omega), balance.peak(found)
    own = find_orbit(scene, case.mode, peak)[0] if peak > 1.0 else None
    if exact is None or own is None:
        return Answer(omega * scene.frequency)
    return Answer((omega - own.omega + exact.omega) * scene.frequency)


def _arc_length(scene: ScaledSystem, case: BranchCase) -> Answer:
    """Arc-length continuation from the linear mode until the peak is met, nothing else checked."""
    balance = _sampled_balance(scene, case)
    orbit = linear_orbit(scene, case.mode, 1.0 - 1e-3)
    start = linear_series(scene, case.mode, N_HARMONICS, orbit.point)
    direction = np.zeros_like(start)
    direction[1], direction[N_HARMONICS + 2] = scene.slope(case.mode), 1.0
    settings = ContinuationSettings(max_points=_MOST_POINTS)
    with np.errstate(all="ignore"):
        result = Continuation(balance, start, direction, settings, lambda state: state).run(
            lambda state: bool(balance.peak_row @ state.point >= case.y_peak)
        )
        reached = result.states and balance.peak_row @ result.states[-1].point >= case.y_peak
        if not reached:
            return Answer(math.nan, result.end.name)
        found = balance.solve(result.states[-1].point, balance.peak_row, case.y_peak)
    if found is None:
        return Answer(math.nan, "Newton did not converge")
    return Answer(abs(float(found[0][-1])) * scene.frequency)


def _flag(outcome: Outcome) -> str:
    return "" if outcome in _REACHED else f"{outcome.name}: {REMEDIES[outcome]}"


def _period_doubling() -> HardScene:
    """Is the motion stable? Inside the window its multipliers are real and negative."""
    params, angles, mode, y_peak = BASE, (0.3 * math.pi, 0.9 * math.pi), 1, 4.0
    scene = scaled_system(params, *angles)
    exact, _ = find_orbit(scene, mode, y_peak)
    balance = CosineBalance(scene.system, contact_of(HILL_HARMONICS, 1.0, None, None))

    def ours() -> Answer:
        found = periodic_orbit(params, *angles, mode=mode, y_peak=y_peak)
        return Answer(float(abs(float(found.stability_index)) > 2.0))

    def series() -> Answer:
        branch = backbone(
            params, *angles, mode=mode, y_peak_max=y_peak, method="hbm", n_harmonics=N_HARMONICS
        )
        flag = _flag(Outcome(int(branch.end)))
        return Answer(float(abs(float(branch.stability_index[-1])) > 2.0), flag)

    def hill() -> Answer:
        if exact is None:
            return Answer(math.nan, "no orbit")
        guess = orbit_series(scene, exact, HILL_HARMONICS)
        found = balance.solve(guess, balance.peak_row, y_peak)
        if found is None:
            return Answer(math.nan, "Newton did not converge")
        _, y, omega = balance.split(found[0])
        share = sampled_share_above(y, 1.0, HILL_SAMPLES)
        multipliers = hill_multipliers(scene.system, share, omega)
        return Answer(float(np.abs(multipliers).max() > 1.0 + 1e-3))

    truth = math.nan if exact is None else float(abs(exact.stability_index) > 2.0)
    return HardScene(
        "period-doubling window", truth, 0.5, {EXACT: ours, BALANCE: series, HILL: hill}
    )


def _singular_static_state() -> HardScene:
    """x of the static state at α1 = α2 = π/2, where K11 = 0 and there is none."""
    params, angle = BASE, np.array([0.5 * math.pi])

    def ours() -> Answer:
        found = quasi_static_map(params, angle, angle)
        return Answer(float(found.x_static.squeeze()), _flag(Outcome(int(found.outcome.squeeze()))))

    def numeric() -> Answer:
        g = geometry(angle[0], angle[0])
        a11, a12, a21, a22 = a4.contact_matrix(linear_stiffness(params, g), params.k3, params.mu)
        load = params.k3 * params.preload * np.array([params.mu, 1.0])
        try:
            return Answer(float(np.linalg.solve([[a11, a12], [a21, a22]], load)[0]))
        except np.linalg.LinAlgError as error:
            return Answer(math.nan, str(error))

    return HardScene("singular static state", math.nan, 1.0, {EXACT: ours, NUMERIC: numeric})


def _flutter_onset() -> HardScene:
    """Both ω at a distance of 2⁻⁴⁰ from onset, where the eigenvalues have almost merged."""
    case, mu = OnsetCase(), 1.0 - _ONSET

    def ours() -> Answer:
        invariants = a4.spectrum(case.stiffness, case.determinant, k3=case.k3, mu=mu, mass=1.0)
        return Answer(np.sort([abs(s) for s in a3.eigenvalues(invariants)]))

    def numeric() -> Answer:
        first_order = np.block(
            [[np.zeros((2, 2)), np.eye(2)], [-case.matrix(mu), np.zeros((2, 2))]]
        )
        return Answer(np.sort(np.abs(np.linalg.eigvals(first_order)))[::2])

    truth = np.sort(np.abs(case.reference(mu)))
    return HardScene("flutter onset", truth, 1e-12, {EXACT: ours, NUMERIC: numeric})
