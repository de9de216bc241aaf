"""Work–precision of harmonic balance on A4, judged by exact orbits of equal peak."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray

from squealpipe.methods.balance.harmonic_balance import CosineBalance, contact_of, cosines_of
from squealpipe.methods.balance.sampled_balance import SampledBalance, SampledSolution
from squealpipe.methods.orbits.orbit_shape import sample
from squealpipe.methods.orbits.orbits import Orbit, solve_orbit
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from squealpipe.schema.comparison import Role
from squealpipe.solvers.a4.orbits import find_orbit
from squealpipe.solvers.a4.system import ScaledSystem, scaled_system
from squealpipe.tasks.comparison.work_precision.solutions import Solution, timed

TASK = "harmonic balance"
REFERENCE_ERROR = 1e-14
DEFAULT_HARMONICS = 16
"""N_h of our backbones unless given otherwise."""
MODE = 1
COUPLED_SCENE = (0.3 * math.pi, 0.9 * math.pi)
"""Angles at which mode 1 moves in x and y and loses contact, rad."""
PEAKS = (1.25, 1.75, 2.25, 2.75, 3.5)
"""y_peak over l_pre; none close to the period doubling at 3.9."""
PAPER_SIGMA = 1e3
PAPER_HARMONICS = 16
"""Most harmonics of the paper's form here: its pseudo-inverse costs the cube of their number."""
_GUESS_SAMPLES = 512
_STEP = 0.02
"""The start of a solution is the orbit at a peak lower by this, as along a backbone."""


@dataclass(frozen=True)
class Discretization:
    """One form of the balance: harmonics, samples and smoothing; None is our closed form."""

    method: str
    n_harmonics: int
    n_time: int | None
    sigma: float | None
    role: Role

    @property
    def setting(self) -> str:
        """N_h, N and σ as text."""
        parts = [f"N_h {self.n_harmonics}"]
        if self.n_time is not None:
            parts.append(f"N {self.n_time}")
        if self.sigma is not None:
            parts.append(f"sigma {self.sigma:g}")
        return ", ".join(parts)


@dataclass(frozen=True)
class _CountedBalance(CosineBalance):
    """A balance that counts how often its equations are evaluated."""

    calls: list[int] = field(default_factory=list)

    def evaluate(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        self.calls.append(1)
        return super().evaluate(z)


@dataclass(frozen=True)
class _CountedPaper(SampledBalance):
    """The paper's balance, counting likewise."""

    calls: list[int] = field(default_factory=list)

    def evaluate(self, eta: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        self.calls.append(1)
        return super().evaluate(eta)


def discretizations(
    harmonics: Sequence[int], sigmas: Sequence[float], oversampling: Sequence[int]
) -> Iterator[Discretization]:
    """Closed forms over N_h, sampled forces over N_h and N, smoothed forces over σ."""
    for count in sorted({*harmonics, DEFAULT_HARMONICS}):
        role = Role.our_setting if count == DEFAULT_HARMONICS else Role.ours
        yield Discretization("cosines, closed-form contact", count, None, None, role)
        for factor in oversampling:
            samples = 2 * count + 2 if factor == 1 else 2 * count * factor
            name = f"cosines, {'2 N_h + 2' if factor == 1 else f'{2 * factor} N_h'} samples"
            yield Discretization(name, count, samples, None, Role.ours)
    most = max(harmonics)
    for sigma in sigmas:
        samples = int(2 ** math.ceil(math.log2(max(16 * most, 8 * min(sigma, 1000.0)))))
        yield Discretization("cosines, tanh", most, samples, sigma, Role.ours)


def solutions(
    params: Parameters,
    *,
    harmonics: Sequence[int],
    sigmas: Sequence[float],
    oversampling: Sequence[int],
    repeats: int,
) -> Iterator[Solution]:
    """All forms of the balance at the peaks of the coupled scene: medians over the peaks.

    Args:
        params: physical parameters.
        harmonics: N_h.
        sigmas: regularizing factors, times l_pre.
        oversampling: N over 2 N_h; 1 is the fewest samples that keep the columns independent.
        repeats: runs of which the median time is taken.
    """
    scene = scaled_system(params, *COUPLED_SCENE)
    exact = [find_orbit(scene, MODE, peak)[0] for peak in PEAKS]
    before = [find_orbit(scene, MODE, peak - _STEP)[0] for peak in PEAKS]
    pairs = [(orbit, start) for orbit, start in zip(exact, before, strict=True) if orbit and start]
    for form in discretizations(harmonics, sigmas, oversampling):
        yield _judged(scene, form, pairs, repeats)
    yield _shooting(scene, pairs, repeats)
    for count in harmonics:
        if count <= PAPER_HARMONICS:
            yield _paper(scene, count, pairs, repeats, as_printed=False)
            yield _paper(scene, count, pairs, repeats, as_printed=True)


def _judged(
    scene: ScaledSystem,
    form: Discretization,
    pairs: Sequence[tuple[Orbit, Orbit]],
    repeats: int,
) -> Solution:
    contact = contact_of(form.n_harmonics, 1.0, form.n_time, form.sigma)
    balance, counted = CosineBalance(scene.system, contact), _CountedBalance(scene.system, contact)
    errors, seconds = [], []
    for orbit, start in pairs:
        guess = orbit_series(scene, start, form.n_harmonics)
        found, time = timed(
            lambda guess=guess, orbit=orbit: balance.solve(  # type: ignore[misc]
                guess, balance.peak_row, float(orbit.point[1])
            ),
            repeats,
        )
        counted.solve(guess, counted.peak_row, float(orbit.point[1]))
        seconds.append(time)
        errors.append(math.nan if found is None else abs(found[0][-1] / orbit.omega - 1.0))
    failed = not errors or bool(np.isnan(errors).any())
    return Solution(
        task=TASK,
        scene="coupled",
        method=form.method,
        setting=form.setting,
        role=form.role,
        error=float(np.median(errors)) if errors else math.nan,
        wall_time=float(np.median(seconds)) if seconds else 0.0,
        evaluations=len(counted.calls) / max(len(pairs), 1),
        reference_error=REFERENCE_ERROR,
        outcome=Outcome.no_convergence if failed else Outcome.converged,
    )


def _paper(
    scene: ScaledSystem,
    n_harmonics: int,
    pairs: Sequence[tuple[Orbit, Orbit]],
    repeats: int,
    *,
    as_printed: bool,
) -> Solution:
    """The paper's balance; its peak is not prescribed: ω is judged by its own exact orbit."""
    n_time = 4 * n_harmonics + 2
    balance = _CountedPaper(scene.system, n_harmonics, n_time, PAPER_SIGMA, as_printed=as_printed)
    count = n_harmonics + 1
    errors, seconds, calls = [], [], 0

    def solve(eta: NDArray[np.float64]) -> SampledSolution:
        balance.calls.clear()
        return balance.solve(eta, max_iterations=25)

    for _, start in pairs:
        z = orbit_series(scene, start, n_harmonics)
        eta = balance.start_from_cosines(z[:count], z[count:-1], float(z[-1]))
        found, time = timed(partial(solve, eta), repeats)
        seconds.append(time)
        calls += len(balance.calls)
        own, _ = find_orbit(scene, MODE, max(balance.peak(found), 1.0 + 1e-6))
        failed = not found.converged or own is None
        errors.append(math.nan if failed or own is None else abs(found.omega / own.omega - 1.0))
    failed = not errors or bool(np.isnan(errors).any())
    return Solution(
        task=TASK,
        scene="coupled",
        method="paper, Eq. (34) as printed" if as_printed else "paper's form, Eq. (34) corrected",
        setting=f"N_h {n_harmonics}, N {n_time}, sigma {PAPER_SIGMA:g}",
        role=Role.public,
        error=float(np.nanmedian(errors)) if not np.isnan(errors).all() else math.nan,
        wall_time=float(np.median(seconds)) if seconds else 0.0,
        evaluations=calls / max(len(pairs), 1),
        reference_error=REFERENCE_ERROR,
        outcome=Outcome.no_convergence if failed else Outcome.converged,
    )


def _shooting(scene: ScaledSystem, pairs: Sequence[tuple[Orbit, Orbit]], repeats: int) -> Solution:
    """Exact orbits themselves: their error is the velocity that is left after half a period."""
    errors, seconds = [], []
    for orbit, start in pairs:
        guess = start.point.copy()
        guess[1] = orbit.point[1]
        found, time = timed(lambda guess=guess: solve_orbit(scene.system, guess), repeats)  # type: ignore[misc]
        errors.append(math.nan if found is None else found.residual)
        seconds.append(time)
    return Solution(
        task=TASK,
        scene="coupled",
        method="exact orbit (shooting)",
        setting="with monodromy",
        role=Role.our_setting,
        error=float(np.median(errors)) if errors else math.nan,
        wall_time=float(np.median(seconds)) if seconds else 0.0,
        evaluations=float(np.median([len(orbit.switches) + 1 for orbit, _ in pairs] or [0])),
        reference_error=REFERENCE_ERROR,
        outcome=Outcome.converged if pairs else Outcome.no_convergence,
    )


def orbit_series(scene: ScaledSystem, orbit: Orbit, n_harmonics: int) -> NDArray[np.float64]:
    """Unknowns of the cosine balance that describe an exact orbit."""
    theta = np.linspace(0.0, math.pi, _GUESS_SAMPLES + 1)
    cosines = cosines_of(sample(scene.system.rows, orbit.point, theta)[:, :2])
    kept = cosines[: n_harmonics + 1]
    return np.concatenate([kept[:, 0], kept[:, 1], [orbit.omega]])
