"""The failure atlas of frequencies and stability: hard scenes asked of ours and public methods."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import mpmath
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.benchmark.schema import Reliability, Role, failure_atlas_schema
from squealpipe.brake.a4.harmonic_branches import linear_series
from squealpipe.brake.a4.orbits import find_orbit, linear_orbit
from squealpipe.brake.a4.system import ScaledSystem, scaled_system
from squealpipe.brake.backbones.backbone import backbone
from squealpipe.brake.backbones.orbit import periodic_orbit
from squealpipe.brake.balance.harmonic_balance import CosineBalance, contact_of
from squealpipe.brake.balance.hill import hill_multipliers, sampled_share_above
from squealpipe.brake.balance.sampled_balance import SampledBalance
from squealpipe.brake.linear.maps import quasi_static_map
from squealpipe.brake.models import a3, a4
from squealpipe.brake.orbits.orbits import Orbit
from squealpipe.laws.springs import Stiffness, geometry, linear_stiffness
from squealpipe.paper.comparison.work_precision import (
    AS_PRINTED,
    CORRECTED,
    orbit_series,
)
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.systems.continuation import Continuation, ContinuationSettings

BASE_PARAMETERS = Parameters(
    k3=0.75, mu=0.3, belt_speed=100.0, length1=5.0, length2=5.0
)
"""Parameters at which the scenes are hard, whatever the study's are."""


@dataclass(frozen=True)
class MethodNames:
    """Names of the methods that are compared."""

    exact_orbit: str = "closed form, exact orbit"
    closed_form_balance: str = "closed-form balance"
    cold_newton: str = "cold Newton, sampled"
    arc_length: str = "arc length, unchecked"
    tanh_balance: str = "tanh balance, sampled"
    hill: str = "Hill's method, sampled"
    numeric: str = "numpy.linalg"


CASE_HARMONICS = 16
NOT_CONVERGED = "Newton did not converge"


class BranchCase(NamedTuple):
    """A point of a backbone at the baseline; ``n_time`` and ``sigma`` of the sampled balances."""

    name: str
    alpha1_over_pi: float
    alpha2_over_pi: float
    mode: int
    y_peak: float
    n_time: int = 16 * CASE_HARMONICS
    sigma: float | None = None
    warm: bool = False

    @property
    def angles(self) -> tuple[float, float]:
        """Both spring angles, rad."""
        return self.alpha1_over_pi * math.pi, self.alpha2_over_pi * math.pi


class Answer(NamedTuple):
    """Answer of a method: NaN where it gave none; its warning, empty where it gave none."""

    value: np.ndarray | float
    flag: str = ""


class HardScene(NamedTuple):
    """A scene: its truth, NaN where only a warning is right; whom to ask, by the method's name."""

    name: str
    truth: np.ndarray | float
    tolerance: float
    answers: Mapping[str, Callable[[], Answer]]


def verdict_of(
    answer: Answer, truth: np.ndarray | float, tolerance: float
) -> tuple[Reliability, float]:
    """Right within the tolerance, else flagged or silently wrong; the largest error."""
    error = float(np.max(np.abs(np.asarray(answer.value) - truth)))
    if error <= tolerance:
        return Reliability.right, error
    wrong = Reliability.flagged if answer.flag else Reliability.silently_wrong
    return wrong, error if math.isfinite(error) else math.inf


def judge_balances() -> xr.Dataset:
    """Dataset ``failure_atlas``: every method on every hard scene that it can be asked.

    Truths are exact orbits, closed forms, 128 harmonics or sixty digits.
    """
    cases = (
        BranchCase("σ too small (balance)", 0.3, 0.9, 1, 3.0, sigma=10.0),
        BranchCase("σ too large (balance)", 0.3, 0.9, 1, 3.0, n_time=40, sigma=1e6),
        BranchCase(
            "aliasing, N ≈ 2N_h",
            0.3,
            0.9,
            1,
            3.0,
            n_time=2 * CASE_HARMONICS + 2,
            warm=True,
        ),
        BranchCase("pole at ω_x/2", 0.97, 0.97, 1, 1.5),
        BranchCase("tongue end", 0.05, 0.85, 1, 3.0),
        BranchCase("tongue end, slow mode", 0.4, 0.55, 1, 3.0),
        BranchCase("cold start, wrong basin", 0.3, 0.8, 1, 3.0),
    )
    scenes = [
        _singular_static_state(),
        _flutter_onset(),
        *map(_branch, cases),
        _period_doubling(),
    ]
    # the columns of the chart; the first two methods are ours
    frequency_methods = (
        MethodNames.exact_orbit,
        MethodNames.closed_form_balance,
        MethodNames.cold_newton,
        MethodNames.arc_length,
        MethodNames.tanh_balance,
        CORRECTED,
        AS_PRINTED,
        MethodNames.hill,
        MethodNames.numeric,
    )
    shape = len(scenes), len(frequency_methods)
    verdict = np.zeros(shape)
    error = np.full(shape, np.nan)
    message = np.full(shape, "", "U64")
    for row, scene in enumerate(scenes):
        for name, ask in scene.answers.items():
            cell, answer = (row, frequency_methods.index(name)), ask()
            verdict[cell], error[cell] = verdict_of(
                answer, scene.truth, scene.tolerance
            )
            message[cell] = answer.flag[:64]
    return build(
        failure_atlas_schema,
        {
            "verdict": verdict,
            "error": error,
            "message": message,
            "tolerance": [scene.tolerance for scene in scenes],
            "role": [
                Role.ours if name in frequency_methods[:2] else Role.public
                for name in frequency_methods
            ],
        },
        {"scene": [scene.name for scene in scenes], "solver": frequency_methods},
    )


def _branch(case: BranchCase) -> HardScene:
    scene = scaled_system(BASE_PARAMETERS, *case.angles)
    exact, _ = find_orbit(scene, case.mode, case.y_peak)
    balance = CosineBalance(
        scene.system, contact_of(CASE_HARMONICS, case.n_time, case.sigma)
    )
    start = linear_series(
        scene,
        case.mode,
        CASE_HARMONICS,
        linear_orbit(scene, case.mode, case.y_peak).point,
    )
    if exact and (case.warm or case.sigma):  # the form is on trial, not the start
        start = orbit_series(scene, exact, CASE_HARMONICS)
    truth: np.ndarray | float = math.nan
    if exact:
        # ω is then good to 1e-9, ten thousand times better than the tolerance of the verdict
        truth_harmonics = 128
        fine = CosineBalance(scene.system, contact_of(truth_harmonics, None, None))
        truth = _newton(
            scene, case, fine, orbit_series(scene, exact, truth_harmonics)
        ).value
    answers: dict[str, Callable[[], Answer]] = {
        MethodNames.exact_orbit: lambda: _exact_orbit(case),
        MethodNames.closed_form_balance: lambda: _our_balance(case),
        CORRECTED: lambda: _paper(scene, case, start, exact, as_printed=False),
        AS_PRINTED: lambda: _paper(scene, case, start, exact, as_printed=True),
        MethodNames.cold_newton
        if case.sigma is None
        else MethodNames.tanh_balance: lambda: _newton(scene, case, balance, start),
    }
    if case.sigma is None:
        answers[MethodNames.arc_length] = lambda: _arc_length(scene, case, balance)
    # largest error of ω that counts as right, in √(k1/m)
    return HardScene(case.name, truth, 1e-5, answers)


def _exact_orbit(case: BranchCase) -> Answer:
    orbit = periodic_orbit(
        BASE_PARAMETERS, *case.angles, mode=case.mode, y_peak=case.y_peak
    )
    return Answer(float(orbit.omega), _flag(orbit.outcome))


def _our_balance(case: BranchCase) -> Answer:
    branch = _series(case.angles, case.mode, case.y_peak)
    flag = _flag(branch.end)
    if flag or not branch.sizes["point"]:
        return Answer(math.nan, flag)
    away = float(branch.waveform_error[-1])
    # a balance point farther from the exact orbit, over l_pre, warns
    flag = (
        ""
        if away < 0.01 * BASE_PARAMETERS.preload
        else f"{away:.2g} away from the exact orbit"
    )
    return Answer(float(branch.omega[-1]), flag)


def _series(angles: tuple[float, float], mode: int, y_peak: float) -> xr.Dataset:
    return backbone(
        BASE_PARAMETERS,
        *angles,
        mode=mode,
        y_peak_max=y_peak,
        method="hbm",
        n_harmonics=CASE_HARMONICS,
    )


def _newton(
    scene: ScaledSystem,
    case: BranchCase,
    balance: CosineBalance,
    start: NDArray[np.float64],
) -> Answer:
    with np.errstate(all="ignore"):
        solution = balance.solve(start, balance.peak_row, case.y_peak)
    if solution is None:
        return Answer(math.nan, NOT_CONVERGED)
    return Answer(abs(float(solution[0][-1])) * scene.frequency)


def _paper(
    scene: ScaledSystem,
    case: BranchCase,
    z: NDArray[np.float64],
    exact: Orbit | None,
    *,
    as_printed: bool,
) -> Answer:
    """Newton on Eqs. (31)–(36), which prescribe neither peak nor phase.

    What is found is therefore compared with the exact orbit of its own peak, where there is one.
    """
    # the paper's σ, where the case has none of its own
    balance = SampledBalance(
        scene.system,
        CASE_HARMONICS,
        case.n_time,
        case.sigma or 1e3,
        as_printed=as_printed,
    )
    start = balance.start_from_cosines(
        z[: CASE_HARMONICS + 1], z[CASE_HARMONICS + 1 : -1], float(z[-1])
    )
    with np.errstate(all="ignore"):
        solution = balance.solve(start, max_iterations=40)
    if not solution.converged:
        return Answer(math.nan, NOT_CONVERGED)
    omega, peak = abs(solution.omega), balance.peak(solution)
    own = find_orbit(scene, case.mode, peak)[0] if peak > 1.0 else None
    if exact and own:
        omega += exact.omega - own.omega
    return Answer(omega * scene.frequency)


def _arc_length(
    scene: ScaledSystem, case: BranchCase, balance: CosineBalance
) -> Answer:
    """Arc-length continuation from the linear mode until the peak is met, nothing else checked."""
    orbit = linear_orbit(scene, case.mode, 1.0 - 1e-3)
    start = linear_series(scene, case.mode, CASE_HARMONICS, orbit.point)
    direction = np.zeros_like(start)
    direction[1], direction[CASE_HARMONICS + 2] = scene.slope(case.mode), 1.0
    settings = ContinuationSettings(max_points=400)

    def reached(state: Any) -> bool:
        return bool(balance.peak_row @ state.point >= case.y_peak)

    with np.errstate(all="ignore"):
        states = Continuation(balance, start, direction, settings).run(reached)
    if not (states and reached(states[-1])):
        lost = len(states) < settings.max_points
        return Answer(math.nan, "branch_lost" if lost else "point_limit")
    return _newton(scene, case, balance, states[-1].point)


def _flag(outcome: Any) -> str:
    outcome = Outcome(int(outcome))
    return (
        ""
        if outcome
        in (Outcome.converged, Outcome.amplitude_reached, Outcome.linear_mode)
        else f"{outcome.name}: {outcome.remedy}"
    )


def _period_doubling() -> HardScene:
    """Is the motion stable? Inside the window its multipliers are real and negative."""
    angles, mode, y_peak = (0.3 * math.pi, 0.9 * math.pi), 1, 4.0
    scene = scaled_system(BASE_PARAMETERS, *angles)
    exact, _ = find_orbit(scene, mode, y_peak)
    hill_harmonics = 16
    balance = CosineBalance(scene.system, contact_of(hill_harmonics, None, None))

    def ours() -> Answer:
        orbit = periodic_orbit(BASE_PARAMETERS, *angles, mode=mode, y_peak=y_peak)
        return Answer(float(abs(float(orbit.stability_index)) > 2.0))

    def series() -> Answer:
        branch = _series(angles, mode, y_peak)
        return Answer(
            float(abs(float(branch.stability_index[-1])) > 2.0), _flag(branch.end)
        )

    def hill() -> Answer:
        guess = orbit_series(scene, exact, hill_harmonics) if exact else None
        solution = (
            None if guess is None else balance.solve(guess, balance.peak_row, y_peak)
        )
        if solution is None:
            return Answer(math.nan, NOT_CONVERGED)
        _, y, omega = balance.split(solution[0])
        share = sampled_share_above(y)
        multipliers = hill_multipliers(scene.system, share, omega)
        return Answer(float(np.abs(multipliers).max() > 1.0 + 1e-3))

    truth = float(abs(exact.stability_index) > 2.0) if exact else math.nan
    return HardScene(
        "period-doubling window",
        truth,
        0.5,
        {
            MethodNames.exact_orbit: ours,
            MethodNames.closed_form_balance: series,
            MethodNames.hill: hill,
        },
    )


def _singular_static_state() -> HardScene:
    """x of the static state at α1 = α2 = π/2, where K11 = 0 and there is none."""
    angle = np.array([0.5 * math.pi])

    def ours() -> Answer:
        static_state = quasi_static_map(BASE_PARAMETERS, angle, angle).squeeze()
        return Answer(float(static_state.x_static), _flag(static_state.outcome))

    def numeric() -> Answer:
        stiffness = linear_stiffness(BASE_PARAMETERS, geometry(angle[0], angle[0]))
        a11, a12, a21, a22 = a4.contact_matrix(
            stiffness, BASE_PARAMETERS.k3, BASE_PARAMETERS.mu
        )
        load = (
            BASE_PARAMETERS.k3
            * BASE_PARAMETERS.preload
            * np.array([BASE_PARAMETERS.mu, 1.0])
        )
        try:
            return Answer(float(np.linalg.solve([[a11, a12], [a21, a22]], load)[0]))
        except np.linalg.LinAlgError as error:
            return Answer(math.nan, str(error))

    return HardScene(
        "singular static state",
        math.nan,
        1.0,
        {MethodNames.exact_orbit: ours, MethodNames.numeric: numeric},
    )


def _flutter_onset() -> HardScene:
    """Both ω at a distance of 2⁻⁴⁰ from onset, where the eigenvalues have almost merged.

    The structure of Hoffmann et al. (2002), K11 = K22 + k3, with numbers that binary holds
    exactly and onset at μ = 1.
    """
    # just below the onset of flutter, by a number that doubles hold exactly
    stiffness, mu = Stiffness(2.0, -1.0, 1.0), 1.0 - (2.0**-40)
    a11, a12, a21, a22 = a4.contact_matrix(stiffness, 1.0, mu)
    with mpmath.workdps(60):
        half, mean = (mpmath.mpf(a11) - a22) / 2, (mpmath.mpf(a11) + a22) / 2
        root = mpmath.sqrt(half * half + mpmath.mpf(a12) * a21)
        truth = np.array([float(mpmath.sqrt(mean + sign * root)) for sign in (-1, 1)])

    def ours() -> Answer:
        invariants = a4.spectrum(stiffness, 1.0, k3=1.0, mu=mu, mass=1.0)
        return Answer(np.sort([abs(s) for s in a3.eigenvalues(invariants)]))

    def numeric() -> Answer:
        matrix = [[0, 0, 1, 0], [0, 0, 0, 1], [-a11, -a12, 0, 0], [-a21, -a22, 0, 0]]
        return Answer(np.sort(np.abs(np.linalg.eigvals(matrix)))[::2])

    return HardScene(
        "flutter onset",
        truth,
        1e-12,
        {MethodNames.exact_orbit: ours, MethodNames.numeric: numeric},
    )
