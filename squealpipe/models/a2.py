"""A2: linear springs, permanent contact, no acceleration: quasi-static sliding (section 5).

Drops from A1 the exact geometry, contact loss, inertia and the belt's reversal, and holds the
mass at y = 0. Valid while a sliding state with positive reaction exists and is approached slowly.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from squealpipe.laws.springs import Stiffness


def coupling_is_zero(stiffness: Stiffness) -> Any:
    """Whether K12 vanishes to round-off: |K12| below 4 ulp of the stiffness (E3)."""
    scale = np.maximum(stiffness.k11, stiffness.k22)
    return np.abs(stiffness.k12) <= 4.0 * np.finfo(float).eps * scale


def possible_as_printed(stiffness: Stiffness, mu: Any) -> Any:
    """Eq. (11) as printed: μ < K11/K12. True where K12 = 0; False where K12 < 0 (E3)."""
    zero = coupling_is_zero(stiffness)
    k12 = np.where(zero, 1.0, stiffness.k12)
    return zero | (mu < stiffness.k11 / k12)


def reaction_force(stiffness: Stiffness, mu: Any, actuation: Any) -> Any:
    """R_n = F_n/(1 − μK12/K11) from Eq. (10) with y = 0, N; F_n = k3 l_pre.

    NaN where K11 = 0 as well as K12 = 0 (0/0 at α1 = α2 = π/2).
    """
    k12 = np.where(coupling_is_zero(stiffness), 0.0, stiffness.k12)
    k11 = np.where(stiffness.k11 <= 4.0 * np.finfo(float).eps * stiffness.k22, 0.0, stiffness.k11)
    with np.errstate(divide="ignore", invalid="ignore"):
        return actuation * k11 / (k11 - mu * k12)
