"""A3: the linearized model about its static sliding state: eigenvalue stability (section 6).

Drops from A1 the exact geometry, contact loss and the reversal of friction: the contact spring
pulls as well as pushes. Valid for small motion about a static state in contact with ẋ < V.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from squealpipe.laws.springs import Stiffness
from squealpipe.models.a4 import contact_matrix


class LinearRegime(IntEnum):
    """Stability regimes of A3, as stored in datasets."""

    stable = 0
    flutter = 1
    divergence = 2


class Spectrum(NamedTuple):
    """Invariants of the matrix A = K_contact/m whose eigenvalues are ω² = −s²."""

    half_trace: Any
    determinant: Any
    discriminant: Any


def spectrum(stiffness: Stiffness, k3: Any, mu: Any, mass: Any) -> Spectrum:
    """Trace/2, determinant and discriminant (trace/2)² − det of Eqs. (6), (7) per unit mass.

    The discriminant is formed without cancellation,
    ¼(K11 − K22 − K3)² + K12 (K12 + μ K3), so it is exact at flutter onset, where numeric
    eigenvalues of the defective matrix lose half their digits.
    """
    a11, a12, a21, a22 = contact_matrix(stiffness, k3, mu)
    half_trace = 0.5 * (a11 + a22) / mass
    determinant = (a11 * a22 - a12 * a21) / (mass * mass)
    half_difference = 0.5 * (a11 - a22)
    discriminant = (half_difference * half_difference + a12 * a21) / (mass * mass)
    return Spectrum(half_trace, determinant, discriminant)


def static_state(stiffness: Stiffness, k3: Any, mu: Any, preload: Any) -> tuple[Any, Any, Any]:
    """Eq. (15): the equilibrium (x*, y*), m, and its contact force N* = k3 (l_pre − y*), N.

    Infinite where the contact stiffness is singular. ``k3`` is K3 of Eq. (8d) or its sharp limit.
    """
    k11, k12, k22 = stiffness
    spring_determinant = k11 * k22 - k12 * k12
    contact_determinant = spring_determinant + k3 * (k11 - mu * k12)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = k3 * preload / contact_determinant
        return (
            scale * (mu * k22 - k12),
            scale * (k11 - mu * k12),
            scale * spring_determinant,
        )
