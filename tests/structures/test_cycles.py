"""Cycles of structures against an integrator apart: matrix exponentials from event to event.

A cycle has to close after its period there, and its multipliers are those of the map over a period,
whose derivative is a central difference.
"""

import numpy as np
import pytest

from squealpipe import Contact, Structure
from tests.oracles.many_contacts import ManyContacts

SIDES = {"slip_slower": 1, "slip_faster": -1, "stick": 0, "separated": 2}


def two_modes(**options):
    """Two modes that flutter by friction, with a contact that opens."""
    stiffness = np.array([[2.0, -1.0], [-1.0, 2.0 / 3.0]])
    contact = Contact("c", {1: -1.0}, {0: 1.0}, stiffness=4.0 / 3.0, preload=1.0)
    return Structure(
        np.eye(2), stiffness, 0.04 * np.eye(2), contacts=[contact],
        **{"mu": 1.0, "belt_speed": -5.0} | options,
    )  # fmt: skip


def three_contacts(**options):
    """Three contacts on two modes: their sliding directions are dependent."""
    base = two_modes(**options)
    more = [
        Contact("d", {1: -0.6}, {0: 0.8}, stiffness=0.3, preload=0.2),
        Contact("e", {1: -0.2, 0: 0.1}, {0: 1.0, 1: 0.3}, stiffness=0.2, preload=0.15),
    ]
    return base.with_(contacts=[*base.contacts, *more])


def settled(structure):
    """The cycle that a small start settles on."""
    system = structure.system()
    run = system.simulate(500.0, start={"q1": 1e-2}, times=[500.0])
    return system, system.limit_cycle(
        start={name: float(run[name][-1]) for name in system.states}
    )


def after_a_period(structure, state, sides, period):
    """The state after a period, and the sides of the contacts."""
    size = structure.size
    truth = ManyContacts(structure, state[:size], state[size:])
    truth.side = list(sides)
    truth.run(period, period / 40)
    return truth.state, truth.side


def multipliers_apart(structure, state, sides, period, sizes):
    """Eigenvalues of the derivative of the state after a period, by central differences."""
    columns = []
    for i, size in enumerate(sizes):
        step = 1e-5 * size * np.eye(len(sizes))[i]
        ends = [
            after_a_period(structure, state + sign * step, sides, period)[0]
            for sign in (1.0, -1.0)
        ]
        columns.append((ends[0] - ends[1]) / 2e-5 / size)
    return np.linalg.eigvals(np.array(columns).T)


@pytest.mark.parametrize(
    "structure",
    [two_modes(), two_modes(belt_speed=-0.1, mu_static=1.3), three_contacts()],
    ids=["one contact", "stick", "dependent directions"],
)
def test_a_cycle_closes_and_grows_as_an_integrator_apart_says(structure):
    system, cycle = settled(structure)
    period = float(cycle.period)
    state = np.array([float(cycle[f"{name}_start"]) for name in system.states])
    names = [*system.regimes]
    own = np.atleast_1d(cycle.start_regime.values)
    sides = [SIDES[names[regime].partition("_")[2]] for regime in own]
    sizes = np.array(
        [float(cycle[f"{n}_max"] - cycle[f"{n}_min"]) for n in system.states]
    )
    end, after = after_a_period(structure, state, sides, period)
    assert after == sides
    assert (end - state) / sizes == pytest.approx(np.zeros(len(sizes)), abs=1e-10)
    found = cycle.multiplier_real.values + 1j * cycle.multiplier_imag.values
    truth = multipliers_apart(structure, state, sides, period, sizes)
    for multiplier in truth:
        assert np.abs(found - multiplier).min() < 1e-5
    assert cycle.sizes["event"] >= 2


def test_derivatives_of_a_run_are_those_of_an_integrator_apart():
    structure, t = two_modes(belt_speed=-0.1, mu_static=1.3), 20.0
    system = structure.system()
    start = np.array([1.0, 0.5, 0.5, -1.0])
    named = dict(zip(system.states, start, strict=True))
    run = system.simulate(
        t, start=named, times=[t], sensitivity=["mu", "belt_speed", "v10"]
    )
    assert run.sizes["event"] > 4
    sides = [1 if speed > 0 else -1 for speed in ManyContacts(
        structure, start[:2], start[2:]
    ).speed(start)]  # fmt: skip

    def end(state=start, **changes):
        return after_a_period(structure.with_(**changes), state, sides, t)[0]

    step = 1e-6
    pairs = {
        "mu": (end(mu=1.0 + step), end(mu=1.0 - step)),
        "belt_speed": (end(belt_speed=-0.1 + step), end(belt_speed=-0.1 - step)),
        "v10": [end(start + sign * step * np.eye(4)[2]) for sign in (1.0, -1.0)],
    }
    for name, (high, low) in pairs.items():
        found = np.array([float(run[f"{s}_by_{name}"][-1]) for s in system.states])
        truth = (high - low) / (2.0 * step)
        scale = np.abs(truth).max() * system.sizes_in({}) / system.sizes_in({}).max()
        assert found / scale == pytest.approx(truth / scale, abs=1e-5)
    sizes = system.sizes_in({})
    many = system.ensemble(t, start=named, horizon=True, tol=1e-12)
    aside = 1e-6 * sizes / 2.0  # a perturbation of length 1 in units of the sizes
    apart = (end(start + aside) - end(start - aside)) / (2e-6 * sizes)
    growth = float(many.lyapunov_exponent) * t
    assert growth == pytest.approx(np.log(np.linalg.norm(apart)), abs=1e-4)
    assert np.isnan(float(many.predictability_horizon))  # e²⁰ is not reached
