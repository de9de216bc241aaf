"""A jump or a pole inside an expression ends a run by its name; kinks do not."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from squealpipe import System, labels
from squealpipe import functions as f
from tests.systems.hidden_jumps import JUMPS, SMOOTH, START, integral

NAMED = {"discontinuity", "not_finite"}
FEW = (
    "atan tan",
    "sawtooth t",
    "sign sin",
    "sign x",
    "sign x shifted",
    "tiny sign",
    "atan inverse",
    "ratio of kinks",
)
"""Those of the issue, and one of each kind."""


def integrator(expressions):
    """A state that grows with the time, and one for the integral of each expression."""
    names = [f"v{i}" for i in range(len(expressions))]
    return System(
        "integrals",
        states={"x": "1", **dict.fromkeys(names, "1")},
        parameters={},
        regimes={"only": {}},
        field=lambda t, s, p, r: {
            "x": 1.0,
            **{n: e(s.x, t, f) for n, e in zip(names, expressions, strict=True)},
        },
        start={"x": START, **dict.fromkeys(names, 0.0)},
    )


def integrated(expression, t_end):
    """How a run ended, and the integral that it found."""
    run = integrator([expression]).simulate(t_end, times=np.array([0.0, t_end]))
    return labels(run.outcome).item().replace(" ", "_"), run.v0.values[-1]


def right(expression, t_end):
    """The integral without warnings of where it does not exist."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return integral(expression, t_end)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in FEW else pytest.mark.release)
        for name in JUMPS
    ],
)
def test_a_jump_inside_an_expression_is_named_or_crossed_exactly(name):
    outcome, value = integrated(JUMPS[name], 5.0)
    if outcome not in NAMED:
        assert outcome == "converged"
        truth = right(JUMPS[name], 5.0)
        assert abs(value - truth) < 3e-12 * max(1.0, abs(truth))


def test_the_run_ends_where_the_expression_jumps():
    run = integrator([JUMPS["atan tan"]]).simulate(100.0, times=np.array([0.0, 1.0]))
    assert labels(run.outcome).item() == "discontinuity"
    assert abs(float(run.end_time) - (0.5 * np.pi - START)) < 1e-12


def test_two_jumps_that_cancel_at_the_end_of_a_step_are_seen():
    # the sign of (u − a)(u − b) is the same before and after both
    for apart in (1e-1, 1e-3, 1e-6):

        def window(u, t, f, apart=apart):
            product = (u - 1.3) * (u - 1.3 - apart)
            return product / f.sqrt(product * product)

        outcome, _ = integrated(window, 5.0)
        assert outcome in NAMED, apart


def test_kinks_are_crossed_and_two_that_cancel_are_seen():
    names = ["kink", "kink sin", "triangle", "max", "kink in exp", "two kinks"]
    chosen = [SMOOTH[name] for name in names]
    run = integrator(chosen).simulate(5.0, times=np.array([0.0, 5.0]))
    assert labels(run.outcome).item() == "converged"
    for i, (name, expression) in enumerate(zip(names, chosen, strict=True)):
        assert abs(run[f"v{i}"].values[-1] - right(expression, 5.0)) < 2e-12, name


@pytest.mark.release
@pytest.mark.parametrize("name", SMOOTH)
def test_what_does_not_jump_is_not_refused(name):
    outcome, value = integrated(SMOOTH[name], 5.0)
    truth = right(SMOOTH[name], 5.0)
    assert outcome == "converged"
    assert abs(value - truth) < 3e-12 * max(1.0, abs(truth))


wavy = integrator([lambda u, t, f: f.sqrt((u - 1.3) ** 2 * (2.0 + f.sin(3.0 * t)))])


@settings(max_examples=10, deadline=None)
@given(st.floats(-20.0, 1.0), st.floats(1.5, 30.0))
def test_a_kink_is_crossed_from_anywhere(start, end):
    """One that is not at the origin, and that a regime of the time changes."""
    run = wavy.simulate(
        end - start, start={"x": start}, times=np.array([0.0, end - start])
    )
    assert labels(run.outcome).item() == "converged"

    def expression(t):
        return abs(start + t - 1.3) * np.sqrt(2.0 + np.sin(3.0 * t))

    nodes, weights = np.polynomial.legendre.leggauss(20)
    truth = 0.0
    for first, last in ((0.0, 1.3 - start), (1.3 - start, end - start)):
        edges = np.linspace(first, last, 60)
        half = 0.5 * np.diff(edges)[:, None]
        times = edges[:-1, None] + half * (1.0 + nodes)
        truth += float((half * weights * expression(times)).sum())
    assert abs(run.v0.values[-1] - truth) < 1e-12 * max(1.0, truth)


def test_steps_that_shrink_without_end_have_a_name_at_once():
    """Painlevé's rod, sliding on its tip, comes to where its normal force is 0/0.

    Motions nearby are led there (Génot and Brogliato 1999). A run took 10⁷ steps of 1e-17 s, for
    35 s of CPU time, and ended as ``step_limit``.
    """

    def parts(s, p):
        denominator = 1.0 + 3.0 * f.cos(s.angle) * (
            f.cos(s.angle) - p.mu * f.sin(s.angle)
        )
        return 9.81 - s.turn * s.turn * f.sin(s.angle), denominator

    def field(t, s, p, r):
        numerator, denominator = parts(s, p)
        normal = numerator / denominator
        lever = f.cos(s.angle) - p.mu * f.sin(s.angle)
        return {"angle": s.turn, "turn": -3.0 * normal * lever}

    rod = System(
        "Painlevé's rod",
        states={"angle": "rad", "turn": "rad/s"},
        parameters={"mu": 1.5626623997021602},
        regimes={"slides": {}},
        field=field,
        stops={"lifts": lambda t, s, p, r: parts(s, p)[0] / parts(s, p)[1]},
        start={"angle": 0.387203737525035, "turn": 1.304230356637408},
    )
    run = rod.simulate(20.0, max_steps=2000)
    assert labels(run.outcome).item() == "discontinuity"
    assert float(run.end_time) == pytest.approx(0.38753819693331754, abs=1e-12)
    assert labels(rod.limit_cycle(max_steps=2000).outcome).item() == "discontinuity"
    few = {"max_steps": 10}
    assert labels(rod.simulate(20.0, **few).outcome).item() == "step limit"
    grid = {"start": {"angle": np.array([0.3, 0.387203737525035])}}
    for many in (rod.ensemble, rod.basin):
        assert (
            labels(many(20.0, workers=1, **grid, **few).outcome).values.tolist()
            == ["step limit"] * 2
        )
