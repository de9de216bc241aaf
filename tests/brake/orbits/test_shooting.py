"""Derivatives, reversibility and monodromy of the shots."""

import math
from functools import partial

import numpy as np
import pytest

from squealpipe.brake.a4.system import scaled_system
from squealpipe.brake.orbits.orbits import solve_orbit
from squealpipe.brake.orbits.shooting import rest_conditions, shoot, shooting_limits
from tests.former import FORMER
from tests.oracles.differences import assert_jacobian

SCENES = [
    (0.3, 0.9, -0.9, 2.7, 4.9),
    (0.2, 0.7, -0.5, 3.2, 9.0),
    (0.5, 1.0, 0.1, 2.2, 2.6),
]


def _conditions(rows, point):
    values, jacobian = np.empty(2), np.empty((2, 3))
    work = np.empty((shooting_limits.segments, 9)), np.empty(shooting_limits.segments)
    rest_conditions(rows, point.copy(), *work, values, jacobian, np.empty(4))
    return values, jacobian


@pytest.mark.parametrize("scene", SCENES)
def test_derivatives_agree_with_differences(scene):
    rows = scaled_system(FORMER, scene[0] * math.pi, scene[1] * math.pi).system.rows
    point = np.array(scene[2:])
    assert_jacobian(partial(_conditions, rows), point, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("scene", SCENES)
def test_flow_runs_backwards_by_turning_velocities(scene):
    """From the state after half a period, velocities turned, the start comes back."""
    system = scaled_system(FORMER, scene[0] * math.pi, scene[1] * math.pi).system
    rows, found = system.rows, solve_orbit(system, np.array(scene[2:]))
    final, again = np.empty(4), np.empty(4)
    work = np.empty((shooting_limits.segments, 9)), np.empty(shooting_limits.segments)
    shoot(rows, *found.point, *work, final)
    shoot(rows, final[0], final[1], found.point[2], *work, again)
    np.testing.assert_allclose(again[:2], found.point[:2], atol=1e-13)
    np.testing.assert_allclose(again[2:], 0.0, atol=1e-13)
