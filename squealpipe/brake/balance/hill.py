"""Stability of a periodic motion by Hill's method: a public method of harmonic balance.

The variational equation δü = −A(t) δu is expanded in harmonics of the motion; of the 4 (2 H + 1)
exponents found, the four with the smallest imaginary part are kept (von Groll and Ewins 2001).
It is as good as the coefficients of A(t), which jumps at each switch: from samples, as usual in
alternating frequency–time codes, a motion in a period-doubling window may look stable.
"""

import math

import numpy as np
import scipy.linalg

from squealpipe.brake.orbits.piecewise_linear import PiecewiseLinearSystem


def sampled_share_above(cosine: np.ndarray) -> np.ndarray:
    """Cosine means, 0 … 2 H, of the part of the period in which a cosine series lies above 1."""
    n_harmonics, n_time = len(cosine) - 1, 80
    theta = 2.0 * math.pi * np.arange(n_time) / n_time
    above = np.cos(np.outer(theta, np.arange(n_harmonics + 1))) @ cosine > 1.0
    return (
        np.asarray(above @ np.cos(np.outer(theta, np.arange(2 * n_harmonics + 1))))
        / n_time
    )


def hill_multipliers(
    system: PiecewiseLinearSystem, share: np.ndarray, omega: float
) -> np.ndarray:
    """The four Floquet multipliers of a symmetric motion."""
    below, above = np.array(system.below.matrix), np.array(system.above.matrix)
    coefficients = share[:, None, None] * (above - below)
    coefficients[0] += below
    n_harmonics = (len(share) - 1) // 2
    count = 2 * n_harmonics + 1
    stiffness = np.block(
        [[coefficients[abs(i - j)] for j in range(count)] for i in range(count)]
    )
    rates = np.repeat(np.arange(-n_harmonics, n_harmonics + 1) * omega, 2)
    # (s + i n ω)² δu + A δu = 0
    companion = np.block(
        [
            [np.zeros((2 * count, 2 * count)), np.eye(2 * count)],
            [np.diag(rates**2) - stiffness, np.diag(-2j * rates)],
        ]
    )
    exponents = scipy.linalg.eigvals(companion)
    # next to a period doubling eight exponents share |Im| = ω/2: take the growing ones first
    nearness = np.round(np.abs(exponents.imag) / omega, 6)
    kept = exponents[np.lexsort((-exponents.real, nearness))[:4]]
    return np.asarray(np.exp(kept * 2.0 * math.pi / omega))
