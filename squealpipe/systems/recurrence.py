"""Detection of repetition in a sequence of events."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Recurrence:
    """Thresholds by which a sequence of events repeats."""

    least_repeats: int = 3
    """Whole periods that a sequence must show."""
    repeated: float = 1e-6
    """Largest difference in a repetition: of intervals over their mean, of states over their
    ranges."""
    events_at_once: int = 2**20
    """Logged events that are held in memory at once, 48 bytes each."""


def repeats_after(
    times: np.ndarray,
    kinds: np.ndarray,
    tolerance: float,
    states: np.ndarray | None = None,
) -> int:
    """The smallest number of events after which kinds and intervals repeat; 0 if none is found.

    Event j + p must be of the kind of event j, and the interval that follows it must equal the
    one after event j within ``tolerance`` of the mean interval, for all events: of the period it
    would let a long sequence on a torus, which comes back to nearly itself, pass. The sequence must
    hold three periods, so a period of more than a third of the events is not seen.

    Args:
        tolerance: largest difference of intervals, over the mean interval, and of states.
        states: (events, n) after each, over their ranges: what has no part in the events may
            move to another beat. Left out where the events decide all.
    """
    intervals, kinds = np.diff(times), kinds[:-1]
    marks = np.empty((len(times), 0)) if states is None else states
    lags = np.arange(1, intervals.size // Recurrence.least_repeats + 1)
    if not lags.size:
        return 0
    allowed = tolerance * intervals.mean()
    # the first interval alone leaves few lags to be checked in full
    likely = (kinds[lags] == kinds[0]) & (
        np.abs(intervals[lags] - intervals[0]) <= allowed
    )
    for lag in lags[likely]:
        if (
            (kinds[lag:] == kinds[:-lag]).all()
            and np.abs(intervals[lag:] - intervals[:-lag]).max() <= allowed
            and np.abs(marks[lag:] - marks[:-lag]).max(initial=0.0) <= tolerance
        ):
            return int(lag)
    return 0


def crossings(
    times: np.ndarray, path: np.ndarray, state: np.ndarray, normal: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Find when and where a sampled motion crosses a plane through a state forwards.

    Between samples the motion is taken as straight.

    Args:
        path: states at the times, (times, n).
    """
    height = (path - state) @ normal
    at = np.flatnonzero((height[:-1] < 0.0) & (height[1:] >= 0.0))
    share = -height[at] / (height[at + 1] - height[at])
    there = path[at] + share[:, None] * (path[at + 1] - path[at])
    return times[at] + share * (times[at + 1] - times[at]), there


def in_blocks(rows: np.ndarray, events: np.ndarray) -> Iterator[np.ndarray]:
    """Rows, so many at a time that their logs fit; the busiest first, so that few are wide."""
    rows = rows[np.argsort(-events[rows], kind="stable")]
    while rows.size:
        count = max(1, Recurrence.events_at_once // max(1, int(events[rows[0]])))
        yield rows[:count]
        rows = rows[count:]
