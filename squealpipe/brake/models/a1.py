"""A1: exact spring geometry, contact loss, Coulomb friction with stick (paper, section 4).

Drops nothing of the model. Its regimes are

========== ======= ========= =====================================================
regime     contact direction holds while
========== ======= ========= =====================================================
slip −     1       +1        ẋ < V, y < l_pre
slip +     1       −1        ẋ > V, y < l_pre
stick      1       0         ẋ = V, |suspension's fx| ≤ μs N, y < l_pre
separated  0       any       y > l_pre
========== ======= ========= =====================================================

The variants leave one thing out each: ``A1-no-stick`` (friction reverses at once at ẋ = V),
``A1-no-separation`` (the contact spring also pulls), ``A1-linear-springs`` (K r replaces the
exact geometry). ``A1-as-printed`` is Eq. (4) taken literally: friction μ N sgn(ẋ − V) pushes a
slower mass back and a faster one on, and nothing sticks (see :mod:`squealpipe.reading`).
"""

from typing import Any, NamedTuple

from squealpipe.laws import springs
from squealpipe.laws.contact import normal_force
from squealpipe.laws.dashpots import damping_force, linear_damping_force
from squealpipe.laws.friction import slip_force
from squealpipe.laws.friction_laws import coefficient


class State(NamedTuple):
    """Displacement, m, and velocity, m/s, of the mass."""

    x: Any
    y: Any
    vx: Any
    vy: Any


class Suspension(NamedTuple):
    """Form in which the springs are described.

    Attributes:
        linear: K r in place of the exact geometry.
        long: which of the springs take the form for long ones.
        dashpots: whether they have dashpots.
    """

    linear: bool = False
    long: tuple[bool, bool] = (False, False)
    dashpots: bool = True


exact_suspension = Suspension()


def suspension_force(
    s: Any, p: Any, g: springs.Geometry, form: Suspension = exact_suspension
) -> tuple[Any, Any]:
    """Force of both springs and their dashpots, if any, on the mass in a state ``s``, N."""
    if form.linear:
        fx, fy = springs.linear_elastic_force(s.x, s.y, springs.linear_stiffness(p, g))
    else:
        fx, fy = springs.elastic_force(s.x, s.y, p, g, form.long)
    if not form.dashpots:
        return fx, fy
    if form.linear:
        cx, cy = linear_damping_force(s.vx, s.vy, p, g)
    else:
        cx, cy = damping_force(s.x, s.y, s.vx, s.vy, p, g)
    return fx + cx, fy + cy


def acceleration(
    s: Any,
    p: Any,
    g: springs.Geometry,
    *,
    contact: Any,
    direction: Any,
    stick: Any = 0.0,
    form: Suspension = exact_suspension,
) -> tuple[Any, Any]:
    """Eqs. (4), (5): (ẍ, ÿ) within one regime, m/s².

    Args:
        s: the state, with attributes x, y, vx and vy like :class:`State`.
        contact: 1 in contact, 0 separated.
        direction: sgn(V − ẋ).
        stick: 1 while sticking, when friction balances the other x-forces and ẍ = 0.
    """
    fx, fy = suspension_force(s, p, g, form)
    normal = contact * normal_force(s.y, s.vy, p)
    friction = slip_force(
        normal, direction, coefficient(direction * (p.belt_speed - s.vx), p)
    )
    inverse_mass = p.mass**-1.0
    ax = (1.0 - stick) * inverse_mass * (fx + friction)
    return ax, inverse_mass * (fy + normal)
