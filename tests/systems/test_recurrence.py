"""Sequences of events with and without a period."""

import numpy as np
import pytest

from squealpipe.systems.recurrence import repeats_after


def sequence(intervals, kinds, repeats):
    return np.cumsum(np.tile(intervals, repeats)), np.tile(kinds, repeats)


@pytest.mark.parametrize("lag", [1, 2, 5])
@pytest.mark.parametrize("repeats", [3, 12])
def test_the_smallest_period_is_found(lag, repeats):
    """Three whole periods suffice: as many intervals, and an event more."""
    rng = np.random.default_rng(lag)
    times, kinds = sequence(
        rng.uniform(0.5, 2.0, lag), rng.integers(0, 5, lag), repeats + 1
    )
    events = slice(lag * repeats + 1)
    assert repeats_after(times[events], kinds[events], 1e-6) == lag
    if repeats == 3:
        assert repeats_after(times[events][:-1], kinds[events][:-1], 1e-6) == 0


def test_what_has_no_period_within_the_tolerance_does_not_repeat():
    """Other kinds, a late offset, two tones, fewer than three periods, nothing."""
    steady, index = np.arange(24.0), np.arange(300)
    assert repeats_after(steady, np.tile([0, 1], 12), 1e-6) == 2
    # at even intervals kinds alone decide, though the second is that of the first
    assert repeats_after(steady, np.tile([0, 0, 1], 8), 1e-6) == 3
    assert repeats_after(steady, np.random.default_rng(1).permutation(24), 1e-6) == 0
    times, kinds = sequence([1.0, 2.0], [0, 1], 10)
    times[7:] += 1e-4
    assert [repeats_after(times, kinds, tol) for tol in (1e-3, 1e-6)] == [2, 0]
    tones = index + 0.2 * np.sin(np.sqrt(2.0) * index)
    for times, kinds in (
        (tones, 0 * index),
        sequence([1, 2, 4], [0, 1, 2], 3),
        ([], []),
    ):
        assert repeats_after(np.asarray(times), np.asarray(kinds, int), 1e-6) == 0
