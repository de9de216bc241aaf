"""A1: exact spring geometry, contact loss, Coulomb friction with stick (paper, section 4).

Drops nothing of the model. Its regimes are

========== ======= ========= =====================================================
regime     contact direction holds while
========== ======= ========= =====================================================
slip −     1       +1        ẋ < V, y < l_pre
slip +     1       −1        ẋ > V, y < l_pre
stick      1       0         ẋ = V, |elastic x-force| ≤ μN, y < l_pre
separated  0       any       y > l_pre
========== ======= ========= =====================================================

The variants leave one thing out each: ``A1-no-stick`` (friction reverses at once at ẋ = V),
``A1-no-separation`` (the contact spring also pulls), ``A1-linear-springs`` (K r replaces the
exact geometry). ``A1-as-printed`` is Eq. (4) taken literally: friction μ N sgn(ẋ − V) pushes a
slower mass back and a faster one on, and nothing sticks (see :mod:`squealpipe.reading`).
"""

from typing import Any

from squealpipe.laws import springs
from squealpipe.laws.contact import normal_force
from squealpipe.laws.dashpots import damping_force, linear_damping_force
from squealpipe.laws.friction import slip_force
from squealpipe.laws.friction_laws import coefficient


def suspension_force(
    x: Any,
    y: Any,
    vx: Any,
    vy: Any,
    p: Any,
    g: springs.Geometry,
    *,
    linear_springs: bool,
    long_springs: tuple[bool, bool] = (False, False),
    dashpots: bool = True,
) -> tuple[Any, Any]:
    """Force of both springs and their dashpots, if any, on the mass, exact or linearized, N."""
    if linear_springs:
        fx, fy = springs.linear_elastic_force(x, y, springs.linear_stiffness(p, g))
    else:
        fx, fy = springs.elastic_force(x, y, p, g, long_springs)
    if not dashpots:
        return fx, fy
    if linear_springs:
        cx, cy = linear_damping_force(vx, vy, p, g)
    else:
        cx, cy = damping_force(x, y, vx, vy, p, g)
    return fx + cx, fy + cy


def acceleration(
    x: Any,
    y: Any,
    vx: Any,
    vy: Any,
    p: Any,
    g: springs.Geometry,
    *,
    contact: Any,
    direction: Any,
    stick: Any = 0.0,
    linear_springs: bool = False,
    long_springs: tuple[bool, bool] = (False, False),
    dashpots: bool = True,
) -> tuple[Any, Any]:
    """Eqs. (4), (5): (ẍ, ÿ) within one regime, m/s².

    Args:
        x, y: displacement, m; vx, vy: velocity, m/s.
        contact: 1 in contact, 0 separated.
        direction: sgn(V − ẋ).
        stick: 1 while sticking, when friction balances the other x-forces and ẍ = 0.
        long_springs: which of the springs take the form for long ones.
    """
    fx, fy = suspension_force(
        x,
        y,
        vx,
        vy,
        p,
        g,
        linear_springs=linear_springs,
        long_springs=long_springs,
        dashpots=dashpots,
    )
    normal = contact * normal_force(y, vy, p)
    friction = slip_force(
        normal, direction, coefficient(direction * (p.belt_speed - vx), p)
    )
    inverse_mass = p.mass**-1.0
    ax = (1.0 - stick) * inverse_mass * (fx + friction)
    return ax, inverse_mass * (fy + normal)
