"""A4: linear springs with contact loss, sliding friction only (paper, section 7).

Drops from A1 the exact spring geometry and the reversal of friction. Valid while displacements
are small against the spring lengths and ẋ < V. Piecewise linear and, being autonomous and
undamped with forces that depend on position alone, time-reversible.
"""

from typing import Any, NamedTuple

import numpy as np

from squealpipe.laws.contact import contact_force
from squealpipe.laws.friction import dragging_force
from squealpipe.laws.springs import (
    Geometry,
    Stiffness,
    linear_elastic_force,
    linear_stiffness,
)


def acceleration(
    x: Any, y: Any, p: Any, g: Geometry, *, contact: Any
) -> tuple[Any, Any]:
    """Eqs. (18), (19): (ẍ, ÿ), m/s²; Eqs. (20), (21) in contact, (23), (24) separated."""
    fx, fy = linear_elastic_force(x, y, linear_stiffness(p, g))
    normal = contact * contact_force(y, p)
    friction = dragging_force(normal, p)
    inverse_mass = p.mass**-1.0
    return inverse_mass * (fx + friction), inverse_mass * (fy + normal)


def contact_matrix(stiffness: Stiffness, k3: Any, mu: Any) -> tuple[Any, Any, Any, Any]:
    """Stiffness (a11, a12, a21, a22) of Eqs. (20), (21), N/m; not symmetric: friction follows y."""
    return stiffness.k11, stiffness.k12 + mu * k3, stiffness.k12, stiffness.k22 + k3


class StiffnessSpectrum(NamedTuple):
    """Trace/2, determinant and discriminant (trace/2)² − determinant of stiffness/mass."""

    half_trace: Any
    determinant: Any
    discriminant: Any


def spectrum(
    stiffness: Stiffness, spring_determinant: Any, *, k3: Any, mu: Any, mass: Any
) -> StiffnessSpectrum:
    """Invariants of the matrix whose eigenvalues are ω²: in contact, or separated with k3 = 0.

    Both are formed without avoidable cancellation: the determinant as
    det K + k3 (K11 − μK12), the discriminant as ¼(K11 − K22 − k3)² + K12 (K12 + μk3), so that
    neither goes through the difference of the two eigenvalues. Numbers of any precision will do.

    Args:
        spring_determinant: det K, from :func:`squealpipe.laws.springs.stiffness_determinant`.
    """
    a11, a12, a21, a22 = contact_matrix(stiffness, k3, mu)
    half_difference = 0.5 * (a11 - a22)
    return StiffnessSpectrum(
        0.5 * (a11 + a22) / mass,
        (spring_determinant + k3 * (stiffness.k11 - mu * stiffness.k12))
        / (mass * mass),
        (half_difference * half_difference + a12 * a21) / (mass * mass),
    )


def natural_frequencies_squared(invariants: StiffnessSpectrum) -> tuple[Any, Any]:
    """Eqs. (22a), (22b) in contact, (25a), (25b) separated: (ω1², ω2²), complex, (rad/s)².

    ω2² is a sum of terms of one sign and ω1² follows from the product, so a small ω1 keeps its
    digits. The pair is complex conjugate in flutter; ω1² is negative in divergence.
    """
    root = np.sqrt(np.asarray(invariants.discriminant, dtype=complex))
    larger = invariants.half_trace + root
    return invariants.determinant / larger, larger


def first_integral_value(
    x: Any, y: Any, vx: Any, vy: Any, p: Any, stiffness: Stiffness
) -> Any:
    """H = ½ m v'S v + ½ u'S K u + ½ g N²/k3, N J/m, conserved by A4 in both states.

    Identically zero if K12 = 0 and K11 = K22.
    """
    k11, k12, k22 = stiffness
    mu = p.drag
    s11, s12, s22 = k12, -mu * k12, k12 + mu * (k11 - k22)
    g = k12 * (1.0 - mu * mu) + mu * (k11 - k22)
    sk11, sk12 = s11 * k11 + s12 * k12, s11 * k12 + s12 * k22
    sk21, sk22 = s12 * k11 + s22 * k12, s12 * k12 + s22 * k22
    kinetic = 0.5 * p.mass * (s11 * vx * vx + 2.0 * s12 * vx * vy + s22 * vy * vy)
    elastic = 0.5 * (sk11 * x * x + (sk12 + sk21) * x * y + sk22 * y * y)
    return kinetic + elastic + 0.5 * g * p.k3 * np.maximum(p.preload - y, 0.0) ** 2
