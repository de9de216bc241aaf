"""The public methods that we compare with, themselves checked by closed forms."""

import numpy as np
import pytest

from squealpipe.models.a1_automaton import EventKind
from tests.former import FORMER
from tests.oracles.a1_scipy import simulate_scipy


def test_first_separation_has_the_closed_form_time():
    """K = diag(k, k): y = κ/(1+κ)(1 − cos √(1+κ) t) meets l_pre at a known time."""
    p = FORMER.with_(k3=2.0)
    run = simulate_scipy(
        p,
        np.pi / 2,
        np.pi,
        t_end=10.0,
        tol=1e-12,
        stop_at=EventKind.separation,
        linear_springs=True,
    )
    omega = np.sqrt(3.0)
    assert run.event_times == pytest.approx([np.arccos(1 - 1.5) / omega], abs=1e-9)


def test_stick_and_release_have_closed_form_times():
    """V small: x is caught at ẋ = V and carried until k x = μN (y at rest at its equilibrium)."""
    p = FORMER.with_(k3=0.75, mu=0.3, belt_speed=0.05)
    y = 0.75 / 1.75
    force = 0.3 * 0.75 * (1 - y)
    t_end = 8.0
    run = simulate_scipy(
        p,
        np.pi / 2,
        np.pi,
        t_end=t_end,
        tol=1e-12,
        initial_state=(0.0, y, 0.05, 0.0),
        linear_springs=True,
    )
    assert run.regimes[:2] == [2, 0]
    assert run.event_kinds[0] == EventKind.release
    assert run.event_times[0] == pytest.approx(force / 0.05, rel=1e-8)
    # from there x = μN + V sin t, which only touches belt speed again
    assert run.state[0] == pytest.approx(force + 0.05 * np.sin(t_end - force / 0.05), abs=1e-10)


@pytest.mark.parametrize("method", ["RK45", "LSODA", "Radau"])
def test_methods_agree_with_one_another(method):
    run = {
        name: simulate_scipy(FORMER, np.pi, np.pi, t_end=10.0, tol=1e-9, method=name)
        for name in ("DOP853", method)
    }
    assert run[method].event_kinds == run["DOP853"].event_kinds
    np.testing.assert_allclose(run[method].state, run["DOP853"].state, atol=1e-5)
