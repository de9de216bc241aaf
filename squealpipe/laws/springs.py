"""The two inclined springs: exact geometry, and its linearization at x = y = 0."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

Scalar = Any
"""A float, array, SymPy symbol or heyoka expression."""


class Geometry(NamedTuple):
    """Direction cosines c_i = cos α_i, s_i = sin α_i."""

    c1: Scalar
    s1: Scalar
    c2: Scalar
    s2: Scalar


class Stiffness(NamedTuple):
    """The linearized spring stiffness matrix [[K11, K12], [K12, K22]], N/m."""

    k11: Scalar
    k12: Scalar
    k22: Scalar


LONG_SPRING = 1e3
"""Springs longer than so many l_pre take :func:`long_spring_force`, whose round-off does not grow
with the length; below, that of :func:`spring_force` is less than a tolerance of 1e-12."""


def geometry(alpha1: Any, alpha2: Any) -> Geometry:
    """Direction cosines of angles in rad (floats or arrays, broadcast against each other)."""
    return Geometry(np.cos(alpha1), np.sin(alpha1), np.cos(alpha2), np.sin(alpha2))


def fixed_ends(p: Any, g: Geometry) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Eqs. (1a), (1b): fixed ends (x_f1, y_f1, x_f2, y_f2) of the springs, m."""
    return p.length1 * g.c1, p.length1 * g.s1, -(p.length2 * g.c2), p.length2 * g.s2


def squared_distance(x: Scalar, y: Scalar, x_fixed: Scalar, y_fixed: Scalar) -> Scalar:
    """Eq. (2): |r − r_f|², m²."""
    return (x - x_fixed) * (x - x_fixed) + (y - y_fixed) * (y - y_fixed)


def spring_force(
    k: Scalar, length: Scalar, x: Scalar, y: Scalar, x_fixed: Scalar, y_fixed: Scalar
) -> tuple[Scalar, Scalar]:
    """Eq. (3): force −k (d − L)(r − r_f)/d of one spring on the mass, N; singular at d = 0."""
    d2 = squared_distance(x, y, x_fixed, y_fixed)
    stretch = k * (1.0 - length * d2**-0.5)
    return -(stretch * (x - x_fixed)), -(stretch * (y - y_fixed))


def long_spring_force(
    k: Scalar, length: Scalar, x: Scalar, y: Scalar, x_fixed: Scalar, y_fixed: Scalar
) -> tuple[Scalar, Scalar]:
    """Return the spring force from q = d² − L² expanded in r, so that d − L = q/(d + L) does not
    cancel.

    Exact to round-off far from the fixed end, next to which d² = L² + q cancels instead.
    """
    q = x * (x - 2.0 * x_fixed) + y * (y - 2.0 * y_fixed)
    d2 = length * length + q
    stretch = k * q * (d2 + length * d2**0.5) ** -1.0
    return -(stretch * (x - x_fixed)), -(stretch * (y - y_fixed))


def elastic_force(
    x: Scalar, y: Scalar, p: Any, g: Geometry, long: tuple[bool, bool] = (False, False)
) -> tuple[Scalar, Scalar]:
    """Spring terms of Eqs. (4) and (5): total force of both springs on the mass, N.

    ``long`` says which of the springs take :func:`long_spring_force`.
    """
    x1, y1, x2, y2 = fixed_ends(p, g)
    first, second = (long_spring_force if each else spring_force for each in long)
    f1x, f1y = first(p.k1, p.length1, x, y, x1, y1)
    f2x, f2y = second(p.k2, p.length2, x, y, x2, y2)
    return f1x + f2x, f1y + f2y


def linear_stiffness(p: Any, g: Geometry) -> Stiffness:
    """Eqs. (8a)–(8c): K11, K12, K22, N/m."""
    return inclined_pair(p.k1, p.k2, g)


def inclined_pair(first: Scalar, second: Scalar, g: Geometry) -> Stiffness:
    """Σ q_i e_i e_i' of two elements along the springs, with q_i their stiffness or damping."""
    return Stiffness(
        first * g.c1 * g.c1 + second * g.c2 * g.c2,
        first * g.c1 * g.s1 - second * g.c2 * g.s2,
        first * g.s1 * g.s1 + second * g.s2 * g.s2,
    )


def sine_of_sum(alpha1: Any, alpha2: Any) -> Any:
    """sin(α1 + α2) to full relative precision (floats and arrays), also next to nπ.

    The rounding error of the sum is recovered (Knuth's two-sum) and carried to first order.
    """
    total = alpha1 + alpha2
    part = total - alpha1
    lost = (alpha1 - (total - part)) + (alpha2 - part)
    return np.sin(total) + lost * np.cos(total)


def pair_determinant(first: Scalar, second: Scalar, sine: Scalar) -> Scalar:
    """The determinant of :func:`inclined_pair` as q1 q2 sin²(α1 + α2), which does not cancel."""
    return first * second * sine * sine


def stiffness_determinant(p: Any, g: Geometry) -> Scalar:
    """K11 K22 − K12² from direction cosines, N²/m²."""
    return pair_determinant(p.k1, p.k2, g.s1 * g.c2 + g.c1 * g.s2)


def linear_elastic_force(
    x: Scalar, y: Scalar, stiffness: Stiffness
) -> tuple[Scalar, Scalar]:
    """Spring terms of Eqs. (18) and (19): −K r, N."""
    return (
        -(stiffness.k11 * x + stiffness.k12 * y),
        -(stiffness.k12 * x + stiffness.k22 * y),
    )


def springs_alike(fields: Mapping[str, np.ndarray | float]) -> np.ndarray:
    """Return where (α1, α2) and (π − α2, π − α1) are the same system."""
    pairs = [
        np.equal(fields.get(f"{name}1", 0.0), fields.get(f"{name}2", 0.0))
        for name in ("k", "length", "damping")
    ]
    return np.asarray(pairs[0] & pairs[1] & pairs[2])


def springs_are_equal(fields: Mapping[str, np.ndarray | float]) -> bool:
    """Tell whether (α1, α2) and (π − α2, π − α1) are the same system at every parameter set."""
    return bool(springs_alike(fields).all())
