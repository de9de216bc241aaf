"""Moreau–Jean stepping against closed forms: order, stick, and the compiled laws."""

import numpy as np
import pytest

from squealpipe.laws.springs import elastic_force, geometry
from squealpipe.methods.time_stepping import jitted, step_through
from squealpipe.models.a1_automaton import PlainParameters
from tests.former import FORMER


def oscillator(x, y, data):
    return -x, -y, 0.0 * x


def slider(x, y, data):
    return -x, 0.0 * y, data


@pytest.mark.parametrize("steps", [100])
def test_smooth_motion_converges_at_second_order(steps: int) -> None:
    forces = jitted(oscillator)
    errors = []
    for n in (steps, 2 * steps):
        state = np.array([1.0, 0.0, 0.0, 0.0])
        step_through(forces, 0.0, 1.0, 0.0, state, 3.0 / n, n, False)
        errors.append(abs(state[0] - np.cos(3.0)))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


def test_stick_is_exact_until_the_bound_is_met() -> None:
    """x = V t sticks while |x| ≤ μN; velocities within the bound are projected exactly."""
    state = np.array([0.0, 0.0, 0.1, 0.0])
    step_through(jitted(slider), 0.2, 1.0, 0.1, state, 1e-3, 1900, False)
    assert state[2] == 0.1
    assert state[0] == pytest.approx(0.19, abs=1e-12)
    step_through(jitted(slider), 0.2, 1.0, 0.1, state, 1e-3, 1100, False)
    # released at t = 2 with x = 0.2: x = 0.2 + 0.1 sin(t − 2)
    assert state[0] == pytest.approx(0.2 + 0.1 * np.sin(1.0), abs=1e-4)


def test_compiled_laws_are_the_laws() -> None:
    params = FORMER.with_(length1=3.0)
    record = PlainParameters(**params.as_dict())
    g = geometry(0.7, 2.1)
    expected = elastic_force(0.3, -0.4, params, g)
    assert jitted(elastic_force)(0.3, -0.4, record, g) == pytest.approx(expected, rel=1e-15)
