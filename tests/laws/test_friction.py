"""Coulomb friction: direction, sticking, and the regularized form."""

from __future__ import annotations

import numpy as np
import pytest

from squealpipe.laws import friction
from squealpipe.parameters import Parameters

PARAMS = Parameters(mu=0.4, belt_speed=2.0)


@pytest.mark.parametrize(("vx", "expected"), [(0.0, 2.0), (1.9, 2.0), (2.1, -2.0), (-5.0, 2.0)])
def test_the_belt_drags_the_mass_along(vx: float, expected: float) -> None:
    direction = np.sign(PARAMS.belt_speed - vx)
    assert friction.slip_force(5.0, direction, PARAMS) == pytest.approx(expected)


def test_friction_does_work_towards_belt_speed() -> None:
    for vx in (-1.0, 1.0, 3.0):
        force = friction.slip_force(1.0, np.sign(PARAMS.belt_speed - vx), PARAMS)
        assert force * (PARAMS.belt_speed - vx) > 0


def test_sticking_needs_a_force_inside_the_cone() -> None:
    forces = np.array([-2.1, -2.0, 0.0, 1.99, 2.01])
    possible = friction.stick_possible(forces, 5.0, PARAMS)
    np.testing.assert_array_equal(possible, [False, True, True, True, False])


def test_regularized_friction_agrees_away_from_belt_speed_and_vanishes_there() -> None:
    vx = np.array([1.0, 2.0, 3.0])
    force = friction.regularized_slip_force(5.0, vx, PARAMS, 50.0)
    np.testing.assert_allclose(force, [2.0, 0.0, -2.0], atol=1e-12)
