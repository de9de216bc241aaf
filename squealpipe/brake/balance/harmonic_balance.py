"""Harmonic balance of a reversible piecewise-linear system in cosines.

Symmetric motions of a reversible system are even about an instant of rest, so cosines alone
carry them: half of the unknowns, and no phase to be fixed. For n = 0 … N_h the unknowns are the
coefficients of x and y, and ω; the system is autonomous, so there is one unknown more than
equations and the solutions form a branch.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.balance.contact_series import ClosedFormContact, SampledContact
from squealpipe.brake.orbits.piecewise_linear import PiecewiseLinearSystem
from squealpipe.systems.continuation import ContinuationSettings, PseudoArclength
from squealpipe.vibration.parabola import largest

Vector = NDArray[np.float64]


def contact_of(
    n_harmonics: int, n_time: int | None, sigma: float | None
) -> ClosedFormContact | SampledContact:
    """Contact integrals for the given samples and smoothing; scaled, contact ends at y = 1.

    Without ``n_time`` the sharp law is integrated in closed form, and a smoothed one with
    enough samples to resolve it.
    """
    if n_time is None and sigma is None:
        return ClosedFormContact(n_harmonics, 1.0)
    if n_time is None and sigma is not None:
        # sixteen samples for each harmonic
        # eight over the width of the smoothed contact
        wanted = max(16 * n_harmonics, 8 * sigma, 256)
        n_time = 2 ** math.ceil(math.log2(min(wanted, 2**14)))
    return SampledContact(n_harmonics, 1.0, int(n_time or 0), sigma)


@dataclass(frozen=True)
class CosineBalance:
    """The equations; unknowns z = (x_0 … x_Nh, y_0 … y_Nh, ω).

    Attributes:
        system: ``below`` the threshold differs from ``above`` by a force along its column
            that grows with the gap.
    """

    system: PiecewiseLinearSystem
    contact: ClosedFormContact | SampledContact

    @cached_property
    def _order_squared(self) -> Vector:
        return np.arange(self.contact.n_harmonics + 1, dtype=float) ** 2

    def evaluate(self, z: Vector) -> tuple[Vector, Vector]:
        """Residuals (2 N_h + 2,) and Jacobian (2 N_h + 2, 2 N_h + 3)."""
        count = self.contact.n_harmonics + 1
        x, y, omega = z[:count], z[count:-1], z[-1]
        (a11, a12), (a21, a22) = self.system.above.matrix
        push_x, push_y = self.system.push
        inertia = omega * omega * self._order_squared
        gap, gap_by_y = self.contact.gap(y)

        values = np.empty(2 * count)
        values[:count] = (a11 - inertia) * x + a12 * y - push_x * gap
        values[count:] = a21 * x + (a22 - inertia) * y - push_y * gap
        values[0] -= self.system.above.load[0]
        values[count] -= self.system.above.load[1]

        jacobian = np.zeros((2 * count, 2 * count + 1))
        diagonal = np.arange(count)
        jacobian[:count, count:-1] = -push_x * gap_by_y
        jacobian[count:, count:-1] = -push_y * gap_by_y
        jacobian[diagonal, diagonal] = a11 - inertia
        jacobian[diagonal, count + diagonal] += a12
        jacobian[count + diagonal, diagonal] = a21
        jacobian[count + diagonal, count + diagonal] += a22 - inertia
        jacobian[:count, -1] = -2.0 * omega * self._order_squared * x
        jacobian[count:, -1] = -2.0 * omega * self._order_squared * y
        return values, jacobian

    def split(self, z: Vector) -> tuple[Vector, Vector, float]:
        """(cosines of x, cosines of y, ω)."""
        count = self.contact.n_harmonics + 1
        return z[:count], z[count:-1], float(z[-1])

    @cached_property
    def peak_row(self) -> Vector:
        """The linear form z → y(0)."""
        count = self.contact.n_harmonics + 1
        return np.concatenate([np.zeros(count), np.ones(count), [0.0]])

    @cached_property
    def shift_signs(self) -> Vector:
        """Signs that describe a motion from its other instant of rest, θ → θ + π."""
        alternating = (-1.0) ** np.arange(self.contact.n_harmonics + 1)
        return np.concatenate([alternating, alternating, [1.0]])

    def solve(
        self, guess: Vector, row: Vector, value: float
    ) -> tuple[Vector, float] | None:
        """Solution with row · z = value from a guess, and its residual; None without one."""
        start = guess + row * ((value - row @ guess) / (row @ row))
        settings = ContinuationSettings(
            max_iterations=25, easy_iterations=1, tolerance=2e-13
        )
        solution = PseudoArclength(settings).correct(
            self, start, row / np.linalg.norm(row)
        )
        return None if solution is None else (solution[0], solution[3])


def cosines_of(samples: Vector) -> Vector:
    """Cosine coefficients of an even function from samples at θ = π j/n, j = 0 … n."""
    count = len(samples) - 1
    spectrum = np.fft.rfft(np.concatenate([samples, samples[-2:0:-1]]), axis=0).real / (
        2 * count
    )
    spectrum[1:-1] *= 2.0
    return np.asarray(spectrum)


def series_extremes(cosine: Vector) -> Vector:
    """Half of the peak-to-peak of each cosine series (n, N_h + 1)."""
    table = np.cos(np.outer(_shape_grid(cosine.shape[1]), np.arange(cosine.shape[1])))
    waves = cosine @ table.T
    return np.asarray(0.5 * (largest(waves) + largest(-waves)))


def series_speed(cosine: Vector) -> Vector:
    """Largest |d/dθ| of each cosine series (n, N_h + 1)."""
    order = np.arange(cosine.shape[1])
    table = np.sin(np.outer(_shape_grid(cosine.shape[1]), order)) * order
    return np.asarray(largest(np.abs(cosine @ table.T)))


def _shape_grid(count: int) -> Vector:
    return np.linspace(0.0, math.pi, 16 * count + 1)
