"""The ladder's levels against one another, and what choosing saves."""

import numpy as np
import pytest

from squealpipe.brake.ladder.ladder import model_ladder
from squealpipe.brake.linear.maps import stability_map
from squealpipe.brake.schema.ladder import Level
from squealpipe.codes import LinearRegime
from squealpipe.parameters import Parameters
from tests.former import FORMER

PARAMS = Parameters()


@pytest.fixture(scope="module")
def ladder():
    return model_ladder(PARAMS, 14, 0.05, t_end=100.0)


def test_a1_is_adequate_everywhere_and_errs_nowhere(ladder):
    assert not ladder.error.sel(level="a1").any()
    assert (ladder.cheapest <= Level.a1).all()


def test_a_linear_level_answers_nothing_where_nothing_oscillates(ladder):
    linear = stability_map(PARAMS, ladder.alpha1, ladder.alpha2).regime_linear
    grows = linear != LinearRegime.stable
    assert 0 < grows.sum() < grows.size
    assert (np.isinf(ladder.error.sel(level="a3")) == grows).all()


def test_without_stick_a1_is_the_same_when_the_belt_is_never_reached(ladder):
    assert float(ladder.error.sel(level="a1_no_stick").max()) < 1e-6


def test_what_is_chosen_is_right_and_below_a1_in_some_cells(ladder):
    assert not ladder.chosen_wrong.any()
    assert float((ladder.chosen != Level.a1).mean()) > 0.05
    for name in ("always_cpu_time", "chosen_cpu_time"):
        assert ladder[name] > 0.0
        assert ladder[name].attrs["volatile"] == "true"


def test_a_level_counts_only_where_what_it_drops_mattered(ladder):
    """At V = 100 the belt is never reached; at V = 0.3 it is, and stick matters in some cells."""
    assert not ladder.belt_reached.any()
    assert not (ladder.cheapest == Level.a1_no_stick).any()
    slow = model_ladder(FORMER.with_(belt_speed=0.3), 8, 0.05, t_end=40.0)
    assert slow.belt_reached.any()
    used = (slow.cheapest == Level.a1_no_stick).any("question")
    assert not (used & ~slow.belt_reached).any()


@pytest.mark.parametrize("speed", [0.4, 50.0])
def test_a_reversed_belt_and_its_mirror_image_have_the_same_ladder(speed):
    params = FORMER.with_(k2=1.4, length2=9.0, mu=0.45, belt_speed=speed)
    image = FORMER.with_(k1=1.4, length1=9.0, mu=0.45, belt_speed=-speed)
    # both horizons are the same, √(m/k1) is not
    here = model_ladder(params, 6, 0.05, t_end=60.0)
    there = model_ladder(image, 6, 0.05, t_end=60.0)
    for name in ("cheapest", "chosen", "belt_reached"):
        swapped = there[name].transpose(..., "alpha2", "alpha1").values
        np.testing.assert_array_equal(here[name].values, swapped, err_msg=name)


def test_extensions_are_refused():
    with pytest.raises(ValueError, match="damping1"):
        model_ladder(FORMER.with_(damping1=0.1), 2, 0.05, t_end=1.0)


def test_a_short_unit_of_time_is_no_long_run():
    """The run that compiles is a share of the horizon, not one second."""
    params = FORMER.with_(belt_speed=1.0)
    fast = params.with_(mass=1e-20, belt_speed=1e10)
    one = model_ladder(params, 3, 0.05, t_end=20.0)
    other = model_ladder(fast, 3, 0.05, t_end=20.0 * fast.time_unit)
    np.testing.assert_array_equal(one.chosen, other.chosen)
