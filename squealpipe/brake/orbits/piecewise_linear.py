"""Piecewise-linear systems of two degrees of freedom with one switching line y = threshold."""

import cmath
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.orbits.modal_flow import state_row_type

Matrix = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class LinearState:
    """ü = −A u + b.

    Attributes:
        matrix: A, 1/s².
        load: b, m/s².
    """

    matrix: Matrix
    load: tuple[float, float]

    @property
    def equilibrium(self) -> NDArray[np.float64]:
        """Rest position A⁻¹ b, m."""
        (a11, a12), (a21, a22) = self.matrix
        bx, by = self.load
        return np.array([a22 * bx - a12 * by, a11 * by - a21 * bx]) / (
            a11 * a22 - a12 * a21
        )

    def row(self, threshold: float) -> np.void:
        """Return the state row of :mod:`squealpipe.brake.orbits.modal_flow`."""
        (a11, a12), (a21, a22) = self.matrix
        mean, half = 0.5 * (a11 + a22), 0.5 * (a11 - a22)
        discriminant = half * half + a12 * a21  # negative for a complex pair
        root = cmath.sqrt(discriminant)
        omega1, omega2 = cmath.sqrt(mean - root), cmath.sqrt(mean + root)
        frequencies = (omega1.real, omega1.imag, omega2.real, omega2.imag)
        numbers = (
            mean,
            half,
            a12,
            a21,
            discriminant,
            *frequencies,
            *self.load,
            threshold,
        )
        row: np.void = np.array([numbers], state_row_type)[0]
        return row


@dataclass(frozen=True)
class PiecewiseLinearSystem:
    """Two linear states, ``below`` for y < threshold and ``above`` for y > threshold.

    The field must be continuous on the switching line; it then needs no saltation matrix.
    """

    below: LinearState
    above: LinearState
    threshold: float

    @cached_property
    def rows(self) -> NDArray[np.void]:
        """Both states for the compiled kernels, (2,) records of ``state_row_type``."""
        return np.array(
            [self.below.row(self.threshold), self.above.row(self.threshold)],
            state_row_type,
        )

    @property
    def push(self) -> tuple[float, float]:
        """Acceleration by a unit of the gap, threshold − y, below."""
        below, above = self.below.matrix, self.above.matrix
        return below[0][1] - above[0][1], below[1][1] - above[1][1]

    @property
    def decoupled(self) -> bool:
        """True if y moves independently of x in both states."""
        return self.below.matrix[1][0] == 0.0 and self.above.matrix[1][0] == 0.0
