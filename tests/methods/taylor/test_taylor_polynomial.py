"""Values and extrema of Taylor polynomials, against polynomials with known roots."""

from __future__ import annotations

import math

import numba
import numpy as np
import pytest

from squealpipe.methods.taylor import taylor_polynomial
from squealpipe.methods.taylor.lanes import aligned
from squealpipe.methods.taylor.simd import LANES, ROW, splat, store

STEP = 0.4


class Callable:
    """The module's functions, which compiled code alone may call, as Python may call them."""

    def __getattr__(self, name: str):
        function = getattr(taylor_polynomial, name)

        @numba.njit
        def call(*arguments):
            return function(*arguments)

        return call


taylor = Callable()


def coefficients(order: int = 15) -> np.ndarray:
    """Four oscillations sin(ω t + φ) with their rates, expanded about 0: x, y, ẋ, ẏ in one lane."""
    k = np.arange(order + 1)
    table = np.empty((4, order + 1, 1))
    for row, (omega, phase) in enumerate([(3.0, 0.9), (2.0, -2.0)]):
        terms = omega**k * np.sin(phase + 0.5 * np.pi * k)
        table[row, :, 0] = terms / [math.factorial(n) for n in k]
        rates = omega ** (k + 1) * np.sin(phase + 0.5 * np.pi * (k + 1))
        table[row + 2, :, 0] = rates / [math.factorial(n) for n in k]
    return table


def test_values_rates_and_accelerations():
    table, t = coefficients(), 0.3
    x, y, vx, vy, ax, ay = taylor.evaluate_motion(table, 0, t)
    assert x == pytest.approx(math.sin(3 * t + 0.9), abs=1e-14)
    assert y == pytest.approx(math.sin(2 * t - 2.0), abs=1e-14)
    assert vx == pytest.approx(3 * math.cos(3 * t + 0.9), abs=1e-13)
    assert vy == pytest.approx(2 * math.cos(2 * t - 2.0), abs=1e-13)
    assert ax == pytest.approx(-9 * x, abs=1e-12)
    assert ay == pytest.approx(-4 * y, abs=1e-12)
    assert taylor.evaluate_state(table, 0, t) == (x, y, vx, vy)
    assert taylor.evaluate(table, 1, 0, t) == pytest.approx(y, abs=1e-15)


def test_extrema_are_found_to_round_off():
    table = coefficients()
    first, last = table[2, 0, 0], float(taylor.evaluate(table, 2, 0, STEP))
    assert first > 0 > last
    assert taylor.extremum(table, 0, 2, 0, STEP, first, last) == pytest.approx(1.0, abs=1e-14)
    first, last = table[3, 0, 0], float(taylor.evaluate(table, 3, 0, STEP))
    assert first < 0 < last
    assert taylor.extremum(table, 1, 3, 0, STEP, first, last) == pytest.approx(-1.0, abs=1e-14)


@numba.njit
def bounds_over_step(row, start, end, first, last, step):
    """``above`` of one curve and ``below`` of its negative, in each lane."""
    at = row.ctypes.data
    curve = splat(start), splat(end), splat(first), splat(last), splat(step)
    store(at, taylor_polynomial.above(*curve))
    mirrored = -1.0 * curve[0], -1.0 * curve[1], -1.0 * curve[2], -1.0 * curve[3], curve[4]
    store(at + ROW, taylor_polynomial.below(*mirrored))


@pytest.mark.parametrize("early", [True, False])
def test_a_maximum_is_below_its_bound_also_with_an_inflection_in_the_step(early):
    """Tangents at the ends of t (t − 1)², or of it backwards, meet far below its top."""
    curve = np.polynomial.Polynomial([0.0, 1.0, -2.0, 1.0])
    length = 0.99
    if not early:
        curve = curve(np.polynomial.Polynomial([length, -1.0]))
    ends = curve(0.0), curve(length), curve.deriv()(0.0), curve.deriv()(length)
    top = curve(curve.deriv().roots()).max()
    rows = aligned(2, LANES)
    bounds_over_step(rows, *ends, length)
    assert (rows[0] >= top).all()
    assert (rows[1] <= -top).all()
    start, end, first, last = ends
    tangents_meet = (first * (end - last * length) - last * start) / (first - last)
    assert tangents_meet < 0.2 * top


@pytest.mark.parametrize("scale", [1.0, 1e-12, 1e12])
def test_first_guess_is_the_root_of_a_parabola(scale):
    root, other = 0.13, -2.0
    curve = np.polynomial.Polynomial.fromroots([root, other]) * scale
    guess = taylor.first_guess(curve(0.0), curve(STEP), curve.deriv()(0.0), STEP)
    assert guess == pytest.approx(root, rel=1e-12)


def test_a_time_outside_the_step_or_no_number_becomes_its_middle():
    assert taylor.inside(0.1, STEP) == 0.1
    assert [taylor.inside(t, STEP) for t in (-0.1, 0.5, math.nan, math.inf)] == [STEP / 2] * 4
