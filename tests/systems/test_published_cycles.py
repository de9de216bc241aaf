"""Cycles of published systems against the return maps of an integrator apart."""

import numpy as np
import pytest

from squealpipe.schema import Outcome
from tests.oracles.definition import Definition
from tests.systems.published_cycles import ANY, CASES, impact_oscillator

FIRST = (7, 17, 28)
"""Chaos, a forced cycle of three periods, and one without forcing."""
LONG = (47,)
"""Sixteen periods with impacts: an error of 1e-10 has grown to the motion's size."""


@pytest.mark.parametrize(
    "number",
    [
        pytest.param(n, marks=[] if n in FIRST else pytest.mark.release)
        for n in range(len(CASES))
        if n not in LONG
    ],
)
def test_a_cycle_returns_with_its_multipliers(number):
    case = CASES[number]
    system, parameters = case.system, case.parameters
    cycle = system.limit_cycle(start=case.start, **parameters)
    assert (cycle.outcome == Outcome.unsettled) == (case.settles == 0)
    if cycle.outcome == Outcome.unsettled:
        assert np.isnan(cycle.period)
        return
    assert case.settles in {ANY, int(cycle.periods)}
    assert (cycle.outcome == Outcome.family_member) == case.family
    if np.isnan(cycle.period):
        cycle = system.limit_cycle(
            start=case.start, periods=int(cycle.periods), **parameters
        )
    truth = Definition(
        system,
        parameters,
        rtol=1e-10,
        atol=1e-10 * system.sizes_in(system.parameters),
        max_step=case.longest,
    )
    start = np.array([float(cycle[f"{name}_start"]) for name in system.states])
    extent = [float(cycle[f"{n}_max"] - cycle[f"{n}_min"]) for n in system.states]
    regime = list(system.regimes)[int(cycle.start_regime)]

    def after(state):
        return truth.run(state, regime, float(cycle.period))[1]

    np.testing.assert_allclose((after(start) - start) / extent, 0.0, atol=1e-7)
    steps = 1e-5 * np.diag(extent)
    slopes = [(after(start + h) - after(start - h)) / (2.0 * h.sum()) for h in steps]
    expected = np.linalg.eigvals(np.array(slopes).T)
    ours = cycle.multiplier_real.values + 1j * cycle.multiplier_imag.values
    for multiplier in ours:
        assert np.abs(expected - multiplier).min() < 1e-3
    largest = np.sort(np.abs(expected))[-1 - (system.period is None)]
    assert int(cycle.stable) == int(largest < 1.0 - 1e-4 and not case.family)


def growth(rates, state, step, count):
    """Growth rate of a small difference, by the classical Runge–Kutta method."""
    pair = np.array([state, state]).T + np.array([0.0, 1e-8])
    logs = 0.0
    for number in range(count):
        t = number * step
        k1 = rates(t, pair)
        k2 = rates(t + 0.5 * step, pair + 0.5 * step * k1)
        k3 = rates(t + 0.5 * step, pair + 0.5 * step * k2)
        k4 = rates(t + step, pair + step * k3)
        pair = pair + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        if number % 20 == 19:
            difference = pair[:, 1] - pair[:, 0]
            size = np.linalg.norm(difference)
            pair[:, 1] = pair[:, 0] + 1e-8 / size * difference
            logs += np.log(size / 1e-8) * (number > 2000)
    return logs / ((count - 2000) * step)


@pytest.mark.release
def test_what_settles_on_nothing_is_chaos():
    """Rössler's exponent is 0.071, Lorenz's 0.906; the pendulum's at 1.15 is positive."""

    def pendulum(t, z):
        x, v = z
        return np.array([v, -np.sin(x) - 0.5 * v + 1.15 * np.cos(2.0 / 3.0 * t)])

    def roessler(t, z):
        x, y, w = z
        return np.array([-y - w, x + 0.2 * y, 0.2 + w * (x - 5.7)])

    def lorenz(t, z):
        x, y, w = z
        return np.array([10.0 * (y - x), x * (28.0 - w) - y, x * y - 8.0 / 3.0 * w])

    assert growth(pendulum, [0.1, 0.0], 0.05, 20_000) > 0.05
    assert growth(roessler, [1.0, 1.0, 0.0], 0.02, 60_000) == pytest.approx(
        0.071, abs=0.02
    )
    assert growth(lorenz, [1.0, 1.0, 20.0], 0.005, 40_000) == pytest.approx(
        0.906, abs=0.1
    )


def test_an_unstable_cycle_with_one_impact_has_its_closed_form():
    """x″ + x = cos 2.8 t, a stop at 0, restitution 0.8: it hits at 0.336177269976."""
    omega, restitution = 2.8, 0.8
    a, b, phase = 0.20157931, -0.26858519, 3.05937676

    def motion(t):
        share = 1.0 / (1.0 - omega**2)
        place = share * np.cos(omega * t) + a * np.cos(t) + b * np.sin(t)
        speed = -omega * share * np.sin(omega * t) - a * np.sin(t) + b * np.cos(t)
        return place, speed

    place, speed = motion(2.0 * np.pi / omega)  # from the impact at phase/ω on
    cycle = impact_oscillator.limit_cycle(
        guess={"x": place, "v": speed},
        omega=omega,
        amplitude=1.0,
        damping=0.0,
        gap=0.0,
        restitution=restitution,
    )
    assert cycle.outcome == Outcome.converged
    assert int(cycle.stable) == 0
    assert float(cycle.event_time[0]) == pytest.approx(phase / omega, abs=1e-7)
    leaves = -restitution * 0.336177269976
    assert float(cycle.event_v[0]) == pytest.approx(leaves, abs=1e-11)
    multipliers = np.sort(cycle.multiplier_real.values)
    np.testing.assert_allclose(multipliers, [-2.95809507, -0.21635545], atol=1e-8)
