"""Every shipped function: in fields, surfaces and outputs, against closed forms."""

import numpy as np
import pytest

from squealpipe import Switch, System, functions
from squealpipe.functions import asin, atan, cosh, exp, log, sinh, tanh

LOGISTIC = {
    # x' = 1/f'(x) makes f(x(t)) = f(x(0)) + t
    "exp": (lambda x: exp(-x), np.exp, np.log),
    "log": (lambda x: x, np.log, np.exp),
    "tanh": (lambda x: 1.0 / (1.0 - tanh(x) ** 2), np.tanh, np.arctanh),
    "sinh": (lambda x: 1.0 / cosh(x), np.sinh, np.arcsinh),
    "cosh": (lambda x: 1.0 / sinh(x), np.cosh, np.arccosh),
    "atan": (lambda x: 1.0 + x * x, np.arctan, np.tan),
    "asin": (lambda x: (1.0 - x * x) ** 0.5, np.arcsin, np.sin),
}


NEWEST = ("atan", "asin", "sinh")


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name in NEWEST else pytest.mark.release)
        for name in LOGISTIC
    ],
)
def test_functions_of_states_grow_as_they_should(name):
    rate, exact, inverse = LOGISTIC[name]
    function = getattr(functions, name)
    rises = System(
        name,
        states={"x": "1", "y": "1"},
        parameters={},
        regimes={"before": {"rate": 1.0}, "after": {"rate": 0.0}},
        field=lambda t, s, p, r: {"x": rate(s.x), "y": r.rate * function(s.x)},
        switches=[
            Switch(
                "level",
                "before",
                lambda t, s, p, r: exact(0.5) + 0.25 - function(s.x),
                "after",
            )
        ],
        outputs={"f": ("1", lambda t, s, p, r: function(s.x))},
        start={"x": 0.5, "y": 0.0, "regime": "before"},
    )
    run = rises.simulate(0.4)
    begin = exact(0.5)
    np.testing.assert_allclose(run.event_time, [0.25], rtol=2e-13)
    np.testing.assert_allclose(run.f, begin + run.time, rtol=1e-12)
    np.testing.assert_allclose(run.x, inverse(begin + run.time), rtol=1e-12)
    # y' = f up to the switch: f(x(0)) t + t²/2
    assert float(run.y[-1]) == pytest.approx(begin / 4.0 + 1.0 / 32.0, rel=1e-13)


@pytest.mark.parametrize("function", [cosh, sinh, atan, asin])
def test_functions_are_those_of_numpy(function):
    values = np.array([-0.7, 0.0, 0.3])
    name = {"atan": "arctan", "asin": "arcsin"}.get(
        function.__name__, function.__name__
    )
    np.testing.assert_array_equal(function(values), getattr(np, name)(values))


def test_logs_of_states_are_exact():
    falls = System(
        "log",
        states={"x": "1"},
        parameters={},
        regimes={"all": {}},
        field=lambda t, s, p, r: {"x": -log(s.x)},
        start={"x": 1.0},
    )
    assert float(falls.simulate(1.0).x[-1]) == 1.0


@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0])
def test_a_whole_exponent_that_is_a_parameter_may_have_any_base(exponent):
    system = System(
        "power",
        states={"x": "1", "y": "1"},
        parameters={"a": 1.0},
        regimes={"only": {}},
        field=lambda t, s, p, r: {"x": 1.0, "y": s.x**p.a},
        start={"x": 0.0, "y": 0.0},
    )
    for start in (0.0, -1.0):
        run = system.simulate(2.0, start={"x": start}, a=exponent)
        end = [each ** (exponent + 1.0) for each in (start + 2.0, start)]
        assert float(run.y[-1]) == pytest.approx((end[0] - end[1]) / (exponent + 1.0))
    # other exponents keep their logarithm
    run = system.simulate(2.0, start={"x": 1.0}, a=1.5)
    assert float(run.y[-1]) == pytest.approx((3.0**2.5 - 1.0) / 2.5, rel=1e-12)
