"""The energy of A1 with a linear contact, and the power of the belt on it."""

import numpy as np

from squealpipe.laws.friction_laws import coefficient
from squealpipe.laws.springs import fixed_ends


def elastic_energy(x, y, p, g):
    """½ Σ k_i (d_i − L_i)² of the two springs, J."""
    x1, y1, x2, y2 = fixed_ends(p, g)
    stretch1, stretch2 = (
        np.hypot(x - x1, y - y1) - p.length1,
        np.hypot(x - x2, y - y2) - p.length2,
    )
    return 0.5 * (p.k1 * stretch1**2 + p.k2 * stretch2**2)


def mechanical_energy(x, y, vx, vy, p, g, contact):
    """Kinetic + spring + contact energy, J."""
    kinetic = 0.5 * p.mass * (vx * vx + vy * vy)
    return (
        kinetic
        + elastic_energy(x, y, p, g)
        + contact * 0.5 * p.k3 * (p.preload - y) ** 2
    )


def friction_power(vx, suspension_x, normal_force, p, direction, stick):
    """μNẋ sgn(V − ẋ) in slip, −V·(other x-forces) in stick, W."""
    slipping = (
        coefficient(direction * (p.belt_speed - vx), p) * normal_force * direction * vx
    )
    return (1.0 - stick) * slipping - stick * p.belt_speed * suspension_x
