"""Tell whether A1 keeps contact from rest, over all angles or where A3 is unstable."""

from collections.abc import Sequence

import numpy as np

from squealpipe.laws.springs import springs_are_equal
from squealpipe.paper.inference.candidates import Candidates
from squealpipe.paper.inference.unstable_cells import midpoints
from squealpipe.parameters import HORIZON
from squealpipe.schema import Outcome

MAP_SIZES, CLEAR = (12, 24, 48), 0.6
"""Midpoints an axis of the maps of runs: finer while |share − ½| is below ``CLEAR`` spacings."""


def separating_share(
    candidates: Candidates, *, angles: Sequence[int] = MAP_SIZES
) -> np.ndarray:
    """Share of the angle map on which A1, from rest, loses contact within ``HORIZON``.

    Midpoint rule; a parameter set goes on to the next number of ``angles`` while its share is
    within ``CLEAR``/angles of one half.
    """
    shares = np.full(candidates.size, 0.5)
    for number in angles:
        left = np.flatnonzero(np.abs(shares - 0.5) < CLEAR / number)
        shares[left] = _share(candidates.subset(left), number)
    return shares


def _share(candidates: Candidates, number: int) -> np.ndarray:
    """Share of the midpoints, ``number`` an axis, at which contact is lost."""
    alpha1, alpha2 = midpoints(number)
    weight = np.ones(alpha1.size)
    if springs_are_equal(candidates.fields):
        middle = np.abs(alpha1 + alpha2 - np.pi) < 1e-9
        below = middle | (alpha1 + alpha2 < np.pi)
        weight = np.where(middle, 1.0, 2.0)[below]
        alpha1, alpha2 = alpha1[below], alpha2[below]
    rows = np.arange(candidates.size)[:, None]
    outcome = _outcome(candidates.subset(rows), alpha1, alpha2)
    return np.asarray((outcome == Outcome.separated) @ weight / number**2)


def keeping_share(candidates: Candidates) -> np.ndarray:
    """Share of the unstable cells in which A1 keeps contact throughout ``HORIZON``; 0 of none.

    Only cells well inside the region's edge are run: every eighth of them, and all where A1 keeps
    contact in none of these. Unless margins are wanted, every 64th comes first.
    """
    # Distance of the cells from the centre of the disc of flutter, in radii: a region that is
    # thinner than the rest shows on no map, and next to the edge nothing grows within the horizon
    visible_radius = 0.95
    unstable = candidates.unstable_cells(visible_radius)
    share = np.zeros(candidates.size)
    # one in so many of the unstable cells is run first: one that keeps contact decides
    for step in (8, 1) if candidates.exact else (64, 8, 1):
        left = np.flatnonzero(share == 0)
        some = [unstable[i] for i in left]
        cells = [(where.alpha1[::step], where.alpha2[::step]) for where in some]
        number = np.array([alpha1.size for alpha1, _ in cells], int)
        owner = np.repeat(np.arange(left.size), number)
        alpha1, alpha2 = (
            np.concatenate([*(cell[i] for cell in cells), []]) for i in (0, 1)
        )
        kept = (
            _outcome(candidates.subset(left[owner]), alpha1, alpha2)
            == Outcome.converged
        )
        share[left] = np.bincount(owner[kept], minlength=left.size) / np.maximum(
            number, 1
        )
    return share


def _outcome(
    candidates: Candidates, alpha1: np.ndarray, alpha2: np.ndarray
) -> np.ndarray:
    """``separated`` where A1 loses contact from rest by ``HORIZON``, else how its run ended."""
    shape = np.broadcast_shapes(candidates.fields["mu"].shape, alpha1.shape)
    if 0 in shape:
        return np.zeros(shape, np.int8)
    t_end = HORIZON * candidates.time_unit
    return candidates.ensemble(
        alpha1, alpha2, t_end=t_end, stop_at_first_separation=True, tracked=()
    ).outcome
