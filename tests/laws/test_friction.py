"""Coulomb friction: its direction, and where it keeps it."""

import numpy as np
import pytest

from squealpipe.laws import friction
from squealpipe.parameters import Parameters

PARAMS = Parameters(mu=0.4, belt_speed=2.0)


@pytest.mark.parametrize(
    ("vx", "expected"), [(0.0, 2.0), (1.9, 2.0), (2.1, -2.0), (-5.0, 2.0)]
)
def test_the_belt_drags_the_mass_along(vx, expected):
    """So friction does work towards belt speed."""
    slip = PARAMS.belt_speed - vx
    force = friction.slip_force(5.0, np.sign(slip), PARAMS.mu)
    assert force == pytest.approx(expected)
    assert force * slip > 0


@pytest.mark.parametrize("belt_speed", [2.0, -2.0])
def test_sliding_is_judged_along_the_belt(belt_speed):
    """Friction keeps its sign along a motion exactly where ``slides`` says so."""
    params = PARAMS.with_(belt_speed=belt_speed)
    phase = np.linspace(0.0, 2.0 * np.pi, 1001)
    for mean, amplitude in (
        (0.0, 1.9),
        (0.0, 2.1),
        (-0.5, 2.4),
        (0.5, 2.4),
        (1.5, 0.4),
    ):
        vx = mean + amplitude * np.sin(phase)
        keeps_its_sign = np.unique(np.sign(params.belt_speed - vx)).size == 1
        speed = (params.belt_direction * vx).max()
        assert friction.slides(speed, params) == keeps_its_sign
