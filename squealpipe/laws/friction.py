"""Friction against the moving belt: slip and stick.

How the coefficient depends on the sliding speed is a law of its own
(:mod:`squealpipe.laws.friction_laws`); the limit of stick and the sign of slip are common to all.
"""

from typing import Any

import numpy as np


def slip_force(normal_force: Any, direction: Any, mu: Any) -> Any:
    """Friction μ N sgn(V − ẋ) on the slipping mass, N.

    The paper prints μ(V_r) = μ sgn(V_r) below Eq. (5), which pushes the mass against the belt;
    Eqs. (6), (9), (18), (20) drag it along, as here (E1).
    """
    return mu * normal_force * direction


def dragging_force(normal_force: Any, p: Any) -> Any:
    """μ(|V|) N sgn V, N: friction on a mass that never moves as fast as the belt."""
    return p.drag * normal_force


def stick_limit(normal_force: Any, p: Any) -> Any:
    """μs N, N: the largest friction force on a mass that sticks."""
    return p.static_mu * normal_force


def slides(speed: Any, p: Any) -> Any:
    """Return whether the mass keeps sliding in one sense: its speed along the belt stays below |V|.

    Args:
        speed: largest sgn(V) ẋ of a motion, m/s; of a motion that is symmetric
            in time the largest |ẋ|, which for any other one is a bound.
    """
    return np.less(speed, np.abs(p.belt_speed))
