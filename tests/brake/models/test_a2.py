"""A2: the linearization of Eqs. (6), (7) and the condition for quasi-static sliding."""

import math

import numpy as np
import pytest
import sympy as sp

from squealpipe.brake.models import a2
from squealpipe.laws.springs import Stiffness, geometry, linear_stiffness
from tests import symbols
from tests.former import FORMER

DEPTH = symbols.P.preload - symbols.Y
REGULARIZED = symbols.P.k3 * DEPTH * (1 + sp.tanh(symbols.P.sigma * DEPTH)) / 2


def first_order(force):
    """Taylor polynomial of degree 1 in x and y about the start."""
    at_start = {symbols.X: 0, symbols.Y: 0}
    slopes = [
        sp.diff(force, variable).subs(at_start) for variable in (symbols.X, symbols.Y)
    ]
    return force.subs(at_start) + slopes[0] * symbols.X + slopes[1] * symbols.Y


DRAG = symbols.P.mu * sp.Piecewise((1, symbols.P.belt_speed >= 0), (-1, True))
FORCES = (
    symbols.SPRING_FORCE[0] + DRAG * REGULARIZED,
    symbols.SPRING_FORCE[1] + REGULARIZED,
)
LINEARIZED = symbols.function([first_order(force) / symbols.P.mass for force in FORCES])


@pytest.mark.parametrize(("params", "state"), symbols.draws(20))
def test_it_is_the_taylor_polynomial_of_the_regularized_model(params, state):
    """And without sigma its limit."""
    stiffness = linear_stiffness(params, geometry(state["alpha1"], state["alpha2"]))
    place = state["x"], state["y"], params, stiffness
    found = a2.acceleration(*place, params.sigma)
    np.testing.assert_allclose(
        found, LINEARIZED(params, **state), rtol=1e-12, atol=1e-12
    )
    steep = a2.acceleration(*place, 50 / params.preload)
    np.testing.assert_allclose(a2.acceleration(*place), steep, rtol=1e-12)


def test_reaction_solves_the_balance_of_eq_10():
    x, y, reaction, load = sp.symbols("x y R F")
    k11, k12, k22, mu = sp.symbols("k11 k12 k22 mu")
    balance = [k11 * x + k12 * y - mu * reaction, k12 * x + k22 * y + load - reaction]
    solution = sp.solve(
        [equation.subs(y, 0) for equation in balance], [x, reaction], dict=True
    )[0]
    numbers = {k11: 1.3, k12: -0.4, k22: 0.9, mu: 0.35, load: 0.6}
    found = a2.reaction_force(Stiffness(1.3, -0.4, 0.9), 0.35, 0.6)
    assert float(found) == pytest.approx(
        float(solution[reaction].subs(numbers)), rel=1e-14
    )


@pytest.mark.parametrize(
    ("k11", "k12", "mu", "printed", "physical"),
    [
        (1.0, 2.0, 0.3, True, True),  # μ < K11/K12
        (1.0, 4.0, 0.3, False, False),
        (
            1.0,
            -4.0,
            0.3,
            False,
            True,
        ),  # the printed condition fails for every μ if K12 < 0
        (1.0, -4.0, 0.0, False, True),
        (1.0, 0.0, 5.0, True, True),
        (1.0, 1e-17, 5.0, True, True),  # K12 is round-off
        (0.0, 0.0, 0.3, False, False),  # nothing balances friction
    ],
)
def test_both_readings_of_eq_11(k11, k12, mu, printed, physical):
    stiffness = Stiffness(np.array(k11), np.array(k12), np.array(2.0))
    assert bool(a2.possible_as_printed(stiffness, mu)) is printed
    assert bool(a2.reaction_force(stiffness, mu, 1.0) > 0) is physical


@pytest.mark.parametrize(
    ("over_pi1", "over_pi2"),
    [(0.3, 0.3), (0.2, 0.3), (0.9, 0.6), (0.5, 1.0), (0.0, 0.5)],
)
def test_equal_springs_decouple_on_three_lines(over_pi1, over_pi2):
    """α1 = α2 and α1 + α2 = π/2, 3π/2, where round-off must not decide Eq. (11)."""
    stiffness = linear_stiffness(
        FORMER, geometry(over_pi1 * math.pi, over_pi2 * math.pi)
    )
    assert bool(a2.coupling_is_zero(stiffness))
    assert bool(a2.possible_as_printed(stiffness, 10.0))
