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
exact geometry).
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from squealpipe.laws.contact import contact_energy, contact_force
from squealpipe.laws.friction import slip_force
from squealpipe.laws.springs import (
    Geometry,
    elastic_energy,
    elastic_force,
    linear_elastic_force,
    linear_stiffness,
)


class Regime(IntEnum):
    """Regimes of A1, as stored in datasets."""

    slip_slower = 0
    slip_faster = 1
    stick = 2
    separated = 3


VARIANTS = ("A1", "A1-no-stick", "A1-no-separation", "A1-linear-springs")


def spring_force(x: Any, y: Any, p: Any, g: Geometry, *, linear_springs: bool) -> tuple[Any, Any]:
    """Force of both springs on the mass, exact or linearized, N."""
    if linear_springs:
        return linear_elastic_force(x, y, linear_stiffness(p, g))
    return elastic_force(x, y, p, g)


def acceleration(
    x: Any,
    y: Any,
    p: Any,
    g: Geometry,
    *,
    contact: Any,
    direction: Any,
    stick: Any = 0.0,
    linear_springs: bool = False,
) -> tuple[Any, Any]:
    """Eqs. (4), (5): (ẍ, ÿ) within one regime, m/s².

    Args:
        x, y: displacement, m.
        p: parameters; g: direction cosines.
        contact: 1 in contact, 0 separated.
        direction: sgn(V − ẋ).
        stick: 1 while sticking, when friction balances the elastic x-force and ẍ = 0.
        linear_springs: use K r instead of the exact geometry.
    """
    fx, fy = spring_force(x, y, p, g, linear_springs=linear_springs)
    normal = contact * contact_force(y, p)
    inverse_mass = p.mass**-1.0
    ax = (1.0 - stick) * inverse_mass * (fx + slip_force(normal, direction, p))
    return ax, inverse_mass * (fy + normal)


def mechanical_energy(
    x: Any, y: Any, vx: Any, vy: Any, p: Any, g: Geometry, *, contact: Any
) -> Any:
    """Kinetic + spring + contact energy, J; changes only by :func:`friction_power`."""
    kinetic = 0.5 * p.mass * (vx * vx + vy * vy)
    return kinetic + elastic_energy(x, y, p, g) + contact * contact_energy(y, p)


def friction_power(
    vx: Any, elastic_x: Any, normal_force: Any, p: Any, *, direction: Any, stick: Any = 0.0
) -> Any:
    """Power of the belt on the mass, W: μNẋ sgn(V − ẋ) in slip, −V·(elastic x-force) in stick."""
    slipping = slip_force(normal_force, direction, p) * vx
    return (1.0 - stick) * slipping - stick * p.belt_speed * elastic_x
