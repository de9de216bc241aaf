"""Spring laws against forces derived symbolically from the potential energy."""

import math

import mpmath
import numpy as np
import pytest

from squealpipe.laws import springs
from squealpipe.laws.dashpots import damping_force
from squealpipe.parameters import Parameters
from tests import symbols

DRAWS = symbols.draws(40)
FORCE = symbols.function(symbols.SPRING_FORCE)
STIFFNESS = symbols.function(symbols.STIFFNESS)


def geometry(state):
    return springs.geometry(state["alpha1"], state["alpha2"])


@pytest.mark.parametrize(("params", "state"), DRAWS)
def test_force_and_stiffness_are_derivatives_of_the_energy(params, state):
    g = geometry(state)
    force = springs.elastic_force(state["x"], state["y"], params, g)
    np.testing.assert_allclose(force, FORCE(params, **state), rtol=1e-12, atol=1e-13)
    k = springs.linear_stiffness(params, g)
    hessian, place = STIFFNESS(params, **state), (state["x"], state["y"])
    np.testing.assert_allclose(
        [[k.k11, k.k12], [k.k12, k.k22]], hessian, rtol=1e-13, atol=1e-13
    )
    linear = springs.linear_elastic_force(*place, k)
    np.testing.assert_allclose(linear, -hessian @ place, rtol=1e-12, atol=1e-13)
    determinant = springs.stiffness_determinant(params, g)
    assert determinant == pytest.approx(np.linalg.det(hessian), rel=1e-11, abs=1e-13)


def test_force_approaches_the_linear_one_in_second_order():
    params, state = DRAWS[0]
    g = geometry(state)
    k = springs.linear_stiffness(params, g)
    steps = 10.0 ** -np.arange(1, 5)
    place = 0.6 * steps, -0.8 * steps
    exact, linear = (
        springs.elastic_force(*place, params, g),
        springs.linear_elastic_force(*place, k),
    )
    errors = np.hypot(*np.subtract(exact, linear))
    orders = np.diff(np.log10(errors)) / np.diff(np.log10(steps))
    np.testing.assert_allclose(orders, 2.0, atol=0.05)


def test_springs_are_unloaded_at_the_start_and_rest_on_their_fixed_ends():
    params, state = DRAWS[2]
    g = geometry(state)
    np.testing.assert_allclose(
        springs.elastic_force(0.0, 0.0, params, g), 0.0, atol=1e-14
    )
    x1, y1, x2, y2 = springs.fixed_ends(params, g)
    assert springs.squared_distance(0.0, 0.0, x1, y1) == pytest.approx(
        params.length1**2
    )
    assert springs.squared_distance(0.0, 0.0, x2, y2) == pytest.approx(
        params.length2**2
    )
    assert math.atan2(y1, x1) == pytest.approx(state["alpha1"])
    assert math.atan2(y2, -x2) == pytest.approx(state["alpha2"])


@pytest.mark.parametrize("nearby", [0.0, 1e-15, 1e-12, 1e-8, 1e-3, 1.0])
@pytest.mark.parametrize("turn", [0, 1, 2])
def test_sine_of_the_sum_keeps_all_digits_next_to_its_zeros(turn, nearby):
    first = 0.4 * math.pi
    second = turn * math.pi - first + nearby
    with mpmath.workdps(50):
        exact = float(mpmath.sin(mpmath.mpf(first) + mpmath.mpf(second)))
    assert springs.sine_of_sum(first, second) == pytest.approx(exact, rel=1e-15, abs=0)


def _in_60_digits(length, x, y, cosine, sine):
    with mpmath.workdps(60):
        rx, ry = mpmath.mpf(x) - length * cosine, mpmath.mpf(y) - length * sine
        stretch = 1 - length / mpmath.sqrt(rx * rx + ry * ry)
        return np.array([float(-stretch * rx), float(-stretch * ry)])


def _worst(form, length, near=None):
    """Largest error of a form over 60 random states: about the start, or so near to the pivot."""
    rng, worst = np.random.default_rng(6), 0.0
    for _ in range(60):
        angle, around = rng.uniform(0, 2 * np.pi, 2)
        with mpmath.workdps(60):
            pair = mpmath.cos_sin(mpmath.mpf(angle))
            cosine, sine = pair if near is None else map(mpmath.mpf, map(float, pair))
            c, s = float(cosine), float(sine)
        x, y = rng.uniform(-2, 2, 2)
        if near is not None:
            x, y = (
                length * (c + near * np.cos(around)),
                length * (s + near * np.sin(around)),
            )
        exact = _in_60_digits(length, x, y, cosine, sine)
        found = np.array(form(1.0, length, x, y, length * c, length * s))
        worst = max(worst, np.hypot(*(found - exact)) / max(1.0, np.hypot(*exact)))
    return float(worst)


@pytest.mark.parametrize("length", [1e3, 1e5, 1e7, 1e9])
def test_long_springs_lose_no_digits(length):
    """Against 60 digits; the usual form loses as many digits as the length has."""
    assert _worst(springs.long_spring_force, length) < 3e-15
    assert _worst(springs.spring_force, length) > 1e-17 * length


def test_next_to_its_fixed_end_a_spring_takes_the_usual_form():
    """There q → −L² and d² = L² + q cancels; a mass is that far out beyond 1e3 l_pre only."""
    for near in (1e-1, 1e-3, 1e-6):
        assert _worst(springs.spring_force, 5.0, near) < 1e-15 / near
        assert _worst(springs.long_spring_force, 1e4, near) < 1e-15 / near**2


def test_both_forms_agree_where_one_takes_over():
    params = Parameters(
        length1=2 * springs.LONG_SPRING, length2=0.7 * springs.LONG_SPRING, k2=1.3
    )
    g = springs.geometry(0.7, 2.1)
    usual = springs.elastic_force(0.3, -0.8, params, g)
    for flags in ((True, False), (False, True), (True, True)):
        found = springs.elastic_force(0.3, -0.8, params, g, flags)
        np.testing.assert_allclose(found, usual, atol=2e-12)


def test_dashpots_take_the_power_of_their_stretching_along_themselves():
    """Force −c ḋ along each spring: −Σ c ḋ² of power, and none of a motion across."""
    params = Parameters(length1=1.3, length2=0.8, damping1=0.7, damping2=1.9)
    dashpots, step = np.array([params.damping1, params.damping2]), 1e-30
    for x, y, vx, vy, a1, a2 in np.random.default_rng(8).uniform(0.2, 2.5, (20, 6)):
        g = springs.geometry(a1, a2)
        away = np.array([x, y]) - np.reshape(springs.fixed_ends(params, g), (2, 2))
        # the imaginary part over a tiny step is the exact derivative
        moved = away + 1j * step * np.array([vx, vy])
        rates = np.sqrt((moved**2).sum(axis=1)).imag / step
        along = away / np.linalg.norm(away, axis=1)[:, None]
        force = damping_force(x, y, vx, vy, params, g)
        np.testing.assert_allclose(force, -(dashpots * rates) @ along, rtol=1e-11)
