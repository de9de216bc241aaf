"""Taylor series written from symbols, against closed forms; perturbations, against theirs."""

import ctypes
from math import factorial

import mpmath
import numpy as np
import pytest
from numba import njit

from squealpipe.functions import exp
from squealpipe.systems.compiled import part
from squealpipe.systems.taylor import series
from squealpipe.systems.taylor.lanes import INVERSES, aligned, compile_system
from squealpipe.systems.taylor.scalar import python_function
from squealpipe.systems.taylor.series import HybridSystem, series_source
from squealpipe.systems.taylor.simd import LANES, ROW, fma, load, store
from squealpipe.systems.taylor.symbols import (
    FUNCTIONS,
    derivative,
    function,
    parameter,
    symbol,
    variables,
)

TERMS = 16
ONE = symbol(1.0)
Words = ctypes.CFUNCTYPE(None, *[ctypes.c_ssize_t] * 4)
FiveWords = ctypes.CFUNCTYPE(None, *[ctypes.c_ssize_t] * 5)


def coefficients(rates, start, events=(ONE, ONE, ONE), parameters=()):
    """Series of the state and the events from one start, the same in all lanes."""
    names = variables(*"xyzw"[: len(rates)])
    system = HybridSystem(names, rates, events, tuple(name for name, _ in parameters))
    compiled = compile_system(system, tangent=True)
    rows = aligned(compiled.n_series, TERMS, LANES)
    rows[: len(start), 0] = np.array(start, float)[:, None]
    values = aligned(max(1, len(parameters)), LANES)
    for row, (_, value) in zip(values, parameters, strict=False):
        row[:] = value
    addresses = rows.ctypes.data, values.ctypes.data
    Words(compiled.address("series"))(*addresses, INVERSES.ctypes.data, TERMS)
    assert (rows == rows[:, :, :1]).all()
    return compiled, rows, values


def test_a_product_that_is_added_is_rounded_once_on_every_processor():
    """(1 + 2e)(1 + 2e) − (1 + 4e) is 4e², which a product that is rounded loses.

    LLVM's fmuladd would be rounded once or twice, by what the processor has.
    """

    @part
    def added(a, b, c, result):
        store(result, fma(load(a), load(b), load(c)))

    @njit
    def run(rows):
        first = rows.ctypes.data
        added(first, first, first + ROW, first + 2 * ROW)

    rows, e = aligned(3, LANES), 2.0**-29
    rows[0], rows[1] = 1.0 + 2.0 * e, -(1.0 + 4.0 * e)
    run(rows)
    assert (rows[2] == 4.0 * e * e).all()
    (code,) = run.inspect_llvm().values()
    assert "llvm.fma.v" in code
    assert "fmuladd" not in code


def test_power_series_in_closed_form():
    x, y, z, w = variables(*"xyzw")
    rates = (x * x, exp(-y), z**-1.0 * 0.5, w**0.5)
    _, rows, _ = coefficients(rates, (1.0, 0.0, 1.0, 1.0))
    k = np.arange(1, TERMS)
    np.testing.assert_allclose(rows[0, :, 0], 1.0, rtol=1e-14)  # 1/(1 − t)
    np.testing.assert_allclose(
        rows[1, 1:, 0], (-1.0) ** (k + 1) / k, rtol=1e-13
    )  # ln(1 + t)
    binomial = np.cumprod(np.concatenate([[1.0], (0.5 - np.arange(TERMS - 1)) / k]))
    np.testing.assert_allclose(rows[2, :, 0], binomial, rtol=1e-13)  # √(1 + t)
    square = np.zeros(TERMS)
    square[:3] = 1.0, 1.0, 0.25  # (1 + t/2)²
    np.testing.assert_allclose(rows[3, :, 0], square, atol=1e-15)


@pytest.mark.parametrize("power", [2, 3, 4, 7])
def test_whole_powers_have_their_series_where_the_base_is_zero(power):
    x, _ = variables(*"xy")
    _, rows, _ = coefficients((ONE, x**power), (0.0, 0.0))
    exact = np.zeros(TERMS)
    exact[power + 1] = 1.0 / (power + 1)
    np.testing.assert_allclose(rows[1, :, 0], exact, rtol=1e-15)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_function_has_the_taylor_series_of_its_closed_form(name):
    """Of u = 0.3 + x with x' = x², which turns and bends at every order."""
    (x,) = variables("x")
    start = 0.4 if name == "asin" else 0.8
    # the highest order of a surface that is not linear is left out
    _, rows, _ = coefficients((x * x,), (start,), (function(name, x + 0.3), ONE, ONE))
    with mpmath.workdps(40):
        exact = mpmath.taylor(
            lambda t: getattr(mpmath, name)(start / (1 - start * t) + 0.3), 0, TERMS - 2
        )
    np.testing.assert_allclose(rows[1, :-1, 0], np.array(exact, float), rtol=2e-13)


def test_two_centres_that_coincide_are_one():
    """x'' = −½ Σ (x − a) |r − a|^−3 − … on the unit circle about a: cosine and sine."""
    x, y, z, w = variables(*"xyzw")
    a = parameter("a")
    distance2 = (x - a) * (x - a) + y * y
    pull = 0.5 * distance2**-1.5
    ax = -(pull * (x - a)) + -(pull * (x - a))
    ay = -(pull * y) - pull * y
    events = (x - a, z * z + w * w, distance2**0.5 + 2.0)
    _, rows, _ = coefficients(
        (z, w, ax, ay), (3.0, 0.0, 0.0, 1.0), events, [("a", 2.0)]
    )
    cosine = np.array([np.cos(0.5 * np.pi * k) / factorial(k) for k in range(TERMS)])
    sine = np.array([np.sin(0.5 * np.pi * k) / factorial(k) for k in range(TERMS)])
    np.testing.assert_allclose(
        rows[0, :, 0], cosine + 2.0 * (np.arange(TERMS) == 0), atol=2e-15
    )
    np.testing.assert_allclose(rows[1, :, 0], sine, atol=2e-15)
    np.testing.assert_allclose(rows[4, :, 0], cosine, atol=2e-15)
    constant = np.arange(TERMS) == 0
    np.testing.assert_allclose(rows[5, :, 0], constant, atol=5e-15)
    np.testing.assert_allclose(rows[6, :, 0], 3.0 * constant, atol=5e-15)


@pytest.mark.parametrize("step", [0.1, 0.2, 0.4])
def test_a_perturbation_follows_the_variational_equation(step):
    """x' = −x², y' = x y: δx = δx0/(1 + t)², δy = (1 + t) δy0 + t δx0 from x = y = 1."""
    x, y = variables(*"xy")
    compiled, rows, values = coefficients((-(x * x), x * y), (1.0, 1.0))
    length, tangent = aligned(LANES), aligned(2, LANES)
    length[:], tangent[0], tangent[1] = step, 0.7, -0.4
    FiveWords(compiled.address("perturb"))(
        rows.ctypes.data,
        values.ctypes.data,
        length.ctypes.data,
        tangent.ctypes.data,
        TERMS,
    )
    exact = [0.7 / (1.0 + step) ** 2, -0.4 * (1.0 + step) + 0.7 * step]
    np.testing.assert_allclose(tangent[:, 0], exact, atol=2e-3 * step**4)


def test_derivatives_of_symbols():
    x, y = variables(*"xy")
    assert derivative(x * x * y, x) is not derivative(x * x * y, y)
    assert derivative(parameter("a") * x, x) is parameter("a")
    assert derivative(symbol(2.0) * y, x) is symbol(0.0)
    assert x**0.3 is exp(0.3 * function("log", x))
    with pytest.raises(TypeError, match="make each side a regime"):
        abs(x)


def test_a_parameter_before_two_levers_has_its_derivative():
    """Of two springs' force by their stiffness, which was 0."""
    x, y = variables("x", "y")
    k, c = parameter("k"), parameter("c")
    force = k * (x * y) * (x + 1.0) + c * k * (y * y) * (x - 2.0)
    assert force.kind == "joined"
    by = [symbol(derivative(force, each)) for each in (k, c, x)]
    found = python_function(by, [x, y, k, c], np)(3.0, 5.0, 7.0, 11.0)
    assert found == (60.0 + 275.0, 175.0, 7.0 * 35.0 + 77.0 * 25.0)


def test_series_are_told_apart_by_what_they_are_not_by_a_hash(monkeypatch):
    """Two joined series under one hash became one, without a word."""
    x, y, z, w = variables(*"xyzw")
    rates = (z, w, -(x**-1.0 * x + y**-1.0 * x), -(x**-2.0 * y + y**-2.0 * y))
    system = HybridSystem((x, y, z, w), rates, (ONE, ONE, ONE), ())
    usual = series_source(system)
    monkeypatch.setattr(series, "hash", {}.get, raising=False)
    assert series_source(system) == usual
