"""A motion that lasts, followed as friction falls, until it dies.

From the motion at one friction runs go on at lower ones, side by side. Down to where the first of
them dies they have shown motions that last; from the lowest of these runs go on between both. So
the steps in friction shrink until what dies has started next to what lasts: no jump in friction,
but the end of the motion itself, is what is found.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from squealpipe.structures.schema.squealing import SquealLimits
from squealpipe.structures.squeal.first_onset import FirstOnset
from squealpipe.structures.squeal.plant import PUSH_OF_A_MODE, Plant
from squealpipe.structures.squeal.settling import GROWTH, RunLengths, start_at
from squealpipe.structures.squeal.windows import Running, StructureWindows, run_windows
from squealpipe.vibration.settled_runs import Horizon, settle
from squealpipe.vibration.settling import settling_of_verdicts


@dataclass(frozen=True)
class TrackState:
    """A motion that lasts, at one friction."""

    mu: float
    state: np.ndarray
    regimes: np.ndarray
    speed: float
    frequency: float


class UnstableCycles(NamedTuple):
    """Cycles over friction: friction and rms speed of vibration, (points,)."""

    mu: np.ndarray
    speed: np.ndarray


none_unstable = UnstableCycles(np.empty(0), np.empty(0))


@dataclass
class Track:
    """A motion as friction falls.

    Attributes:
        states: where it lasts, in the order in which they were run.
        dies: the largest friction at which it was seen to die; NaN if it was not.
        narrow: whether the end is as narrow as it was to be.
        fold: where its cycle meets an unstable one; NaN if that is not located.
        unstable: that one, from the fold on.
    """

    states: list[TrackState]
    dies: float = np.nan
    narrow: bool = False
    fold: float = np.nan
    unstable: UnstableCycles = none_unstable

    @property
    def lasts(self) -> TrackState:
        """Return the motion at the smallest friction."""
        return min(self.states, key=lambda each: each.mu)

    @property
    def ordered(self) -> list[TrackState]:
        """Return the motions from the largest friction down."""
        return sorted(self.states, key=lambda each: -each.mu)


def followed_down(plant: Plant, start: TrackState, onset: float, how: Running) -> Track:
    """Follow a motion down from a friction, to where it dies below the onset of steady sliding.

    Args:
        plant: whose system is run, at any friction.
        onset: friction below which small motions die out.
    """
    track = Track([start])
    # down to just below the onset first: there most motions die
    for turn, frictions in enumerate(_turns(track, onset)):
        rows = _run_on(plant, track.lasts, frictions, how.turn(turn))
        for mu, row in zip(frictions.tolist(), rows, strict=True):
            if row is None:
                track.dies = mu
                break
            track.states.append(state_of(plant, mu, row))
        else:
            track.dies = np.nan
    return track


def width_of(track: Track, onset: float) -> float:
    """Return the width to which the end is to be located."""
    return SquealLimits.narrow * min(onset, track.states[0].mu)


def _turns(track: Track, onset: float) -> Iterator[np.ndarray]:
    """Frictions of the next turn, falling, until the end is narrow."""
    width = width_of(track, onset)
    floor = max(onset - width, 0.0) if onset < track.lasts.mu else 0.0
    # after twelve turns the end is what it is
    # frictions of one turn are run together
    side_by_side = 8
    for _ in range(12):
        top = track.lasts.mu
        yield np.linspace(top, floor, side_by_side + 1)[1:]
        low, high = track.dies, track.lasts.mu
        if np.isnan(low):
            # at no friction nothing feeds it, but nothing ends it either
            if high <= 0.0:
                return
            floor = 0.0  # what died from far away lasts from nearby
            continue
        floor = low
        # what dies has started from next to it
        near = top - low <= side_by_side * width
        if near and min(high, onset) - low <= 1.0001 * width:
            track.narrow = True
            return


def _run_on(
    plant: Plant, start: TrackState, frictions: np.ndarray, how: Running
) -> list[StructureWindows | None]:
    """Return what a motion becomes at other frictions; None where it dies out."""
    first = RunLengths.first_window / plant.slowest
    subjects = [Plant(plant.structure.with_(mu=mu)) for mu in frictions.tolist()]
    starts = [
        replace(start_at(subject, start.state), period=1.0 / plant.slowest)
        for subject in subjects
    ]

    def advance(
        rows: list[int],
        states: np.ndarray,
        regimes: np.ndarray | None,
        seconds: np.ndarray,
        turn: int,
    ) -> StructureWindows:
        return run_windows(
            plant, states, seconds, how.turn(turn), regimes, frictions[rows]
        )

    unit = np.full(len(starts), first)
    # a motion that still moves after six doublings of the window is taken to last
    ended = settle(
        starts,
        advance,
        Horizon(unit, 2.0 * unit, (2.0**6 - 1.0) * unit),
        settling_of_verdicts,
        regimes=np.tile(start.regimes, (len(starts), 1)),
    )
    return [None if run.quiet else run.last for run in ended]


def just_above(onset: FirstOnset, plant: Plant, how: Running) -> TrackState | None:
    """Return what a small push settles on just above the onset; None where it has not in time."""
    above = onset.above
    place = int(above.unstable[0])
    period = 1.0 / above.slowest
    rate = float(above.spectrum.values[place].real)
    frictions = np.full(1, SquealLimits.above * onset.mu)
    window = run_windows(
        plant,
        np.tile(above.pushed(place, PUSH_OF_A_MODE), (1, 1)),
        min(GROWTH / rate, RunLengths.longest_growth * period),
        how,
        frictions=frictions,
    ).row(0)
    if not window.finished:
        return None
    begun = TrackState(
        SquealLimits.above * onset.mu, window.final, window.regimes, 0.0, 0.0
    )
    (row,) = _run_on(plant, begun, frictions[:1], how)
    # where nothing switches it still grows
    return state_of(plant, begun.mu, row) if row is not None and row.events else None


def state_of(plant: Plant, mu: float, row: StructureWindows) -> TrackState:
    """A settled motion at a friction."""
    strongest = int(np.argmax(row.velocities))
    return TrackState(
        mu,
        row.final,
        row.regimes,
        float(np.sqrt((row.speed**2).mean())),
        float(plant.rest[0][strongest] / (2.0 * np.pi)),
    )
