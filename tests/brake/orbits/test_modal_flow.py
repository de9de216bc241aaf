"""The closed-form flow against matrix exponentials, and event times against closed forms."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from squealpipe.brake.orbits.modal_flow import advance, next_crossing, propagator
from squealpipe.brake.orbits.piecewise_linear import LinearState

MATRICES = {
    "distinct": ((1.4, 0.3), (0.2, 0.7)),
    "equal, diagonal": ((1.0, 0.0), (0.0, 1.0)),
    "equal, defective": ((1.0, 0.5), (0.0, 1.0)),
    "nearly equal, nearly defective": ((1.0 + 1e-9, 0.5), (1e-18, 1.0)),
    "close": ((1.0, 0.02), (0.03, 1.01)),
    "zero frequency": ((1.0, -0.5), (-0.5, 0.25)),
    "both near zero": ((1e-14, 0.0), (0.0, 1.0)),
    "flutter": ((1.0, 0.4), (-0.3, 1.1)),
    "divergence": ((1.5, 0.9), (0.9, 0.2)),
}
LOAD = (0.3, -0.7)


def _flow(matrix, state, time):
    """(x, y, vx, vy, 1) by the exponential of the augmented matrix."""
    full = np.zeros((5, 5))
    full[:2, 2:4] = np.eye(2)
    full[2:4, :2] = -np.array(matrix)
    full[2:4, 4] = LOAD
    return (expm(full * time) @ [*state, 1.0])[:4]


@pytest.mark.parametrize("matrix", MATRICES.values(), ids=MATRICES)
@pytest.mark.parametrize("time", [1e-6, 0.3, 2.0, 11.0])
def test_flow_agrees_with_the_matrix_exponential(matrix, time):
    row = LinearState(matrix, LOAD).row(1.0)
    state = np.array([0.4, 1.3, -0.2, 0.6])
    expected = _flow(matrix, state, time)
    coefficients = np.empty(8)
    propagator(row, time, coefficients)
    advance(row, coefficients, state)
    np.testing.assert_allclose(state, expected, rtol=2e-13, atol=2e-13)


def test_crossing_of_one_oscillator_is_where_the_arc_cosine_says():
    row = LinearState(((1.0, 0.0), (0.0, 2.25)), (0.0, 0.0)).row(0.4)
    origin = np.array([0.0, 1.0, 0.0, 0.0])
    found = next_crossing(row, origin, 1.0, 10.0)
    assert found == pytest.approx(math.acos(0.4) / 1.5, rel=1e-15)


@pytest.mark.parametrize("depth", [1e-3, 1e-5, 1e-7, 1e-9, 1e-11])
def test_a_grazing_pair_of_crossings_is_not_stepped_over(depth):
    row = LinearState(((1.0, 0.0), (0.0, 1.0)), (0.0, 0.0)).row(-1.0 + depth)
    origin = np.array([0.0, 1.0, 0.0, 0.0])
    found = next_crossing(row, origin, 1.0, 10.0)
    # acos loses half its digits next to −1; the half-angle form does not
    expected = math.pi - 2.0 * math.asin(math.sqrt(0.5 * depth))
    assert found == pytest.approx(expected, abs=1e-16 / math.sqrt(depth) + 1e-14)


def test_staying_clear_of_the_threshold_has_no_crossing():
    row = LinearState(((1.0, 0.3), (0.3, 2.0)), (0.0, 0.0)).row(-5.0)
    origin = np.array([0.5, 1.0, 0.0, 0.0])
    assert next_crossing(row, origin, 1.0, 200.0) == -1.0


def test_a_start_on_the_threshold_finds_the_way_back():
    """y = sin t leaves 0 upwards and comes back at π."""
    row = LinearState(((1.0, 0.0), (0.0, 1.0)), (0.0, 0.0)).row(0.0)
    found = next_crossing(row, np.array([0.0, 0.0, 0.0, 1.0]), 1.0, 10.0)
    assert found == pytest.approx(math.pi, rel=1e-15)
