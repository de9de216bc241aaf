"""Viscous dashpots parallel to the two springs (not in the paper): they act separated too.

The contact has none: with one, N would vanish before y = l_pre.
"""

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
    c: Scalar,
    x: Scalar,
    y: Scalar,
    vx: Scalar,
    vy: Scalar,
    x_fixed: Scalar,
    y_fixed: Scalar,
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


def linear_damping(p: Any, g: Geometry) -> Stiffness:
    """C11, C12, C22, N s/m: the stiffness matrix with c_i for k_i."""
    return inclined_pair(p.damping1, p.damping2, g)


def linear_damping_force(
    vx: Scalar, vy: Scalar, p: Any, g: Geometry
) -> tuple[Scalar, Scalar]:
    """−C ṙ, N."""
    c11, c12, c22 = linear_damping(p, g)
    return -(c11 * vx + c12 * vy), -(c12 * vx + c22 * vy)
