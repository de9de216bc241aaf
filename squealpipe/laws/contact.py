"""The unilateral contact spring k3, sharp and regularized."""

from typing import Any, cast

import numpy as np

from squealpipe.laws.contact_laws import ContactLaw, law_of


def law(p: Any) -> ContactLaw:
    """The contact law of some parameters."""
    return cast("ContactLaw", law_of(p.contact_law, p.preload))


def normal_force(y: Any, vy: Any, p: Any) -> Any:
    """N by the law that ``p.contact_law`` names, within one of its pieces."""
    return law(p).force(p.preload - y, -vy, p)


def contact_force(y: Any, p: Any) -> Any:
    """Eq. (1c): N = k3 (l_pre − y) while in contact, N: the foot of k3 follows the mass in x.

    The caller owns the state of contact; this law is linear, so it may be integrated across
    the switch without a kink.
    """
    return p.k3 * (p.preload - y)


def smoothed_compression(compression: Any, sigma: Any) -> Any:
    """½ c (1 + tanh σc), m: the smooth form of max(c, 0) in Eqs. (26) and (27)."""
    return 0.5 * compression * (1.0 + np.tanh(sigma * compression))


def smoothed_compression_slope(compression: Any, sigma: Any) -> Any:
    """d/dc of :func:`smoothed_compression`."""
    t = np.tanh(sigma * compression)
    return 0.5 * (1.0 + t + sigma * compression * (1.0 - t * t))


def regularized_force(y: Any, p: Any, sigma: Any) -> Any:
    """Eqs. (26), (27): their contact term ½ k3 (l_pre − y)(1 + tanh σ(l_pre − y)), N."""
    return p.k3 * smoothed_compression(p.preload - y, sigma)


def linearized_contact_stiffness(p: Any, sigma: Any) -> Any:
    """Eq. (8d): K3, N/m, by which the regularized force falls at y = 0; k3 for large σ l_pre."""
    return p.k3 * smoothed_compression_slope(p.preload, sigma)
