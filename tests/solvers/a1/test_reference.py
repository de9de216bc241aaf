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


def test_reference_is_long_double():
    """At rest from y = 0 the first separation has a closed form for K = diag(k, k), L → ∞."""
    params = FORMER.with_(k3=2.0, mu=0.0, length1=1e12, length2=1e12)
    run = simulate_reference(params, np.pi / 2, np.pi, t_end=2.0)
    assert run.state.dtype == np.longdouble
    assert float(run.event_times[0]) == pytest.approx(np.arccos(-0.5) / np.sqrt(3.0), abs=1e-6)


@pytest.mark.parametrize(("initial", "first"), [((0, 1, 0, 0.5), 3), ((0, 1, 0, -0.5), 0)])
def test_a_start_on_the_threshold_goes_where_its_velocity_points(initial, first):
    params = FORMER
    for run in (
        simulate_reference(params, 0.9, 2.0, t_end=3.0, initial_state=initial),
        simulate_scipy(params, 0.9, 2.0, t_end=3.0, tol=1e-10, initial_state=initial),
    ):
        assert run.regimes[0] == first
