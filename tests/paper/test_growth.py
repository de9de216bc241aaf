"""Growth without bound is judged by the end of a long run."""

import numpy as np
import pytest

from squealpipe.paper.schema.growth import (
    Growth,
    growth_fails,
    growth_margin,
    judge_growth,
)

SQUARE_ROOT = np.sqrt(np.arange(1.0, 7.0))
WHIRL = np.array([19.9, 90.5, 90.8, 90.4, 90.4, 90.4])


@pytest.mark.parametrize(
    ("sizes", "growth"),
    [
        (1000.0 * SQUARE_ROOT, Growth.grows),
        (WHIRL, Growth.saturates),
        ([1.0, 2.0, 4.0, 8.0, 8.1, 9.0], Growth.undecided),
        ([5.0, 9.0, 9.0, 8.0, 9.0, 8.5], Growth.undecided),
        ([1.0, 1.0, 1.0, 1.0, 1.01, 1.02], Growth.saturates),
    ],
)
def test_what_a_long_run_says(sizes, growth):
    assert judge_growth(sizes) == growth


def test_the_margin_has_the_sign_of_the_verdict():
    """√T grows by √(6/5) in the last of six windows; one window that falls short settles it."""
    short = np.array([1.0, 2.0, 4.0, 4.1, np.nan, np.nan])
    sizes = np.stack([SQUARE_ROOT, WHIRL, [1, 2, 4, 8, 8.1, 9], short])
    margins = growth_margin(sizes)
    assert margins[0] == pytest.approx(np.log(np.sqrt(1.2) / 1.05), rel=1e-12)
    assert (margins[1:] < 0).all()
    np.testing.assert_array_equal(growth_fails(sizes), [False, True, True, True])
    assert np.isnan(growth_margin(np.full(6, np.nan)))
