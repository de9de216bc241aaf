"""A3: nondimensional form, static state, eigenvalues and the plane of Z."""

import numpy as np
import pytest
import sympy as sp

from squealpipe.brake.models import a2, a3
from squealpipe.brake.models.a4 import spectrum
from squealpipe.laws.springs import geometry, linear_stiffness, stiffness_determinant
from tests import symbols

DRAWS = symbols.draws(40)


def stiffness_of(params, state):
    g = geometry(state["alpha1"], state["alpha2"])
    return linear_stiffness(params, g), stiffness_determinant(params, g)


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_nondimensional_form_is_the_linear_model_in_other_units(params, state):
    """x = l_pre X and t = τ/ω11 turn Eqs. (6), (7) into (13), (14)."""
    stiffness, _ = stiffness_of(params, state)
    expected = a2.acceleration(state["x"], state["y"], params, stiffness)
    unit = params.preload * stiffness.k11 / params.mass
    place = state["x"] / params.preload, state["y"] / params.preload
    groups = a3.groups(stiffness, params.k3)
    found = a3.acceleration(*place, groups, params.drag, params.k3 / stiffness.k11)
    np.testing.assert_allclose(np.array(found) * unit, expected, rtol=1e-12, atol=1e-12)


def test_jacobian_is_the_derivative_of_the_accelerations():
    x, y, mu, load, coupling, vertical, contact = sp.symbols("x y mu load c v k")
    ratios = a3.Groups(coupling, vertical, contact)
    accelerations = sp.Matrix(a3.acceleration(x, y, ratios, mu, load))
    difference = accelerations.jacobian([x, y]) - sp.Matrix(a3.jacobian(ratios, mu))
    assert sp.simplify(difference) == sp.zeros(2, 2)


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_static_state_is_at_rest(params, state):
    """Eq. (15) solves Eqs. (6), (7) without acceleration, for the sharp and the smooth law."""
    stiffness, determinant = stiffness_of(params, state)
    for sigma in (None, params.sigma):
        k3, load = a2.contact_stiffness(params, sigma), a2.actuation(params, sigma)
        x, y, force = a3.static_state(
            stiffness, determinant, k3=k3, mu=params.drag, actuation=load
        )
        np.testing.assert_allclose(
            a2.acceleration(x, y, params, stiffness, sigma),
            0.0,
            atol=1e-11 * (1 + abs(x) + abs(y)),
        )
        assert force == pytest.approx(load - k3 * y, rel=1e-9, abs=1e-11 * (1 + abs(y)))


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_the_plane_holds_the_stiffnesses_and_gives_the_angles_back(params, state):
    stiffness, determinant = stiffness_of(params, state)
    total = params.k1 + params.k2
    z = a3.plane(params, state["alpha1"], state["alpha2"])
    expected = [(total + z.real) / 2, z.imag / 2, (total - z.real) / 2]
    np.testing.assert_allclose(stiffness, expected, atol=1e-14 * total)
    assert determinant == pytest.approx(
        (total**2 - abs(z) ** 2) / 4, abs=1e-13 * total**2
    )
    alpha1, alpha2 = a3.angles_from_plane(z, params)
    np.testing.assert_allclose(a3.plane(params, alpha1, alpha2), z, atol=1e-12)
    distance = np.abs(alpha1 - state["alpha1"]) + np.abs(alpha2 - state["alpha2"])
    assert distance.min() < 1e-6


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_circles_in_the_plane_decide_as_the_invariants_do(params, state):
    stiffness, determinant = stiffness_of(params, state)
    invariants = spectrum(
        stiffness, determinant, k3=params.k3, mu=params.drag, mass=params.mass
    )
    z = a3.plane(params, state["alpha1"], state["alpha2"])
    centre, radius = a3.flutter_circle(params, params.k3)
    assert (abs(z - centre) < radius) == (invariants.discriminant < 0)
    centre, radius = a3.divergence_circle(params, params.k3)
    assert (abs(z - centre) > radius) == (invariants.determinant < 0)
