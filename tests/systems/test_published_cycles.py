"""Cycles of published systems against the return maps of an integrator apart."""

import numpy as np
import pytest

from squealpipe.schema import Outcome
from tests.systems.published_cycles import CASES, Truth

TENTH = np.random.default_rng(42).permutation(len(CASES))[:6]
LONG = (47,)
"""Sixteen periods with impacts: an error of 1e-10 has grown to the motion's size."""


@pytest.mark.parametrize(
    "number",
    [
        pytest.param(n, marks=[] if n in TENTH else pytest.mark.release)
        for n in range(len(CASES))
        if n not in LONG
    ],
)
def test_a_cycle_returns_with_its_multipliers(number):
    system, parameters = CASES[number]
    cycle = system.limit_cycle(**parameters)
    if cycle.outcome == Outcome.unsettled:
        assert np.isnan(cycle.period)
        return
    if np.isnan(cycle.period):
        cycle = system.limit_cycle(periods=int(cycle.periods), **parameters)
    truth, period = Truth(system, parameters), float(cycle.period)
    start = np.array([float(cycle[f"{name}_start"]) for name in system.states])
    extent = [float(cycle[f"{n}_max"] - cycle[f"{n}_min"]) for n in system.states]
    regime = list(system.regimes)[int(cycle.start_regime)]

    def after(state):
        return truth.after(state, regime, period)

    np.testing.assert_allclose((after(start) - start) / extent, 0.0, atol=1e-7)
    steps = 1e-5 * np.diag(extent)
    slopes = [(after(start + h) - after(start - h)) / (2.0 * h.sum()) for h in steps]
    expected = np.linalg.eigvals(np.array(slopes).T)
    ours = cycle.multiplier_real.values + 1j * cycle.multiplier_imag.values
    for multiplier in ours:
        assert np.abs(expected - multiplier).min() < 1e-3
    family = cycle.outcome == Outcome.family_member
    largest = np.sort(np.abs(expected))[-1 - (system.period is None)]
    assert int(cycle.stable) == int(largest < 1.0 - 1e-4 and not family)
