"""Sequences of events with and without a period."""

import numpy as np
import pytest

from squealpipe.methods.recurrence import repeats_after


def sequence(intervals, kinds, repeats):
    return np.cumsum(np.tile(intervals, repeats)), np.tile(kinds, repeats)


@pytest.mark.parametrize("lag", [1, 2, 5])
def test_the_smallest_period_is_found(lag):
    rng = np.random.default_rng(lag)
    times, kinds = sequence(rng.uniform(0.5, 2.0, lag), rng.integers(0, 5, lag), 12)
    assert repeats_after(times, kinds, 1e-6) == lag


def test_kinds_must_repeat_too():
    times = np.arange(24.0)
    assert repeats_after(times, np.tile([0, 1], 12), 1e-6) == 2
    assert repeats_after(times, np.random.default_rng(1).permutation(24), 1e-6) == 0


def test_tolerance_decides():
    times, kinds = sequence([1.0, 2.0], [0, 1], 10)
    times[7:] += 1e-4
    assert repeats_after(times, kinds, 1e-3) == 2
    assert repeats_after(times, kinds, 1e-6) == 0


def test_two_tones_do_not_repeat():
    index = np.arange(300)
    times = index + 0.2 * np.sin(np.sqrt(2.0) * index)
    assert repeats_after(times, np.zeros(300, int), 1e-6) == 0


def test_fewer_than_three_periods_are_no_repetition():
    times, kinds = sequence([1.0, 2.0, 4.0], [0, 1, 2], 3)
    assert repeats_after(times, kinds, 1e-6) == 0
    assert repeats_after(np.zeros(0), np.zeros(0, int), 1e-6) == 0
