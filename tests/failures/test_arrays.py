"""One gate for arrays: whatever is no real number is refused with the argument's name."""

import math

import numpy as np
import pytest

from squealpipe import Parameters, simulate
from squealpipe.brake.linear.maps import stability_map
from squealpipe.validation import real_array
from tests.failures.fuzz import NO_ANGLES


@pytest.mark.parametrize("bad", NO_ANGLES)
def test_maps_refuse_what_is_no_real_number(bad):
    """One function for all: random calls try each of them with such arrays."""
    for name in ("alpha1", "alpha2"):
        with pytest.raises(ValueError, match=rf"^{name} "):
            stability_map(
                Parameters(), **{"alpha1": [0.3, 2.0], "alpha2": [0.3], name: bad}
            )


@pytest.mark.parametrize(
    "values", [[1, 2], np.float32([1, 2]), np.ma.masked_array([1.0, 2.0])]
)
def test_gate_lets_numbers_through(values):
    assert real_array("x", values).tolist() == [1.0, 2.0]
    assert real_array("x", [math.inf, 2], infinite=True).tolist() == [math.inf, 2.0]
    assert stability_map(Parameters(), 2, 1.0).alpha1.values.tolist() == [2.0]


@pytest.mark.parametrize(
    ("params", "t_end"),
    [
        (Parameters(k1=1e300), 10.0),
        (Parameters(mass=1e-300, k1=1e300), 10.0),
        (Parameters(mass=1e300, k1=1e-300), 10.0),
        (Parameters(), 1e10),
    ],
)
def test_run_of_too_many_time_units_is_refused_with_its_remedy(params, t_end):
    with pytest.raises(
        ValueError, match=r"time units .* shorten t_end, or give mass and k1"
    ):
        simulate(params, 2.0, 2.6, t_end=t_end, times=[0.0])


def test_huge_mass_ends_in_an_outcome_or_a_state():
    found = simulate(Parameters(mass=1e300), 2.0, 2.6, t_end=10.0)
    assert found.outcome != 0 or np.isfinite(found.x).all()
