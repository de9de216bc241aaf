"""Closed-form A4 trajectories against our time integration of A4."""

import numpy as np
import pytest

from squealpipe.methods.orbits.modal_trajectory import trajectory_from_rest
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.solvers.a4.system import scaled_system
from tests.former import FORMER


@pytest.mark.parametrize("over_pi", [(0.3, 0.9), (0.83, 0.83), (0.5, 1.0), (0.1, 0.35)])
def test_flow_from_switch_to_switch_is_the_integrated_motion(over_pi: tuple[float, float]) -> None:
    params = FORMER
    alpha1, alpha2 = np.pi * np.array(over_pi)
    times = np.linspace(0.0, 25.0, 51)
    scene = scaled_system(params, alpha1, alpha2)
    states = np.empty((len(times), 4))
    switches = trajectory_from_rest(scene.system.rows, times * scene.frequency, states)
    run = run_ensemble(params, alpha1, alpha2, t_end=25.0, model="A4", times=times, workers=1)
    assert switches == run.separations + run.contacts
    positions = states[1:, :2] * scene.length
    np.testing.assert_allclose(positions, run.samples[1:, :2], atol=1e-9)
