"""Tell whether A1 keeps contact from rest, over all angles or where A3 is unstable."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import maximum_filter1d

from squealpipe.laws.springs import springs_are_equal
from squealpipe.paper.inference.candidates import Candidates
from squealpipe.paper.inference.unstable_cells import midpoints, mirror_images
from squealpipe.parameters import HORIZON
from squealpipe.reading import READINGS
from squealpipe.schema import Outcome

MAP_SIZES, CLEAR = (12, 24, 48), 0.6
"""Midpoints an axis of the maps of runs: finer while |share − ½| is below ``CLEAR`` spacings."""
RARE = 0.02
"""Largest share of the midpoints amidst coarser ones that keep contact at which it may be lost: of
266 maps one had 1.1 %, and most had none."""


def separating_share(
    candidates: Candidates, *, angles: Sequence[int] = MAP_SIZES
) -> np.ndarray:
    """Share of the angle map on which A1, from rest, loses contact within ``HORIZON``.

    Midpoint rule; a parameter set goes on to the next number of ``angles``, twice the one before,
    while its share is within ``CLEAR``/angles of one half. Unless margins are wanted, a share that
    is clear of one half may be a lower bound.
    """
    shares = np.full(candidates.size, 0.5)
    left, lost = np.arange(candidates.size), None
    for number in angles:
        near = np.abs(shares[left] - 0.5) < CLEAR / number
        left, lost = left[near], None if lost is None else lost[near]
        if not left.size:
            break
        clear = 0.0 if number == angles[-1] else 0.5 * CLEAR / number
        turns = np.array([0.5 - clear, 0.5 + clear])
        lost = _lost(candidates.subset(left), number, lost, turns)
        shares[left] = lost.mean(axis=(1, 2))
    return shares


def _lost(
    candidates: Candidates, number: int, coarser: np.ndarray | None, turns: np.ndarray
) -> np.ndarray:
    """Return the midpoints, ``number`` an axis, at which contact is lost, (sets, number, number).

    Readings have them in common. On a belt along −x the motion at (α1, α2) mirrors that at (α2, α1)
    on a belt along +x. By Eq. (4) as printed the mass moves as on a belt along −x as long as it is
    slower than the belt.

    Args:
        coarser: the same at half as many midpoints an axis.
        turns: shares at which it changes what is said of the map, ascending.
    """
    known = candidates.known_maps
    if known is None:
        return _run_map(candidates, number, coarser, turns)[0]
    sizes = np.stack([np.abs(values) for values in candidates.fields.values()], axis=-1)
    sets = [(number, *row) for row in sizes.tolist()]
    model = candidates.model
    models = {reading.a1_model for reading in READINGS.values()}
    # kept as they are where a mass that lags behind the belt is dragged along −x
    printed = model == READINGS["as_printed"].a1_model
    turned = (candidates.fields["belt_speed"] > 0.0) != printed
    rows = np.flatnonzero([(model, each) not in known for each in sets])
    if rows.size:
        half = None if coarser is None else coarser[rows]
        maps, slow = _run_map(candidates.subset(rows), number, half, turns)
        for row, lost, is_slow in zip(rows, maps, slow, strict=True):
            for name in models if is_slow else {model}:
                known[name, sets[row]] = lost.T if turned[row] else lost
    found = np.array([known[model, each] for each in sets])
    return np.where(turned[:, None, None], found.swapaxes(1, 2), found)


def _run_map(
    candidates: Candidates, number: int, coarser: np.ndarray | None, turns: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return them by runs, and of which sets the mass is known to lag behind the belt.

    Runs that keep contact take 95 % of the steps. Unless margins are wanted, midpoints amidst
    coarser ones that all keep it come last, and only where ``RARE`` of them matters.
    """
    alpha1, alpha2 = midpoints(number)
    cells, twins = mirror_images(number, springs_are_equal(candidates.fields))
    late = np.zeros((candidates.size, number**2), bool)
    if coarser is not None and not candidates.exact:
        late = _amidst_kept(coarser).reshape(late.shape)
    printed = READINGS["as_printed"].a1_model
    watched = candidates.known_maps is not None and candidates.model == printed
    lost = np.zeros((candidates.size, number**2), bool)
    slow = np.full(candidates.size, watched)
    matters = np.ones(candidates.size, bool)
    for wanted in (~late, late):
        rows, run_cells = np.nonzero(wanted[:, cells] & matters[:, None])
        run_cells = cells[run_cells]
        some = candidates.subset(rows)
        tracked = ("vx",) if watched else ()
        outcome, _, speed = _runs(some, alpha1[run_cells], alpha2[run_cells], tracked)
        separates = outcome == Outcome.separated
        lost[rows, run_cells] = lost[rows, twins[run_cells]] = separates
        slow[rows[speed >= np.abs(some.fields["belt_speed"])]] = False
        least = lost.mean(axis=1)
        most = least + RARE * late.mean(axis=1)
        matters = np.searchsorted(turns, least) < np.searchsorted(turns, most)
    return lost.reshape(-1, number, number), slow


def _amidst_kept(lost: np.ndarray) -> np.ndarray:
    """Return which of twice as many midpoints an axis lie amidst four that keep contact."""
    kept = np.pad(~lost, ((0, 0), (1, 1), (1, 1)), mode="edge")
    pairs = kept[:, 1:] & kept[:, :-1]
    four = pairs[:, :, 1:] & pairs[:, :, :-1]
    corner = (np.arange(2 * lost.shape[1]) + 1) // 2
    return np.asarray(four[:, corner[:, None], corner])


def keeping_share(candidates: Candidates) -> np.ndarray:
    """Share of the unstable cells in which A1 keeps contact throughout ``HORIZON``; 0 of none.

    Only cells well inside the region's edge are run: every eighth of them, and all where A1 keeps
    contact in none of these. Unless margins are wanted, every 64th comes first, and none is run
    between two of every eighth that lose contact as soon as the mass first swings away.
    """
    # Distance of the cells from the centre of the disc of flutter, in radii: a region that is
    # thinner than the rest shows on no map, and next to the edge nothing grows within the horizon
    visible_radius = 0.95
    unstable = candidates.unstable_cells(visible_radius)
    cells = np.bincount(unstable.owner, minlength=candidates.size)
    number = np.arange(unstable.owner.size) - (np.cumsum(cells) - cells)[unstable.owner]
    share = np.zeros(candidates.size)
    # one in so many of the unstable cells is run first: one that keeps contact decides
    fresh = np.ones(number.size, bool)
    lasts = np.zeros(number.size)
    for step in (8, 1) if candidates.exact else (64, 8, 1):
        wanted = fresh & (share[unstable.owner] == 0) & (number % step == 0)
        if step == 1 and not candidates.exact:
            # √(m/k1); next to some cell that keeps contact, if any does, it lasts for 13 at least
            first_swing = 6.0
            # those of every eighth on both sides are less than eight cells away
            wanted &= maximum_filter1d(lasts, 15, mode="constant") > first_swing
        at = np.flatnonzero(wanted)
        owner, fresh[at] = unstable.owner[at], False
        some = candidates.subset(owner)
        outcome, time, _ = _runs(some, unstable.alpha1[at], unstable.alpha2[at])
        lasts[at] = time / some.time_unit
        kept = np.bincount(
            owner[outcome == Outcome.converged], minlength=candidates.size
        )
        share += kept / np.maximum(-(-cells // step), 1)
    return share


def _runs(
    candidates: Candidates,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    tracked: tuple[str, ...] = (),
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return how runs from rest to ``HORIZON``, or until contact is lost, end, when, largest |ẋ|.

    A tolerance of 1e-6, relative to a motion of 30 l_pre, suffices: orders of the series go to
    spare, so that the contact force differs by 1e-6 k3 l_pre at most and a tenth of that mostly
    from that with 1e-12. Of a million runs one ends otherwise. What stops before the end, as where
    events seem to accumulate, is run with the tolerance asked for.
    """
    outcome = np.full(alpha1.size, int(Outcome.unresolved), np.int8)
    time, speed = np.zeros((2, alpha1.size))
    every = np.arange(alpha1.size)
    # runs side by side: the memory of more would come fresh from the system each time
    at_once = 2**14
    for first in range(0, alpha1.size, at_once):
        rows = every[first : first + at_once]
        for tol, size in ((max(candidates.tol, 1e-6), 30.0), (candidates.tol, 1.0)):
            some = replace(candidates.subset(rows), tol=tol)
            runs = some.ensemble(
                alpha1[rows],
                alpha2[rows],
                t_end=HORIZON * some.time_unit,
                stop_at_first_separation=True,
                tracked=tracked,
                size=size,
            )
            outcome[rows], time[rows] = runs.outcome, runs.time
            if tracked:
                speed[rows] = runs.early_max_vx
            rows = rows[~np.isin(runs.outcome, (Outcome.converged, Outcome.separated))]
            if not rows.size:
                break
    return outcome, time, speed
