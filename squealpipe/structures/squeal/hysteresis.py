"""Hysteresis of squeal: the frictions at which it begins and at which it dies."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from squealpipe.schema import Outcome
from squealpipe.structures.schema.squealing import JUST_ABOVE, OnsetKind
from squealpipe.structures.squeal.descent import (
    Track,
    followed_down,
    just_above,
    state_of,
    width_of,
)
from squealpipe.structures.squeal.first_onset import FirstOnset, confirmed_onset
from squealpipe.structures.squeal.fold import add_fold
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.windows import Running
from squealpipe.vibration.settled_runs import SettledRun


def hysteresis(plant: Plant, settled: list[SettledRun], how: Running) -> dict[str, Any]:
    """Variables of the onset and of tracks: motions followed down in friction until they die.

    Args:
        settled: one run of each attractor.
    """
    found, mu = confirmed_onset(plant), plant.structure.mu
    onset = found if isinstance(found, FirstOnset) else None
    tracks: dict[int, Track] = {}
    decays = onset.damped if onset else plant.decays
    limit = onset.mu if onset else math.inf
    if decays:
        moving = [index for index, each in enumerate(settled) if not each.quiet]
        # the three motions that most random starts settle on
        for place in moving[:3]:
            start = state_of(plant, mu, settled[place].last)
            tracks[place] = followed_down(plant, start, limit, how)
    kind = OnsetKind.undetermined
    if onset and decays:
        begun = just_above(onset, plant, how)
        if begun:
            track = tracks[JUST_ABOVE] = followed_down(plant, begun, limit, how)
            kind = _kind_of(track, limit)
    _locate_folds(plant, list(tracks.values()), limit)
    return {**_onset(found, kind), **_tracks(tracks, limit)}


def _locate_folds(plant: Plant, tracks: list[Track], onset: float) -> None:
    """The exact ends of those that last below the onset, each end once."""
    ended: list[Track] = []
    for track in tracks:
        if not track.narrow or not _lasts_below(track, onset):
            continue
        width, last = width_of(track, onset), track.lasts
        # tracks that end at one friction with levels this close are one motion
        same = [
            other
            for other in ended
            if abs(other.lasts.mu - last.mu) <= width
            and abs(other.lasts.speed - last.speed) <= 0.05 * last.speed
        ]
        if same:
            track.fold, track.unstable = same[0].fold, same[0].unstable
        else:
            add_fold(plant, track, onset, width)
            ended.append(track)


def _kind_of(track: Track, onset: float) -> OnsetKind:
    """Return whether what squeals just above the onset lasts below it."""
    if not track.narrow:
        return OnsetKind.undetermined
    lasts = _lasts_below(track, onset)
    return OnsetKind.subcritical if lasts else OnsetKind.supercritical


def _lasts_below(track: Track, onset: float) -> bool:
    return track.lasts.mu < onset


def _onset(found: FirstOnset | Outcome, kind: OnsetKind) -> dict[str, Any]:
    mu, frequency = np.nan, np.nan
    outcome = found
    if isinstance(found, FirstOnset):
        mu, frequency = found.mu, found.frequency
        unknown = kind is OnsetKind.undetermined
        outcome = Outcome.unresolved if unknown else Outcome.converged
    return {
        "onset_mu": mu,
        "onset_frequency": frequency,
        "onset_kind": kind,
        "onset_outcome": outcome,
    }


def _tracks(tracks: dict[int, Track], onset: float) -> dict[str, Any]:
    """Each motion over friction, and where it dies."""
    found = list(tracks.values())
    low = np.array([track.dies for track in found], float)
    high = np.array([min(track.lasts.mu, onset) for track in found], float)
    narrow = np.array([track.narrow for track in found], bool)
    below = np.array([_lasts_below(track, onset) for track in found], bool)
    # nothing lasts below the onset: it dies there
    dies = np.where(below | ~np.isfinite(onset), 0.5 * (low + high), onset)
    fold = np.array([track.fold for track in found], float)
    located = np.isfinite(fold)
    dies = np.where(narrow, np.where(located, fold, dies), np.nan)
    lowest = np.nanmin(dies, initial=math.inf) if narrow.any() else np.nan
    return {
        "track_attractor": np.array(list(tracks), int),
        "mu_dies": dies,
        "mu_dies_low": np.where(narrow, low, np.nan),
        "mu_dies_high": high,
        "mu_dies_is_fold": located,
        "squeals_below_critical": bool(np.isfinite(onset) and below.any()),
        "hysteresis": max(onset - lowest, 0.0) if math.isfinite(onset) else np.nan,
        **{
            name: _padded(
                [[getattr(at, field) for at in track.ordered] for track in found]
            )
            for name, field in (
                ("track_mu", "mu"),
                ("track_velocity_rms", "speed"),
                ("track_frequency", "frequency"),
            )
        },
        "unstable_mu": _padded([track.unstable.mu for track in found]),
        "unstable_velocity_rms": _padded([track.unstable.speed for track in found]),
        "track_outcome": np.where(narrow, Outcome.converged, Outcome.unresolved),
    }


def _padded(rows: Sequence[Any]) -> np.ndarray:
    """Rows of different lengths as a table, NaN where there is nothing."""
    table = np.full((len(rows), max(map(len, rows), default=0)), np.nan)
    for index, row in enumerate(rows):
        table[index, : len(row)] = row
    return table
