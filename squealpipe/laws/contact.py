"""The unilateral contact spring k3, sharp and regularized."""

from __future__ import annotations

from typing import Any

import numpy as np


def contact_force(y: Any, p: Any) -> Any:
    """Eq. (1c): N = k3 (l_pre − y) while in contact, N: the foot of k3 follows the mass in x.

    The caller owns the state of contact; this law is linear, so it may be integrated across
    the switch without a kink. See :func:`unilateral_force` for the law with its switch.
    """
    return p.k3 * (p.preload - y)


def unilateral_force(y: Any, p: Any) -> Any:
    """N = k3 max(l_pre − y, 0), N (floats and arrays): contact term with sign(l_pre − y)."""
    return p.k3 * np.maximum(p.preload - y, 0.0)


def contact_energy(y: Any, p: Any) -> Any:
    """½ k3 (l_pre − y)² while in contact, J: the potential of :func:`contact_force`."""
    return 0.5 * p.k3 * (p.preload - y) * (p.preload - y)


def regularized_force(y: Any, p: Any, sigma: Any) -> Any:
    """Eqs. (26), (27): their contact term ½ k3 (l_pre − y)(1 + tanh σ(l_pre − y)), N."""
    gap = p.preload - y
    return 0.5 * p.k3 * gap * (1.0 + np.tanh(sigma * gap))


def regularized_stiffness(y: Any, p: Any, sigma: Any) -> Any:
    """−d/dy of :func:`regularized_force`, N/m."""
    gap = p.preload - y
    t = np.tanh(sigma * gap)
    return 0.5 * p.k3 * (1.0 + t + sigma * gap * (1.0 - t * t))


def linearized_contact_stiffness(p: Any, sigma: Any) -> Any:
    """Eq. (8d): K3, the regularized stiffness at y = 0, N/m; tends to k3 for large σ l_pre."""
    return regularized_stiffness(0.0, p, sigma)
