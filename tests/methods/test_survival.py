"""Survival against closed forms, hand counts and their own coverage."""

import numpy as np

from squealpipe.methods.survival import survival


def test_without_cut_off_it_is_the_empirical_share() -> None:
    found = survival(np.array([3.0, 1.0, 2.0, 4.0]), np.ones(4, bool))
    np.testing.assert_array_equal(found.time, [0.0, 1.0, 2.0, 3.0, 4.0])
    np.testing.assert_allclose(found.share, [1.0, 0.75, 0.5, 0.25, 0.0])
    assert np.isfinite(found.low).all()
    assert np.isfinite(found.high).all()
    assert (found.low <= found.share).all()
    assert (found.share <= found.high).all()


def test_kaplan_and_meier_by_hand() -> None:
    """Ends at 1, 3 and 6, cut off at 2 and 5: 1 − 1/5, then × (1 − 1/3), then × (1 − 1/1)."""
    found = survival(
        np.array([1.0, 2.0, 3.0, 5.0, 6.0]), np.array([True, False, True, False, True])
    )
    share, _, _ = found.at(np.array([0.5, 1.0, 2.5, 3.0, 5.5, 6.0]))
    np.testing.assert_allclose(share, [1.0, 0.8, 0.8, 0.8 * 2 / 3, 0.8 * 2 / 3, 0.0])


def test_nothing_ended() -> None:
    found = survival(np.full(5, 7.0), np.zeros(5, bool))
    assert found.median() == (np.inf, np.inf, np.inf)


def test_median_counts_runs_that_were_cut_off() -> None:
    times = np.minimum(np.arange(1.0, 101.0), 60.0)
    seen = np.arange(1.0, 101.0) <= 60.0
    middle, low, high = survival(times, seen).median()
    assert middle == 50.0
    assert 35.0 < low < middle < high
    assert np.median(times[seen]) < low


def test_intervals_cover_what_they_should() -> None:
    """Exponential lifetimes, some cut off: median within its 95 % interval."""
    rng = np.random.default_rng(5)
    inside = 0
    for _ in range(400):
        lives = rng.exponential(1.0, 80)
        seen = lives < 2.0
        times = np.minimum(lives, 2.0)
        _, low, high = survival(times, seen).median()
        inside += low <= np.log(2.0) <= high
    assert 0.92 < inside / 400 < 0.995
