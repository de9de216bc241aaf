"""Branches of cycles of structures: derivatives along legs, and contacts side by side."""

import numpy as np
import pytest
from scipy.linalg import expm

from squealpipe import Contact, Structure
from squealpipe.systems.cycles.variational import leg_derivatives
from tests.oracles.structure_answers import OPEN, Motion

UNITS = 1e4
"""rad/s of a mode."""


def two_modes(mu, beside=False):
    """Hoffmann's two modes with a contact that can open, and one beside it that keeps still."""
    size = 4 if beside else 2
    stiffness = np.zeros((size, size))
    stiffness[:2, :2] = np.array([[2.0, -1.0], [-1.0, 2 / 3]])
    contacts = [
        Contact("c", {1: -1.0}, {0: 1.0}, stiffness=4 / 3 * UNITS**2, preload=2e3)
    ]
    if beside:
        stiffness[2:, 2:] = np.diag([3.0, 1.0])
        contacts.append(
            Contact("d", {3: -1.0}, {2: 1.0}, stiffness=UNITS**2, preload=1e3)
        )
    return Structure(
        np.eye(size),
        stiffness * UNITS**2,
        modal_damping=0.02,
        contacts=contacts,
        mu=mu,
        belt_speed=-2.0,
    )


def after(structure, regimes, state, time):
    """The state after a leg, and its derivative by the state before, by an integrator apart."""
    leg = expm(Motion(structure).flow(regimes)[0] * time)
    return (leg @ np.append(state, 1.0))[:-1], leg[:-1, :-1]


@pytest.mark.parametrize(
    ("names", "regimes"),
    [
        (("slip_slower", "slip_slower"), (1, 1)),
        (("separated", "slip_slower"), (OPEN, 1)),
        (("stick", "slip_slower"), (0, 1)),
    ],
)
def test_derivatives_along_a_leg_are_those_of_a_matrix_exponential(names, regimes):
    structure = two_modes(0.8, beside=True)
    system = structure.system()
    state = np.random.default_rng(1).standard_normal(8) * system.sizes_in({})
    time = 2.3 / UNITS
    flow, places = system.flow(("mu",)), list(system.regimes)
    number = system.joint.number(
        [places.index(f"{c}_{n}") for c, n in zip("cd", names, strict=True)]
    )
    path = flow.run(
        system.parameters, state[None], [number], np.zeros(1), np.array([time])
    )
    found = leg_derivatives(flow, system.parameters, path)[0]
    end, by_state = after(structure, regimes, state, time)
    scale = system.sizes_in({})
    assert path.ends[0] / scale == pytest.approx(end / scale, abs=1e-12)
    np.testing.assert_allclose(
        found[:, :8] * scale / scale[:, None],
        by_state * scale / scale[:, None],
        atol=1e-12,
    )
    # a central difference; what is left of it falls with the square of its step
    ends = [
        after(structure.with_(mu=mu), regimes, state, time)[0] for mu in (0.79, 0.81)
    ]
    assert found[:, 8] / scale == pytest.approx(
        (ends[1] - ends[0]) / 0.02 / scale, abs=2e-4
    )


def test_a_branch_of_one_contact_is_the_same_with_one_beside_it_that_keeps_still():
    alone, both = two_modes(1.0).system(), two_modes(1.0, beside=True).system()
    settled = alone.simulate(0.05, start={"q1": 1e-5})
    ends = {name: float(settled[name][-1]) for name in alone.states}
    branches = []
    for system in (alone, both):
        guess = dict(ends)
        if (
            system is both
        ):  # where friction holds it: μ N over the stiffness along the belt
            guess |= {"q3": -1e3 / (3.0 * UNITS**2), "q4": 0.0}
        cycle = system.limit_cycle(guess=guess)
        branches.append(system.cycle_branch("mu", 0.99, start=cycle, n_points=6))
    one, other = (branch.isel(point=-1) for branch in branches)
    assert float(one.mu) == float(other.mu) == 0.99
    assert float(other.period) == pytest.approx(float(one.period), rel=1e-11)
    own = one.multiplier_real.values + 1j * one.multiplier_imag.values
    of_both = other.multiplier_real.values + 1j * other.multiplier_imag.values
    for multiplier in own:
        assert np.abs(of_both - multiplier).min() < 1e-9
