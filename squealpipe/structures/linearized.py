"""Small motions about steady sliding.

Their pencil is M s² + (C + Σ Nᵢ μᵢ′ tᵢtᵢᵀ) s + K + Σ kᵢ (nᵢ + σᵢ μᵢ tᵢ) nᵢᵀ, both sums over closed
contacts, with Nᵢ, kᵢ, σᵢ and μᵢ of the state (:mod:`.sliding`). Those with transverse damping add
Σ (Nᵢ μᵢ/|wᵢ|) aᵢaᵢᵀ s, aᵢ across the sliding.
"""

from typing import Any

import numpy as np
import scipy.sparse as sp

from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.pencil import DENSE, LowRank, Pencil, Uncertain, sparse_rows
from squealpipe.structures.sliding import (
    SlidingBalance,
    SteadySliding,
    acting_directions,
    contact_stiffness,
)


def pencil_about(
    structure: ContactStructure, state: SteadySliding, modal: LowRank | None
) -> Pencil:
    """The pencil of small motions about steady sliding, with the damping of single modes."""
    acting = acting_directions(structure, state.closed, state.drag)
    falling = state.force * state.slope
    damping = structure.damping
    if falling.any():
        tangential = sp.csr_array(structure.tangentials * falling)
        damping = _tidy(damping + tangential @ sp.csr_array(structure.tangentials).T)
    if structure.transversals.any():
        # friction μN turns with the sliding velocity: across it, μN times its angle v/|V|
        speeds = np.abs(structure.speeds * state.belt_speed)
        turning = state.force * np.abs(state.drag) / speeds
        across = sp.csr_array(structure.transversals)
        damping = _tidy(damping + across * turning @ across.T)
    springs = contact_stiffness(structure, state.stiffness, acting)
    stiffness = structure.stiffness + springs
    return Pencil(
        structure.mass, damping, _tidy(stiffness), modal, _uncertain(structure, state)
    )


def _uncertain(structure: ContactStructure, state: SteadySliding) -> Uncertain | None:
    """Return the uncertainty of damping and stiffness from rounding of forces and of friction."""
    rounding = SlidingBalance.rounding_of_friction * np.finfo(float).eps
    closed = state.closed
    if not closed.any():
        return None
    along, across = structure.tangentials[:, closed], structure.normals[:, closed]
    force = state.force_error + rounding * state.force
    damping = (force * np.abs(state.slope))[closed]
    stiffness = (rounding * state.stiffness * np.abs(state.drag))[closed]
    left, right = np.hstack([along, along]), np.hstack([along, across])
    if structure.size > DENSE:
        left, right = sp.csc_array(left), sp.csc_array(right)
    return Uncertain(
        left,
        right,
        np.concatenate([damping, 0.0 * stiffness]),
        np.concatenate([0.0 * damping, stiffness]),
    )


def _tidy(matrix: Any) -> sp.csr_array:
    if isinstance(matrix, np.ndarray):  # of few degrees of freedom
        return sparse_rows(matrix)
    tidy = sp.csr_array(matrix, copy=True)
    tidy.sum_duplicates()
    tidy.eliminate_zeros()
    return tidy
