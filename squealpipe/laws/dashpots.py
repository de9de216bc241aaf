"""Viscous dashpots parallel to the two springs (not in the paper): they act separated too.

The contact has none: with one, N would vanish before y = l_pre.
"""

from __future__ import annotations

from typing import Any

from squealpipe.laws.springs import (
    Geometry,
    Scalar,
    Stiffness,
    fixed_ends,
    inclined_pair,
    squared_distance,
)


def dashpot_force(
    c: Scalar, x: Scalar, y: Scalar, vx: Scalar, vy: Scalar, x_fixed: Scalar, y_fixed: Scalar
) -> tuple[Scalar, Scalar]:
    """−c ḋ (r − r_f)/d with ḋ = (r − r_f)·ṙ/d, N: force of one dashpot; singular at d = 0."""
    rx, ry = x - x_fixed, y - y_fixed
    inverse = squared_distance(x, y, x_fixed, y_fixed) ** -0.5
    force = c * ((rx * vx + ry * vy) * inverse) * inverse
    return -(force * rx), -(force * ry)


def damping_force(
    x: Scalar, y: Scalar, vx: Scalar, vy: Scalar, p: Any, g: Geometry
) -> tuple[Scalar, Scalar]:
    """Total force of both dashpots on the mass, N."""
    x1, y1, x2, y2 = fixed_ends(p, g)
    f1x, f1y = dashpot_force(p.damping1, x, y, vx, vy, x1, y1)
    f2x, f2y = dashpot_force(p.damping2, x, y, vx, vy, x2, y2)
    return f1x + f2x, f1y + f2y


def damping_x_slopes(
    x: Scalar, y: Scalar, vx: Scalar, vy: Scalar, p: Any, g: Geometry
) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Derivatives by x, y, ẋ and ẏ of the x-force of :func:`damping_force`, N/m and N s/m."""
    x1, y1, x2, y2 = fixed_ends(p, g)
    a1, b1, c1, d1 = dashpot_x_slopes(p.damping1, x - x1, y - y1, vx, vy)
    a2, b2, c2, d2 = dashpot_x_slopes(p.damping2, x - x2, y - y2, vx, vy)
    return a1 + a2, b1 + b2, c1 + c2, d1 + d2


def dashpot_x_slopes(
    c: Scalar, rx: Scalar, ry: Scalar, vx: Scalar, vy: Scalar
) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Derivatives of the x-force of one dashpot, r − r_f away from its fixed end."""
    inverse2 = (rx * rx + ry * ry) ** -1.0
    rate, share = c * inverse2, 2.0 * rx * inverse2
    moving = rx * vx + ry * vy
    return (
        -(rate * (vx * rx + moving - moving * rx * share)),
        -(rate * (vy * rx - moving * ry * share)),
        -(rate * rx * rx),
        -(rate * rx * ry),
    )


def linear_damping(p: Any, g: Geometry) -> Stiffness:
    """C11, C12, C22, N s/m: the stiffness matrix with c_i for k_i."""
    return inclined_pair(p.damping1, p.damping2, g)


def linear_damping_force(vx: Scalar, vy: Scalar, p: Any, g: Geometry) -> tuple[Scalar, Scalar]:
    """−C ṙ, N."""
    c11, c12, c22 = linear_damping(p, g)
    return -(c11 * vx + c12 * vy), -(c12 * vx + c22 * vy)
