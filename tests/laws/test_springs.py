"""Spring laws against forces derived symbolically from the potential energy."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from squealpipe.laws import springs
from squealpipe.parameters import Parameters
from tests import symbols

DRAWS = symbols.draws(40)
ENERGY = symbols.function(symbols.SPRING_ENERGY)
FORCE = symbols.function(symbols.SPRING_FORCE)
STIFFNESS = symbols.function(symbols.STIFFNESS)


def geometry(state: dict[str, float]) -> springs.Geometry:
    return springs.geometry(state["alpha1"], state["alpha2"])


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_force_is_the_gradient_of_the_energy(params: Parameters, state: dict[str, float]) -> None:
    force = springs.elastic_force(state["x"], state["y"], params, geometry(state))
    np.testing.assert_allclose(force, FORCE(params, **state), rtol=1e-12, atol=1e-13)
    energy = springs.elastic_energy(state["x"], state["y"], params, geometry(state))
    assert energy == pytest.approx(float(ENERGY(params, **state)), rel=1e-12)


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_stiffness_is_the_hessian_of_the_energy(
    params: Parameters, state: dict[str, float]
) -> None:
    k = springs.linear_stiffness(params, geometry(state))
    hessian = STIFFNESS(params, **state)
    np.testing.assert_allclose([[k.k11, k.k12], [k.k12, k.k22]], hessian, rtol=1e-13, atol=1e-13)
    determinant = springs.stiffness_determinant(params, geometry(state))
    assert determinant == pytest.approx(np.linalg.det(hessian), rel=1e-11, abs=1e-13)


def test_force_approaches_the_linear_one_in_second_order() -> None:
    params, state = DRAWS[0]
    g = geometry(state)
    k = springs.linear_stiffness(params, g)
    steps = 10.0 ** -np.arange(1, 5)
    errors = [
        math.dist(
            springs.elastic_force(0.6 * step, -0.8 * step, params, g),
            springs.linear_elastic_force(0.6 * step, -0.8 * step, k),
        )
        for step in steps
    ]
    orders = np.diff(np.log10(errors)) / np.diff(np.log10(steps))
    np.testing.assert_allclose(orders, 2.0, atol=0.05)


def test_linear_force_is_the_gradient_of_its_energy() -> None:
    params, state = DRAWS[1]
    k = springs.linear_stiffness(params, geometry(state))
    x, y = state["x"], state["y"]
    force = springs.linear_elastic_force(x, y, k)
    # The energy is quadratic, so central differences of any step are exact but for round-off.
    slopes = (
        springs.linear_elastic_energy(x + 1, y, k) - springs.linear_elastic_energy(x - 1, y, k),
        springs.linear_elastic_energy(x, y + 1, k) - springs.linear_elastic_energy(x, y - 1, k),
    )
    np.testing.assert_allclose(force, [-slope / 2 for slope in slopes], rtol=1e-13)


def test_springs_are_unloaded_at_the_start_and_rest_on_their_fixed_ends() -> None:
    params, state = DRAWS[2]
    g = geometry(state)
    np.testing.assert_allclose(springs.elastic_force(0.0, 0.0, params, g), 0.0, atol=1e-14)
    x1, y1, x2, y2 = springs.fixed_ends(params, g)
    assert springs.squared_distance(0.0, 0.0, x1, y1) == pytest.approx(params.length1**2)
    assert springs.squared_distance(0.0, 0.0, x2, y2) == pytest.approx(params.length2**2)
    assert math.atan2(y1, x1) == pytest.approx(state["alpha1"])
    assert math.atan2(y2, -x2) == pytest.approx(state["alpha2"])


@pytest.mark.parametrize("nearby", [0.0, 1e-15, 1e-12, 1e-8, 1e-3, 1.0])
@pytest.mark.parametrize("turn", [0, 1, 2])
def test_sine_of_the_sum_keeps_all_digits_next_to_its_zeros(turn: int, nearby: float) -> None:
    first = 0.4 * math.pi
    second = turn * math.pi - first + nearby
    with mpmath.workdps(50):
        exact = float(mpmath.sin(mpmath.mpf(first) + mpmath.mpf(second)))
    assert springs.sine_of_sum(first, second) == pytest.approx(exact, rel=1e-15, abs=0)
