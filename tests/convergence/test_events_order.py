"""Error against tolerance, through located events."""

import numpy as np
import pytest

from squealpipe.solvers.a1.ensemble import run_ensemble
from tests.former import FORMER
from tests.oracles.a1_long_double import simulate_reference

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
