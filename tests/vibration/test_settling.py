"""When windows of a run agree, against signals whose growth and mean are known."""

import math

import numpy as np
import pytest

from squealpipe.vibration.settling import (
    Agreement,
    WindowLevels,
    agreement,
    late_growth,
    settling_of_numbers,
    settling_of_verdicts,
    tapered,
)


def levels(velocities, *, peak=1.0, growth=0.0, late=0.0, periods=800.0, separated=0.2):
    one = np.array([separated]), np.array([0.1]), np.array([peak])
    return WindowLevels(np.array(velocities), *one, growth, late, periods)


@pytest.mark.parametrize(
    ("before", "now", "shown"),
    [
        ({}, {}, Agreement.regular),
        # what grows beneath a loud line: nothing else has changed yet
        ({"growth": 0.2, "late": 0.1}, {"growth": 0.6, "late": 0.2}, Agreement.none),
        # a shear grows like time
        (
            {"growth": 6.0, "late": 0.34},
            {"growth": 6.7, "late": 0.34},
            Agreement.regular,
        ),
        # growth doubles with the window, though a first swing hides that in all of it
        ({"growth": 2.0, "late": 0.1}, {"growth": 0.4, "late": 0.2}, Agreement.none),
        # what decays has left the mean squares long before the largest force
        ({"peak": 1.02}, {"peak": 1.0}, Agreement.none),
        # round-off has become motion: the largest force is chance
        (
            {"growth": 20.0, "late": 5.0, "peak": 1.3, "separated": 0.21},
            {"growth": 40.0, "late": 10.0},
            Agreement.irregular,
        ),
        ({"separated": 0.2}, {"separated": 0.202}, Agreement.none),
        ({"periods": 100.0}, {"periods": 200.0}, Agreement.none),
    ],
)
def test_windows_agree_only_if_nothing_grows_or_decays(before, now, shown):
    pair = levels([1.0, 0.2], **before), levels([1.0, 0.2], **now)
    assert agreement(*pair, settling_of_numbers) is shown


def test_a_component_that_grows_is_seen_beneath_a_loud_one():
    before, now = levels([1.0, 1e-3]), levels([1.0, 2e-3])
    for rules in (settling_of_verdicts, settling_of_numbers):
        assert agreement(before, now, rules) is Agreement.none
    silent = levels([1.0, 0.0]), levels([1.0, 1e-12])
    assert agreement(*silent, settling_of_verdicts) is Agreement.regular


@pytest.mark.parametrize("periods", [20.3, 51.7, 173.45])
def test_the_tapered_mean_of_a_periodic_square_is_that_of_whole_periods(periods):
    """It misses 1/2 by less than the cube of the periods tells, a plain mean by 1/(4 π n)."""
    phase = 2.0 * math.pi * periods * (np.arange(4096) + 0.5) / 4096
    square = np.sin(phase) ** 2
    assert abs(float(tapered(square)) - 0.5) < 0.25 / periods**3
    assert abs(square.mean() - 0.5) > 1e-4


def test_late_growth_of_an_exponential_and_of_a_shear():
    time = (np.arange(4000) + 0.5) / 4000
    assert float(late_growth(3.2 * time)) == pytest.approx(0.8, rel=1e-6)
    shear = np.log(1e6 * time)
    truth = math.log(7.0 / 5.0)
    assert float(late_growth(shear)) == pytest.approx(truth, rel=0.02)
