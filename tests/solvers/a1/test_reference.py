"""The long-double reference against scipy, which shares no integrator with it."""

import numpy as np
import pytest

from tests.former import FORMER
from tests.oracles.a1_long_double import simulate_reference
from tests.oracles.a1_scipy import simulate_scipy


@pytest.mark.parametrize(
    ("angles", "speed"),
    [((0.5, 1.0), 100.0), ((1.0, 1.0), 100.0), ((0.3, 0.9), 0.05), ((0.4, 0.6), 100.0)],
    ids=["smooth", "hammering", "stick-slip", "whirl"],
)
def test_reference_agrees_with_scipy_at_its_limit(angles, speed):
    params = FORMER.with_(belt_speed=speed)
    found = simulate_reference(params, *np.pi * np.array(angles), t_end=30.0)
    public = simulate_scipy(params, *np.pi * np.array(angles), t_end=30.0, tol=1e-13)
    assert found.message == ""
    assert found.event_kinds == public.event_kinds
    assert found.regimes == public.regimes
    np.testing.assert_allclose(public.event_times, np.float64(found.event_times), atol=1e-9)
    np.testing.assert_allclose(public.state, np.float64(found.state), atol=1e-10)
