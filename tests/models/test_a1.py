"""A1: accelerations from the symbolic energies in each regime, and the energy balance."""

import numpy as np
import pytest

from squealpipe.codes import Regime
from squealpipe.laws.springs import elastic_force, geometry
from squealpipe.models import a1
from tests import symbols
from tests.former import FORMER
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
def test_slip(params, state, direction, linear):
    force = (LINEAR_FORCE if linear else SPRING_FORCE)(params, **state)
    normal = CONTACT_FORCE(params, **state)
    expected = (force + normal * np.array([direction * params.mu, 1.0])) / params.mass
    found = acceleration(params, state, contact=1.0, direction=direction, linear_springs=linear)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_stick_keeps_the_belt_speed_and_leaves_y_alone(params, state):
    slip = acceleration(params, state, contact=1.0, direction=1.0)
    stick = acceleration(params, state, contact=1.0, direction=0.0, stick=1.0)
    assert stick[0] == 0.0
    assert stick[1] == slip[1]


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_separated_only_the_springs_act(params, state):
    found = acceleration(params, state, contact=0.0, direction=1.0)
    expected = SPRING_FORCE(params, **state) / params.mass
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
    here = np.array([state["x"], state["y"], vx, vy])
    rate = np.array([vx, vy, ax, ay])

    def energy(step):
        moved = here + step * rate
        return float(mechanical_energy(*moved, params, g, contact))

    step = 1e-4
    # Fourth-order difference: truncation and round-off are both far below the tolerance.
    slope = (8 * (energy(step) - energy(-step)) - (energy(2 * step) - energy(-2 * step))) / (
        12 * step
    )
    elastic_x, _ = elastic_force(state["x"], state["y"], params, g)
    normal = contact * float(CONTACT_FORCE(params, **state))
    power = friction_power(vx, elastic_x, normal, params, direction, stick)
    assert slope == pytest.approx(power, rel=1e-7, abs=1e-7)


def test_mirror_images_move_alike():
    """Equal springs: (α1, α2, V) and (π − α2, π − α1, V) are one system, and −x gives (α2, α1)."""
    params, state = FORMER, {"x": 0.7, "y": -0.4}
    here = acceleration(params, {**state, "alpha1": 0.3, "alpha2": 1.9}, contact=1.0, direction=1.0)
    same = acceleration(
        params, {**state, "alpha1": np.pi - 1.9, "alpha2": np.pi - 0.3}, contact=1.0, direction=1.0
    )
    np.testing.assert_allclose(same, here, rtol=1e-13)
    mirrored = {"x": -0.7, "y": -0.4, "alpha1": 1.9, "alpha2": 0.3}
    reversed_ = acceleration(params, mirrored, contact=1.0, direction=-1.0)
    np.testing.assert_allclose(reversed_, here * [-1, 1], rtol=1e-13)
