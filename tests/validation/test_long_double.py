"""Agreement with 80-bit integration and with scipy, both with switching rules of their own."""

import numpy as np
import pytest

from squealpipe.solvers.a1.ensemble import run_ensemble
from tests.former import FORMER
from tests.oracles.a1_long_double import simulate_reference

T_END = 50.0


@pytest.mark.parametrize(("speed", "seed"), [(100.0, 1), (0.3, 2)])
def test_states_events_and_first_separations(speed, seed):
    """Random angles, t = 50: state ≤ 1e-9 outside chaos, first separation ≤ 1e-11."""
    params = FORMER.with_(belt_speed=speed)
    alpha1, alpha2 = np.random.default_rng(seed).uniform(0, np.pi, (2, 40))
    run = run_ensemble(params, alpha1, alpha2, t_end=T_END, tangent=True, log_events=100)
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
