"""What the linear levels know of a contact law: its slope at the preload, and its dashpot."""

from itertools import product

import numpy as np
import pytest

from squealpipe import Parameters, critical_friction_map, quasi_static_map, stability_map
from squealpipe.laws.springs import geometry, linear_stiffness
from tests.systems.test_own_laws import PAD, SOFTENING

ANGLES = np.array([0.4, 1.9]), np.array([0.7, 2.6])


@pytest.mark.parametrize(
    "laws", [{"contact_law": SOFTENING}, {"k3": 7e6, "contact_law": "dashpot", "damping3": 400.0}]
)
def test_growth_rates_are_those_of_the_matrix(laws):
    params = Parameters(**PAD, belt_speed=2.0, mu=0.4, **laws)
    k3 = params.k3 if "damping3" in laws else 6e6  # of the table: 120 N over 2e-5 m
    c3, mu, mass = params.damping3, params.mu, params.mass
    found = stability_map(params, *ANGLES)
    for angles, rate in zip(product(*ANGLES), found.growth_rate.values.ravel(), strict=True):
        k11, k12, k22 = linear_stiffness(params, geometry(*angles))
        stiffness = np.array([[k11, k12 + mu * k3], [k12, k22 + k3]])
        damping = np.array([[0.0, mu * c3], [0.0, c3]])
        matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness / mass, -damping / mass]])
        expected = np.linalg.eigvals(matrix).real.max()
        assert abs(rate - expected) < 1e-7 * np.sqrt(params.k1 / mass)


def test_static_states_have_the_force_of_the_table():
    params = Parameters(**PAD, belt_speed=2.0, mu=0.4, contact_law=SOFTENING)
    assert params.k3 * params.preload == pytest.approx(80.0, rel=1e-15)  # halfway from 20 to 140 N
    state = quasi_static_map(params, *ANGLES)
    force = 80.0 - 6e6 * state.y_static
    np.testing.assert_allclose(state.contact_force_static, force, rtol=1e-12)


def test_levels_that_cannot_carry_a_contact_law_say_so():
    params = Parameters(**PAD, belt_speed=2.0, mu=0.4, contact_law=SOFTENING)
    with pytest.raises(ValueError, match="critical friction is that of the linear contact"):
        critical_friction_map(params, *ANGLES)
    with pytest.raises(ValueError, match="regularizes the linear contact law alone"):
        stability_map(params, *ANGLES, sigma=1e3)
