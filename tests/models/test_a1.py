"""A1: accelerations from the symbolic energies in each regime, and the energy balance."""

import numpy as np
import pytest

from squealpipe.codes import Regime
from squealpipe.laws.springs import elastic_force, geometry
from squealpipe.models import a1
from tests import symbols
from tests.oracles.energy import friction_power, mechanical_energy

DRAWS = symbols.draws(30)
SPRING_FORCE = symbols.function(symbols.SPRING_FORCE)
LINEAR_FORCE = symbols.function(symbols.LINEAR_FORCE)
CONTACT_FORCE = symbols.function(symbols.CONTACT_FORCE)


def acceleration(params, state, velocity=(0.3, -0.2), **regime):
    g = geometry(state["alpha1"], state["alpha2"])
    return np.array(a1.acceleration(state["x"], state["y"], *velocity, params, g, **regime))


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
        found = acceleration(params, state, **regime, linear_springs=linear)
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("params", "state"), DRAWS)
@pytest.mark.parametrize("regime", Regime)
def test_energy_changes_by_the_power_of_friction(params, state, regime):
    """dE/dt along the flow, by a central difference over the flow's tangent."""
    g = geometry(state["alpha1"], state["alpha2"])
    sticking = regime is Regime.stick
    contact = float(regime is not Regime.separated)
    direction = {Regime.slip_slower: 1.0, Regime.slip_faster: -1.0}.get(regime, 0.0)
    vx = params.belt_speed if sticking else params.belt_speed - (direction or 1.0)
    vy = 0.7
    stick = float(sticking)
    ax, ay = acceleration(params, state, contact=contact, direction=direction, stick=stick)
    step, here = 1e-4, np.array([state["x"], state["y"], vx, vy])
    moved = here + step * np.outer([-2, -1, 1, 2], [vx, vy, ax, ay])
    # Fourth-order difference: truncation and round-off are both far below the tolerance.
    slope = [1, -8, 8, -1] @ mechanical_energy(*moved.T, params, g, contact) / (12 * step)
    elastic_x, _ = elastic_force(state["x"], state["y"], params, g)
    normal = contact * float(CONTACT_FORCE(params, **state))
    power = friction_power(vx, elastic_x, normal, params, direction, stick)
    assert slope == pytest.approx(power, rel=1e-7, abs=1e-7)
