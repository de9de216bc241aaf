"""A1: accelerations from the symbolic energies in each regime."""

import numpy as np
import pytest

from squealpipe.brake.models import a1
from squealpipe.laws.springs import geometry
from tests import symbols

DRAWS = symbols.draws(30)
SPRING_FORCE = symbols.function(symbols.SPRING_FORCE)
LINEAR_FORCE = symbols.function(symbols.LINEAR_FORCE)
CONTACT_FORCE = symbols.function(symbols.CONTACT_FORCE)


def acceleration(params, state, velocity=(0.3, -0.2), **regime):
    g = geometry(state["alpha1"], state["alpha2"])
    return np.array(
        a1.acceleration(
            a1.State(state["x"], state["y"], *velocity), params, g, **regime
        )
    )


@pytest.mark.parametrize(("params", "state"), DRAWS)
@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("linear", [False, True])
def test_acceleration_in_each_regime(params, state, direction, linear):
    """Stick keeps the belt speed and leaves y alone; separated only the springs act."""
    force = (LINEAR_FORCE if linear else SPRING_FORCE)(params, **state)
    normal = CONTACT_FORCE(params, **state)
    slip = (force + normal * np.array([direction * params.mu, 1.0])) / params.mass
    for expected, regime in (
        (slip, {"contact": 1.0, "direction": direction}),
        ([0.0, slip[1]], {"contact": 1.0, "direction": 0.0, "stick": 1.0}),
        (force / params.mass, {"contact": 0.0, "direction": direction}),
    ):
        found = acceleration(params, state, **regime, form=a1.Suspension(linear))
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
