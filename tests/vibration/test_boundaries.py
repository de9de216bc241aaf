"""Quiet intervals against subjects whose growth and verdicts are written down."""

import math

import numpy as np
import pytest

from squealpipe.vibration.boundaries import (
    Cure,
    linear_intervals,
    nearest_boundary,
    quiet_intervals,
)


def cure_of(value, low=0.0, high=10.0, count=41):
    grid = np.linspace(low, high, count)
    return Cure(value, float, grid[grid < value][::-1], grid[grid > value])


def growth(value):
    """Small motions die out from 1 to 3, from 5 to 5.5 and from 8 on."""
    crossings = (1.0, 3.0, 5.0, 5.5, 8.0)
    return math.prod(crossing - value for crossing in crossings)


def always(value):
    return math.isfinite(value)


def found(value, is_quiet, count=41):
    cures = {"x": cure_of(value, count=count)}
    linear = {"x": linear_intervals(cures["x"], growth)}
    asked = []

    def test(cures, values):
        asked.extend(values)
        assert all(growth(value) <= 0.0 for value in values)
        return [is_quiet(value) for value in values]

    quiet = growth(value) <= 0.0 and is_quiet(value)
    intervals = quiet_intervals(cures, linear, test, quiet=quiet)["x"]
    return intervals, nearest_boundary(intervals, value, quiet=quiet), asked


def test_all_intervals_are_listed_the_nearest_first_and_exact_where_growth_decides():
    intervals, nearest, asked = found(4.2, always)
    ends = [(each.low, each.high) for each in intervals]
    assert np.allclose(ends, [(5.0, 5.5), (1.0, 3.0), (8.0, 10.0)], atol=1e-12)
    assert [each.high_open for each in intervals] == [False, False, True]
    assert nearest == pytest.approx(5.0, rel=1e-12)
    assert len(asked) < 30
    # no end is a value at which small motions grow
    assert all(growth(low) <= 0.0 and growth(high) <= 0.0 for low, high in ends)


def test_what_runs_find_noisy_beyond_the_linear_boundary_is_no_quiet_value():
    """A motion that lasts beside stable sliding up to 2.3 and from 2.8 on, and near 5."""
    intervals, nearest, _ = found(4.2, lambda x: 2.3 < x < 2.8 or x > 6.0)
    (second, first) = intervals[1], intervals[0]
    assert first.low == pytest.approx(2.3, rel=1e-3)
    assert first.high == pytest.approx(2.8, rel=1e-3)
    assert (second.low, second.high) == (pytest.approx(8.0, rel=1e-12), 10.0)
    assert nearest == first.high


def test_of_a_quiet_value_the_margin_is_the_nearer_end_of_its_interval():
    _, nearest, _ = found(2.4, always)
    assert nearest == pytest.approx(3.0, rel=1e-12)
    _, nearest, _ = found(2.4, lambda value: value > 1.9)
    assert nearest == pytest.approx(1.9, rel=1e-3)
    _, nearest, _ = found(9.7, always)
    assert nearest == pytest.approx(8.0, rel=1e-12)


def test_a_value_at_the_end_of_its_range_has_the_margin_on_its_other_side():
    """Friction 0, below which there is none."""
    cure = cure_of(0.0)
    linear = {"x": linear_intervals(cure, lambda value: value - 2.0)}
    intervals = quiet_intervals(
        {"x": cure}, linear, lambda _, values: [True] * len(values), quiet=True
    )["x"]
    nearest = nearest_boundary(intervals, 0.0, quiet=True)
    assert nearest == pytest.approx(2.0, rel=1e-12)


def test_growth_that_crosses_zero_twice_between_two_values_is_seen():
    cure = cure_of(2.0, count=21)

    def at(value):
        return 1e-3 - (value - 6.23) ** 2

    ends = [(each.low, each.high) for each in linear_intervals(cure, at)]
    half = math.sqrt(1e-3)
    assert np.allclose(ends, [(0.0, 6.23 - half), (6.23 + half, 10.0)], atol=1e-9)


def test_a_verdict_that_nothing_alters_has_no_boundary():
    cure = cure_of(2.0)
    intervals = linear_intervals(cure, lambda _: -1.0)
    (only,) = quiet_intervals(
        {"x": cure},
        {"x": intervals},
        lambda _, values: [True] * len(values),
        quiet=True,
    )["x"]
    assert (only.low, only.high) == (0.0, 10.0)
    assert math.isnan(nearest_boundary([only], 2.0, quiet=True))
    never = linear_intervals(cure, lambda _: 1.0)
    assert never == []
    assert math.isnan(nearest_boundary(never, 2.0, quiet=False))
