"""A2: linear springs, permanent contact, no acceleration: quasi-static sliding (section 5).

Drops from A1 the exact geometry, contact loss, inertia and the belt's reversal, and holds the
mass at y = 0. Valid while a sliding state with positive reaction exists and is approached slowly.
"""

from typing import Any

import numpy as np

from squealpipe.laws.contact import law, linearized_contact_stiffness, regularized_force
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction import dragging_force
from squealpipe.laws.springs import Stiffness, linear_elastic_force

FEW_ULPS = 4.0 * np.finfo(float).eps
"""Below this share of the stiffness, K11 and K12 count as zero."""


def acceleration(
    x: Any, y: Any, p: Any, stiffness: Stiffness, sigma: Any = None
) -> tuple[Any, Any]:
    """Eqs. (6), (7): (ẍ, ÿ) of the model linearized about x = y = 0, m/s².

    ``sigma`` regularizes the contact law, 1/m; None means the sharp law.
    """
    stiffness3 = contact_stiffness(p, sigma)
    normal = actuation(p, sigma) - stiffness3 * y
    fx, fy = linear_elastic_force(x, y, stiffness)
    friction = dragging_force(normal, p)
    inverse_mass = p.mass**-1.0
    return inverse_mass * (fx + friction), inverse_mass * (fy + normal)


def contact_stiffness(p: Any, sigma: Any = None) -> Any:
    """K3 of Eq. (8d), N/m; without ``sigma`` the slope of the contact law at l_pre."""
    if sigma is None:
        return law(p).stiffness(p.preload, p)
    if p.contact_law != LINEAR:
        raise ValueError(
            f"sigma = {sigma!r} regularizes the linear contact law alone; leave it out"
        )
    return linearized_contact_stiffness(p, sigma)


def actuation(p: Any, sigma: Any = None) -> Any:
    """F_n, the contact force at y = 0 and right-hand side of Eq. (7), N; k3 l_pre if sharp."""
    return p.k3 * p.preload if sigma is None else regularized_force(0.0, p, sigma)


def coupling_is_zero(stiffness: Stiffness) -> Any:
    """Return whether K12 vanishes to round-off (E3)."""
    return np.abs(stiffness.k12) <= FEW_ULPS * (stiffness.k11 + stiffness.k22)


def _without_round_off(stiffness: Stiffness) -> tuple[Any, Any]:
    """K11 and K12, exactly 0 where they vanish to round-off."""
    k11_is_zero = stiffness.k11 <= FEW_ULPS * stiffness.k22
    return (
        np.where(k11_is_zero, 0.0, stiffness.k11),
        np.where(coupling_is_zero(stiffness), 0.0, stiffness.k12),
    )


def possible_as_printed(stiffness: Stiffness, mu: Any) -> Any:
    """Eq. (11) as printed: μ < K11/K12.

    True where K12 = 0 (no bound on μ), False where K12 < 0 (E3) and where K11 = 0 as well as
    K12 = 0, at α1 = α2 = π/2, for nothing balances friction there. Taken literally: it knows no
    direction of the belt, so of a negative μ, of a belt along −x, the size counts.
    """
    k11, k12 = _without_round_off(stiffness)
    coupled = k12 != 0
    return np.where(coupled, np.abs(mu) < k11 / np.where(coupled, k12, 1.0), k11 > 0)


def reaction_force(stiffness: Stiffness, mu: Any, load: Any) -> Any:
    """Eqs. (9), (10) without acceleration and with y = 0: R_n = F_n/(1 − μK12/K11), N.

    Sliding is possible where it is positive, that is, μ K12 < K11. NaN where there is no such
    state: K11 = μ K12, of which α1 = α2 = π/2 is the case 0/0.
    """
    k11, k12 = _without_round_off(stiffness)
    rest = k11 - mu * k12
    singular = rest == 0
    return np.where(singular, np.nan, load * k11 / np.where(singular, 1.0, rest))
