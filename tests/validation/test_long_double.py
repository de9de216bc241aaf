"""Agreement with 80-bit integration and with scipy, and how the error follows the tolerance."""

import numpy as np
import pytest

from squealpipe.brake.a1.ensemble import run_ensemble
from tests.former import FORMER
from tests.oracles.a1_long_double import simulate_reference
from tests.oracles.a1_scipy import simulate_scipy

T_END = 50.0


@pytest.mark.parametrize("count", [12, pytest.param(40, marks=pytest.mark.release)])
@pytest.mark.parametrize(("speed", "seed"), [(100.0, 1), (0.3, 2)])
def test_states_events_and_first_separations(speed, seed, count):
    """Random angles, t = 50: state ≤ 1e-9 outside chaos, first separation ≤ 1e-11."""
    params = FORMER.with_(belt_speed=speed)
    alpha1, alpha2 = np.random.default_rng(seed).uniform(0, np.pi, (2, count))
    run = run_ensemble(
        params, alpha1, alpha2, t_end=T_END, tangent=True, log_events=100
    )
    total = run.separations + run.contacts + run.sticks + run.slips + run.reversals
    for job in range(alpha1.size):
        exact = simulate_reference(params, alpha1[job], alpha2[job], t_end=T_END)
        times = np.asarray(exact.event_times, float)
        assert total[job] == times.size
        if times.size:
            np.testing.assert_allclose(run.event_times[job, 0], times[0], atol=1e-11)
        if run.log_growth[job] < np.log(100):
            error = np.abs(run.final_state[job] - np.asarray(exact.state, float)).max()
            assert error < 1e-9


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
    np.testing.assert_allclose(
        public.event_times, np.float64(found.event_times), atol=1e-9
    )
    np.testing.assert_allclose(public.state, np.float64(found.state), atol=1e-10)


TOLERANCES = np.array([1e-5, 1e-7, 1e-9, 1e-11, 1e-13])


@pytest.mark.parametrize(
    ("speed", "angles", "kinds"),
    [
        (100.0, (5 / 6, 5 / 6), {0, 1}),
        (0.3, (0.45, 0.45), {0, 1, 2, 3, 4}),
        (0.3, (0.25, 0.15), {0, 1, 2, 3, 4}),
    ],
)
def test_error_follows_the_tolerance_through_events(speed, angles, kinds):
    """log error against log tolerance has slope 1, down to round-off."""
    params = FORMER.with_(belt_speed=speed)
    alpha = np.multiply(angles, np.pi)
    exact = np.asarray(simulate_reference(params, *alpha, t_end=20.0).state, float)
    runs = [
        run_ensemble(params, *alpha, t_end=20.0, tol=float(tol), log_events=40)
        for tol in TOLERANCES
    ]
    assert kinds <= set(runs[-1].event_kinds.tolist())
    errors = np.array([np.abs(run.final_state - exact).max() for run in runs])
    resolved = errors > 1e-13
    slope = np.polyfit(np.log(TOLERANCES[resolved]), np.log(errors[resolved]), 1)[0]
    assert slope == pytest.approx(1.0, abs=0.3)
    assert errors[-1] < 1e-11
