"""Tell whether A1 keeps contact from rest, over all angles or where A3 is unstable."""

from collections.abc import Sequence

import numpy as np

from squealpipe.brake.a1.ensemble import Ensemble
from squealpipe.laws.springs import springs_are_equal
from squealpipe.paper.inference.candidates import Candidates
from squealpipe.paper.inference.unstable_cells import midpoints
from squealpipe.parameters import HORIZON
from squealpipe.reading import READINGS
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
        if left.size:
            shares[left] = _share(candidates.subset(left), number)
    return shares


def _share(candidates: Candidates, number: int) -> np.ndarray:
    """Return the share of the midpoints, ``number`` an axis, at which contact is lost.

    Readings have it in common. On a belt along −x the motion at (α1, α2) mirrors that at (α2, α1)
    on a belt along +x. By Eq. (4) as printed the mass moves as on a belt along −x as long as it is
    slower than the belt.
    """
    known = candidates.known_shares
    if known is None:
        return _run_map(candidates, number)[0]
    sizes = np.stack([np.abs(values) for values in candidates.fields.values()], axis=-1)
    sets = [(number, *row) for row in sizes.tolist()]
    model = candidates.model
    models = {reading.a1_model for reading in READINGS.values()}
    left = np.array([(model, each) not in known for each in sets], bool)
    if left.any():
        rows = np.flatnonzero(left)
        shares, slow = _run_map(candidates.subset(rows), number)
        for row, share, is_slow in zip(rows, shares, slow, strict=True):
            for name in models if is_slow else {model}:
                known[name, sets[row]] = share
    return np.array([known[model, each] for each in sets])


def _run_map(candidates: Candidates, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Return that share by runs, and of which sets the mass is known to lag behind the belt."""
    alpha1, alpha2 = midpoints(number)
    weight = np.ones(alpha1.size)
    if springs_are_equal(candidates.fields):
        middle = np.abs(alpha1 + alpha2 - np.pi) < 1e-9
        below = middle | (alpha1 + alpha2 < np.pi)
        weight = np.where(middle, 1.0, 2.0)[below]
        alpha1, alpha2 = alpha1[below], alpha2[below]
    printed = READINGS["as_printed"].a1_model
    watched = candidates.known_shares is not None and candidates.model == printed
    some = candidates.subset(np.arange(candidates.size)[:, None])
    runs = _runs(some, alpha1, alpha2, ("vx",) if watched else ())
    slow = np.zeros(candidates.size, bool)
    if watched:
        slow = runs.early_max_vx.max(axis=1) < np.abs(candidates.fields["belt_speed"])
    lost = runs.outcome == Outcome.separated
    return np.asarray(lost @ weight / number**2), slow


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
    steps = (8, 1) if candidates.exact else (64, 8, 1)
    for before, step in zip((0, *steps), steps, strict=False):
        left = np.flatnonzero(share == 0)
        some = [unstable[i] for i in left]
        number = np.array([-(-where.alpha1.size // step) for where in some], int)
        new = [_cells_to_run(before, step, where.alpha1.size) for where in some]
        owner = np.repeat(np.arange(left.size), [each.size for each in new])
        alpha1, alpha2 = (
            np.concatenate([*(w[i][k] for w, k in zip(some, new, strict=True)), []])
            for i in (0, 1)
        )
        runs = _runs(candidates.subset(left[owner]), alpha1, alpha2)
        kept = runs.outcome == Outcome.converged
        share[left] = np.bincount(owner[kept], minlength=left.size) / np.maximum(
            number, 1
        )
    return share


def _cells_to_run(before: int, step: int, number: int) -> np.ndarray:
    """Return every ``step``-th index below ``number`` but every ``before``-th, which has been run.

    None has been run if ``before`` is 0.
    """
    cells = np.arange(0, number, step)
    return cells[cells % before > 0] if before else cells


def _runs(
    candidates: Candidates,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    tracked: tuple[str, ...] = (),
) -> Ensemble:
    """Run from rest to ``HORIZON``, or until contact is lost."""
    return candidates.ensemble(
        alpha1,
        alpha2,
        t_end=HORIZON * candidates.time_unit,
        stop_at_first_separation=True,
        tracked=tracked,
    )
