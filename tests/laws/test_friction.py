"""Coulomb friction: its direction, and where it keeps it."""

import numpy as np
import pytest

from squealpipe.laws import friction, friction_laws
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


@pytest.mark.parametrize("law", friction_laws.LAWS)
def test_the_slope_of_a_law_is_its_derivative(law):
    params = PARAMS.with_(friction_law=law, mu_static=0.7, friction_speed=1.5)
    speeds = np.array([0.0, 0.4, 1.5, 6.0])
    step = 1e-30  # the imaginary part over a tiny step is the exact derivative
    exact = np.imag(friction_laws.coefficient(speeds + 1j * step, params)) / step
    slopes = friction_laws.slope(speeds, params)
    np.testing.assert_allclose(*np.broadcast_arrays(slopes, exact), rtol=1e-14)
