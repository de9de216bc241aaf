"""Piecewise-linear systems of two degrees of freedom with one switching line y = threshold."""

import cmath
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Matrix = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class LinearState:
    """ü = −A u + b.

    Attributes:
        matrix: A, 1/s².
        load: b, m/s².
        discriminant: (tr A/2)² − det A, 1/s⁴, formed without cancellation by the caller or here.
    """

    matrix: Matrix
    load: tuple[float, float]

    @property
    def half_trace(self) -> float:
        """Mean of the eigenvalues, 1/s²."""
        return 0.5 * (self.matrix[0][0] + self.matrix[1][1])

    @property
    def discriminant(self) -> float:
        """Square of half the eigenvalues' difference, 1/s⁴; negative for a complex pair."""
        half = 0.5 * (self.matrix[0][0] - self.matrix[1][1])
        return half * half + self.matrix[0][1] * self.matrix[1][0]

    @property
    def eigenvalues(self) -> tuple[complex, complex]:
        """ω1² and ω2², 1/s², ascending real part."""
        half = cmath.sqrt(self.discriminant)
        return self.half_trace - half, self.half_trace + half

    @property
    def equilibrium(self) -> NDArray[np.float64]:
        """Rest position A⁻¹ b, m.

        Raises:
            ValueError: A is singular.
        """
        (a11, a12), (a21, a22) = self.matrix
        determinant = a11 * a22 - a12 * a21
        if determinant == 0.0:
            raise ValueError("matrix is singular: this state has no rest position")
        bx, by = self.load
        return np.array([a22 * bx - a12 * by, a11 * by - a21 * bx]) / determinant

    def row(self, threshold: float) -> list[float]:
        """State row of :mod:`squealpipe.methods.orbits.modal_flow`."""
        (a11, a12), (a21, a22) = self.matrix
        omega1, omega2 = map(cmath.sqrt, self.eigenvalues)
        return [
            self.half_trace,
            0.5 * (a11 - a22),
            a12,
            a21,
            self.discriminant,
            omega1.real,
            omega1.imag,
            omega2.real,
            omega2.imag,
            *self.load,
            threshold,
        ]


@dataclass(frozen=True)
class PiecewiseLinearSystem:
    """Two linear states, ``below`` for y < threshold and ``above`` for y > threshold.

    The field must be continuous on the switching line; it then needs no saltation matrix.
    """

    below: LinearState
    above: LinearState
    threshold: float

    @cached_property
    def rows(self) -> NDArray[np.float64]:
        """(2, 12) state rows for the compiled kernels."""
        return np.array([self.below.row(self.threshold), self.above.row(self.threshold)])

    @property
    def decoupled(self) -> bool:
        """Whether y moves independently of x in both states."""
        return self.below.matrix[1][0] == 0.0 and self.above.matrix[1][0] == 0.0
