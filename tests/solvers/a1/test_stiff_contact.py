"""Stiff contacts stick and release: the friction limit is the largest term of the stick margin."""

import numpy as np
import pytest

from squealpipe.schema import Outcome
from squealpipe.solvers.a1.ensemble import run_ensemble
from tests.former import FORMER
from tests.oracles.a1_long_double import simulate_reference

COUNT = 40


def runs(kappa):
    """Unequal springs on slow belts of both directions."""
    rng = np.random.default_rng(5)
    parameters = {
        "k2": rng.uniform(0.5, 2, COUNT),
        "k3": np.full(COUNT, kappa),
        "mu": rng.uniform(0.05, 0.8, COUNT),
        "belt_speed": rng.choice([-1, 1], COUNT) * rng.uniform(0.05, 1.0, COUNT),
        "length1": rng.uniform(2, 8, COUNT),
        "length2": rng.uniform(2, 8, COUNT),
    }
    return parameters, rng.uniform(0, np.pi, (2, COUNT))


@pytest.mark.parametrize("kappa", [5e4, 1e6, 1e8])
def test_no_run_ends_in_steps_of_length_zero(kappa):
    parameters, angles = runs(kappa)
    found = run_ensemble(parameters, *angles, t_end=20.0)
    assert (found.outcome == Outcome.converged).all()
    assert found.slips.sum() > 200
    assert found.steps.max() < 2000


def test_releases_are_where_long_double_has_them():
    """First releases of contacts 1e5 times as stiff as the springs, to the round-off of y k3."""
    parameters, angles = runs(1e5)
    found = run_ensemble(parameters, *angles, t_end=2.0, log_events=4)
    judged = 0
    for job in range(10):
        params = FORMER.with_(**{name: float(values[job]) for name, values in parameters.items()})
        exact = simulate_reference(params, *map(float, angles[:, job]), t_end=2.0)
        count = min(4, len(exact.event_times))
        np.testing.assert_allclose(
            found.event_times[job, :count], np.float64(exact.event_times[:count]), atol=1e-7
        )
        judged += count
    assert judged >= 20
