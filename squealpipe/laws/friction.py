"""Coulomb friction against the moving belt, set-valued and regularized."""

from __future__ import annotations

from typing import Any

import numpy as np


def slip_force(normal_force: Any, direction: Any, p: Any) -> Any:
    """Friction μ N sgn(V − ẋ) on the slipping mass, N.

    The paper prints μ(V_r) = μ sgn(V_r) below Eq. (5), which pushes the mass against the belt;
    Eqs. (6), (9), (18), (20) drag it along, as here (E1). ``direction`` is sgn(V − ẋ).
    """
    return p.mu * normal_force * direction


def stick_possible(elastic_x: Any, normal_force: Any, p: Any) -> Any:
    """Whether friction can hold the mass: |elastic x-force| ≤ μ N."""
    return np.abs(elastic_x) <= p.mu * normal_force


def regularized_slip_force(normal_force: Any, vx: Any, p: Any, sigma_v: Any) -> Any:
    """μ N tanh(σ_v (V − ẋ)), N: the smooth form used by codes without events."""
    return p.mu * normal_force * np.tanh(sigma_v * (p.belt_speed - vx))
