"""A3: nondimensional form, static state, eigenvalues and the plane of Z."""

import numpy as np
import pytest
import scipy.linalg
import sympy as sp

from squealpipe.codes import LinearRegime
from squealpipe.laws.springs import geometry, linear_stiffness, stiffness_determinant
from squealpipe.models import a2, a3
from squealpipe.models.a4 import spectrum
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
    found = a3.acceleration(
        state["x"] / params.preload,
        state["y"] / params.preload,
        a3.groups(stiffness, params.k3),
        params.drag,
        params.k3 / stiffness.k11,
    )
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
        x, y, force = a3.static_state(stiffness, determinant, k3=k3, mu=params.drag, actuation=load)
        np.testing.assert_allclose(
            a2.acceleration(x, y, params, stiffness, sigma), 0.0, atol=1e-11 * (1 + abs(x) + abs(y))
        )
        assert force == pytest.approx(load - k3 * y, rel=1e-9, abs=1e-11 * (1 + abs(y)))


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_eigenvalues_are_those_of_the_first_order_system(params, state):
    stiffness, determinant = stiffness_of(params, state)
    invariants = spectrum(stiffness, determinant, k3=params.k3, mu=params.mu, mass=params.mass)
    rows = np.array(
        [
            [stiffness.k11, stiffness.k12 + params.mu * params.k3],
            [stiffness.k12, stiffness.k22 + params.k3],
        ]
    )
    block = np.block([[np.zeros((2, 2)), np.eye(2)], [-rows / params.mass, np.zeros((2, 2))]])
    numeric = scipy.linalg.eigvals(block)
    own = np.array([s for pair in a3.eigenvalues(invariants) for s in (pair, -pair)])
    own = np.concatenate([own, own.conj()])
    for value in numeric:
        assert np.abs(own - value).min() < 1e-7 * np.abs(numeric).max()
    growth = numeric.real.max()
    assert bool(a3.regime(invariants) != LinearRegime.stable) == (growth > 1e-6)


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_the_plane_holds_the_stiffnesses(params, state):
    stiffness, determinant = stiffness_of(params, state)
    total = params.k1 + params.k2
    z = a3.plane(params, state["alpha1"], state["alpha2"])
    np.testing.assert_allclose(
        [stiffness.k11, stiffness.k22, stiffness.k12],
        [(total + z.real) / 2, (total - z.real) / 2, z.imag / 2],
        atol=1e-14 * total,
    )
    assert determinant == pytest.approx((total**2 - abs(z) ** 2) / 4, abs=1e-13 * total**2)


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_angles_come_back_from_the_plane(params, state):
    z = a3.plane(params, state["alpha1"], state["alpha2"])
    alpha1, alpha2 = a3.angles_from_plane(z, params)
    np.testing.assert_allclose(a3.plane(params, alpha1, alpha2), z, atol=1e-12)
    distance = np.abs(alpha1 - state["alpha1"]) + np.abs(alpha2 - state["alpha2"])
    assert distance.min() < 1e-6


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_circles_in_the_plane_decide_as_the_invariants_do(params, state):
    stiffness, determinant = stiffness_of(params, state)
    invariants = spectrum(stiffness, determinant, k3=params.k3, mu=params.drag, mass=params.mass)
    z = a3.plane(params, state["alpha1"], state["alpha2"])
    centre, radius = a3.flutter_circle(params, params.k3)
    assert (abs(z - centre) < radius) == (invariants.discriminant < 0)
    centre, radius = a3.divergence_circle(params, params.k3)
    assert (abs(z - centre) > radius) == (invariants.determinant < 0)
