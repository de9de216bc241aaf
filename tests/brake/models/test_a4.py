"""A4: both linear states against the symbolic model, natural frequencies, the first integral."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.models import a4
from squealpipe.laws.springs import (
    Stiffness,
    geometry,
    linear_stiffness,
    stiffness_determinant,
)
from squealpipe.schema import Outcome
from tests import symbols
from tests.former import FORMER

DRAWS = symbols.draws(30)
LINEAR_FORCE = symbols.function(symbols.LINEAR_FORCE)
CONTACT_FORCE = symbols.function(symbols.CONTACT_FORCE)
K11, K12, K22, K3, MU, M = sp.symbols("k11 k12 k22 k3 mu m")
PRINTED_ROOT = (
    K11**2
    - 2 * K11 * K22
    + K22**2
    + 4 * K12**2
    - 2 * K11 * K3
    + 4 * MU * K12 * K3
    + 2 * K22 * K3
    + K3**2
)


@pytest.mark.parametrize(("params", "state"), DRAWS)
@pytest.mark.parametrize("contact", [0.0, 1.0])
def test_accelerations(params, state, contact):
    g = geometry(state["alpha1"], state["alpha2"])
    found = a4.acceleration(state["x"], state["y"], params, g, contact=contact)
    normal = contact * CONTACT_FORCE(params, **state)
    expected = (
        LINEAR_FORCE(params, **state) + normal * np.array([params.drag, 1.0])
    ) / params.mass
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


def test_spectrum_is_the_printed_one():
    """Half trace and discriminant of Eqs. (22a), (22b), identically."""
    determinant = K11 * K22 - K12**2
    invariants = a4.spectrum(
        Stiffness(K11, K12, K22), determinant, k3=K3, mu=MU, mass=M
    )
    assert sp.simplify(invariants.half_trace - (K11 + K22 + K3) / (2 * M)) == 0
    assert sp.simplify(invariants.discriminant - PRINTED_ROOT / (4 * M**2)) == 0
    consistent = (
        invariants.half_trace**2 - invariants.discriminant - invariants.determinant
    )
    assert sp.simplify(consistent) == 0


@pytest.mark.parametrize(("params", "state"), DRAWS)
@pytest.mark.parametrize("in_contact", [False, True])
def test_frequencies_are_eigenvalues_of_the_stiffness(params, state, in_contact):
    g = geometry(state["alpha1"], state["alpha2"])
    stiffness = linear_stiffness(params, g)
    k3 = params.k3 if in_contact else 0.0
    determinant, rest = (
        stiffness_determinant(params, g),
        {"mu": params.mu, "mass": params.mass},
    )
    own = a4.natural_frequencies_squared(
        a4.spectrum(stiffness, determinant, k3=k3, **rest)
    )
    matrix = np.reshape(a4.contact_matrix(stiffness, k3, params.mu), (2, 2))
    numeric = np.linalg.eigvals(matrix) / params.mass
    own, numeric = (
        sorted(each, key=lambda w: w.real + 1e-9 * w.imag) for each in (own, numeric)
    )
    np.testing.assert_allclose(own, numeric, rtol=1e-7, atol=1e-9)


def test_first_integral_changes_by_nothing_symbolically():
    """dH/dt = 0 in both states, identically in all symbols."""
    x, vx, vy, length = sp.symbols("x vx vy l")
    p = SimpleNamespace(mass=M, k3=K3, drag=MU, preload=length)
    stiffness = Stiffness(K11, K12, K22)
    for contact in (0, 1):
        depth = sp.Symbol("d", positive=bool(contact), negative=not contact)
        y = length - depth
        energy = a4.first_integral_value(x, y, vx, vy, p, stiffness)
        force = -sp.Matrix([[K11, K12], [K12, K22]]) * sp.Matrix([x, y])
        force += contact * K3 * depth * sp.Matrix([MU, 1])
        speeds = {x: vx, depth: -vy, vx: force[0] / M, vy: force[1] / M}
        rate = sum(sp.diff(energy, each) * speed for each, speed in speeds.items())
        assert sp.simplify(sp.nsimplify(rate)) == 0


def test_lengths_that_a4_does_not_know_change_nothing():
    """Also where their squares vanish, which only A1's distance from its pivots would feel."""
    usual, short = (
        simulate(FORMER.with_(length2=length), 1.0, 2.0, t_end=20.0, model="A4")
        for length in (5.0, 1e-170)
    )
    assert usual.outcome == Outcome.converged
    for name in ("x", "event_time"):
        np.testing.assert_array_equal(short[name], usual[name])
