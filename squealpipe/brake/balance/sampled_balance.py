"""Harmonic balance as the paper writes it: sines and cosines, tanh, no phase condition.

Kept to compare with :mod:`squealpipe.brake.balance.harmonic_balance`. What it gets wrong: the
system is autonomous, so the Jacobian of Eq. (36) has one column more than rows and, as any shift in
time solves the equations too, it loses rank at a solution; Newton's method with the
pseudo-inverse lands somewhere on a two-parameter family. Samples of a kinked force alias.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.orbits.piecewise_linear import PiecewiseLinearSystem
from squealpipe.laws.contact import smoothed_compression, smoothed_compression_slope

Vector = NDArray[np.float64]


def fourier_matrix(n_harmonics: int, n_time: int) -> Vector:
    """Eqs. (28a), (28b), (29): Γ, with x = Γa and y = Γb, (N, 2 N_h + 1).

    Its columns are 1, sin θ, cos θ, … at θ_j = 2π j/N.
    """
    theta = 2.0 * math.pi * np.arange(n_time) / n_time
    columns = [np.ones(n_time)]
    for order in range(1, n_harmonics + 1):
        columns += [np.sin(order * theta), np.cos(order * theta)]
    return np.column_stack(columns)


def derivative_matrix(n_harmonics: int) -> Vector:
    """Eq. (30): D, d/dθ of the coefficients, (2 N_h + 1, 2 N_h + 1)."""
    matrix = np.zeros((2 * n_harmonics + 1, 2 * n_harmonics + 1))
    for order in range(1, n_harmonics + 1):
        matrix[2 * order - 1, 2 * order] = -order
        matrix[2 * order, 2 * order - 1] = order
    return matrix


@dataclass(frozen=True)
class SampledSolution:
    """Result of Newton's method for Eq. (35).

    Attributes:
        x, y: Fourier coefficients (2 N_h + 1,), constant first, then sine, cosine pairs.
        rank_deficit: unknowns minus the numerical rank of the Jacobian there.
    """

    x: Vector
    y: Vector
    omega: float
    residual: float
    rank_deficit: int
    converged: bool


@dataclass(frozen=True)
class SampledBalance:
    """Residuals and rectangular Jacobian over η = (a, b, ω).

    Attributes:
        n_harmonics, n_time: N_h and N; at least 2 N_h, as the paper allows.
        sigma: regularizing factor of tanh, scaled.
        as_printed: Eq. (34) as printed, with K11 a + K12 b; otherwise K12 a + K22 b.
    """

    system: PiecewiseLinearSystem
    n_harmonics: int
    n_time: int
    sigma: float
    as_printed: bool = False

    @cached_property
    def fourier(self) -> Vector:
        """Γ."""
        return fourier_matrix(self.n_harmonics, self.n_time)

    @cached_property
    def _projection(self) -> Vector:
        """Γ⁺; the pseudo-inverse also exists where N = 2 N_h makes ΓᵀΓ singular."""
        return np.asarray(np.linalg.pinv(self.fourier), dtype=np.float64)

    @cached_property
    def _curvature(self) -> Vector:
        derivative = derivative_matrix(self.n_harmonics)
        return derivative @ derivative

    @cached_property
    def _stiffness(self) -> tuple[tuple[float, float], tuple[float, float]]:
        first, second = self.system.above.matrix
        return first, (first if self.as_printed else second)

    def evaluate(self, eta: Vector) -> tuple[Vector, Vector]:
        """Eqs. (31)–(34): R, (4 N_h + 2,), and Eq. (36): J, (4 N_h + 2, 4 N_h + 3)."""
        count = 2 * self.n_harmonics + 1
        a, b, omega = eta[:count], eta[count:-1], eta[-1]
        push_x, push_y = self.system.push
        distance = self.system.threshold - self.fourier @ b
        gap = self._projection @ smoothed_compression(distance, self.sigma)
        slope = smoothed_compression_slope(distance, self.sigma)
        gap_by_b = -(self._projection * slope) @ self.fourier
        (k11, k12), (k21, k22) = self._stiffness
        one, inertia = np.eye(count), omega**2 * self._curvature
        by_omega = 2.0 * omega * self._curvature @ np.stack([a, b], axis=1)
        values = (
            inertia @ a + k11 * a + k12 * b - push_x * gap,
            inertia @ b + k21 * a + k22 * b - push_y * gap,
        )
        jacobian = [
            [inertia + k11 * one, k12 * one - push_x * gap_by_b, by_omega[:, :1]],
            [k21 * one, inertia + k22 * one - push_y * gap_by_b, by_omega[:, 1:]],
        ]
        return np.concatenate(values), np.block(jacobian)

    def solve(
        self, start: Vector, *, tolerance: float = 1e-10, max_iterations: int = 60
    ) -> SampledSolution:
        """Eq. (35) with the pseudo-inverse of the rectangular Jacobian, from η = start."""
        eta = start.copy()
        values, jacobian = self.evaluate(eta)
        for _ in range(max_iterations):
            if not np.abs(values).max() > tolerance or not np.isfinite(eta).all():
                break
            eta = eta - np.linalg.lstsq(jacobian, values, rcond=1e-10)[0]
            values, jacobian = self.evaluate(eta)
        count = 2 * self.n_harmonics + 1
        residual = float(np.abs(values).max())
        finite = bool(np.isfinite(jacobian).all())
        rank = int(np.linalg.matrix_rank(jacobian, tol=1e-6)) if finite else 0
        return SampledSolution(
            x=eta[:count],
            y=eta[count:-1],
            omega=float(eta[-1]),
            residual=residual,
            rank_deficit=len(eta) - rank,
            converged=residual <= tolerance,
        )

    def start_from_cosines(
        self, x: Vector, y: Vector, omega: float, phase: float = 0.0
    ) -> Vector:
        """η of a motion given by cosines, shifted by a phase, rad."""
        eta = np.zeros(4 * self.n_harmonics + 3)
        count = 2 * self.n_harmonics + 1
        orders = np.arange(1, self.n_harmonics + 1)
        for offset, cosines in ((0, x), (count, y)):
            kept = np.pad(cosines, (0, self.n_harmonics))[: self.n_harmonics + 1]
            eta[offset] = kept[0]
            eta[offset + 1 : offset + count : 2] = -kept[1:] * np.sin(orders * phase)
            eta[offset + 2 : offset + count : 2] = kept[1:] * np.cos(orders * phase)
        eta[-1] = omega
        return eta

    def peak(self, solution: SampledSolution) -> float:
        """Largest y of the series over a period, from 4,096 samples."""
        return float((fourier_matrix(self.n_harmonics, 4096) @ solution.y).max())
