"""Fields of single regimes, which mean nothing in others, and powers that have no series."""

import re

import numpy as np
import pytest
from scipy.integrate import quad

from squealpipe import Switch, System
from squealpipe.functions import log, sqrt
from squealpipe.schema import Outcome

tank = System(
    "tank between two levels",
    states={"h": "1"},
    parameters={"rate": 1.0},
    regimes={"above": {}, "below": {}},
    field={
        "above": lambda t, s, p, r: {"h": -p.rate * sqrt(s.h)},
        "below": lambda t, s, p, r: {"h": -p.rate * sqrt(-s.h)},
    },
    switches=[
        Switch(
            "low",
            "above",
            lambda t, s, p, r: s.h - 0.01,
            "below",
            reset=lambda t, s, p, r: {"h": -s.h},
        )
    ],
    start={"h": 1.0, "regime": "above"},
)


def test_torricellis_tank_drains_by_the_root_of_its_own_side():
    """√h falls at rate/2 up to the switch at √h = 0.1; then √−h grows likewise."""
    run = tank.simulate(4.0, sensitivity=["rate"])
    assert int(run.outcome) == Outcome.converged
    np.testing.assert_allclose(run.event_time, [1.8], rtol=1e-14)
    assert float(run.h[-1]) == pytest.approx(-((0.1 + 1.1) ** 2), rel=1e-13)
    # h = −(rate t/2 − 0.8)² at the end
    assert float(run.h_by_rate[-1]) == pytest.approx(-2.0 * 1.2 * 2.0, rel=1e-12)


def test_runs_side_by_side_are_in_regimes_of_their_own():
    rates = np.linspace(0.5, 1.5, 9)
    run = tank.ensemble(4.0, rate=rates, horizon=True)
    assert (run.outcome == Outcome.converged).all()
    np.testing.assert_allclose(run.first_low, 1.8 / rates, rtol=1e-14)
    np.testing.assert_allclose(run.h, -((2.0 * rates - 0.8) ** 2), rtol=1e-12)


def hertz(force):
    """A ball of speed 1 and a wall at x = 0.5."""
    return System(
        "Hertz contact",
        states={"x": "1", "v": "1"},
        parameters={"k": 1.0},
        regimes={"free": {}, "contact": {}},
        field={
            "free": lambda t, s, p, r: {"x": s.v, "v": 0.0},
            "contact": lambda t, s, p, r: {"x": s.v, "v": -p.k * force(s.x)},
        },
        switches=[
            Switch("hit", "free", lambda t, s, p, r: 0.5 - s.x, "contact"),
            Switch("off", "contact", lambda t, s, p, r: s.x - 0.5, "free"),
        ],
        start={"x": 0.0, "v": 1.0, "regime": "free"},
    )


@pytest.mark.release
def test_a_power_whose_base_vanishes_at_entry_is_refused_and_its_remedy_runs():
    with pytest.raises(ValueError, match="'hit' enters regime 'contact'") as refusal:
        hertz(lambda x: (x - 0.5) ** 1.5)
    smooth = re.search("write (.*), which is smooth", str(refusal.value))[1]
    force = eval(f"lambda x: {smooth}")  # noqa: S307
    run = hertz(force).simulate(10.0)
    assert int(run.outcome) == Outcome.converged
    depth = 1.25**0.4  # where 2/5 depth^5/2 is the energy 1/2
    share, _ = quad(lambda z: 1.0 / np.sqrt(1.0 - z**2.5), 0.0, 1.0)
    exact = [0.5, 0.5 + 2.0 * depth * share]
    np.testing.assert_allclose(run.event_time, exact, atol=2e-6)
    with pytest.raises(ValueError, match="has its log"):
        hertz(lambda x: log(x - 0.5))


def test_powers_that_vanish_elsewhere_are_taken():
    hertz(lambda x: ((x - 0.5) ** 2 + 1e-20) ** 0.75)
    hertz(lambda x: sqrt(x + 0.1) - (x - 0.5) ** 2)
    hertz(lambda x: (x - 0.5) ** 3)
