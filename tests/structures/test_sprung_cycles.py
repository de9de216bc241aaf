"""Branches, curves and basins of contacts with tangential springs, against an integrator apart."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from squealpipe import Contact, Structure, labels
from tests.oracles.many_contacts import OPEN, SIDES, ManyContacts


def two_modes(mu):
    """Two modes that flutter by friction, with a contact that opens and sticks by a spring."""
    contact = Contact("c", {1: -1.0}, {0: 1.0}, 4 / 3, 1.0, tangential_stiffness=1.0)
    stiffness = np.array([[2.0, -1.0], [-1.0, 2.0 / 3.0]])
    return Structure(
        np.eye(2),
        stiffness,
        0.04 * np.eye(2),
        contacts=[contact],
        mu=mu,
        belt_speed=-0.15,
    )


@cache
def branch_down():
    """The system, and its cycles from friction 0.64 down to a fold and a grazing."""
    system = two_modes(mu=0.64).system()
    cycle = system.limit_cycle(start={"q1": 2.0}, t_settle=2000.0)
    return system, system.cycle_branch("mu", 0.3, start=cycle, n_points=14)


def at(label):
    """The first point of the branch with a label."""
    _, branch = branch_down()
    return branch.isel(point=int(np.flatnonzero(labels(branch.label) == label)[0]))


class Apart:
    """Runs by own code from the start of a cycle."""

    def __init__(self, point, mu):
        system, _ = branch_down()
        regime = [*system.regimes][int(point.start_regime.values.ravel()[0])]
        self.structure, self.side = two_modes(mu), SIDES[regime.removeprefix("c_")]
        self.start = np.array([float(point[f"{name}_start"]) for name in system.states])
        self.period = float(point.period)

    def after(self, time, aside=0.0):
        """Instants of events with the side of the contact after each, and own code at the end."""
        contacts = ManyContacts(self.structure, np.zeros(2), np.zeros(2))
        contacts.state, contacts.side = self.start + aside, [self.side]
        events = contacts.run(time, 0.2)
        return [(at, side) for at, (side,) in events], contacts


def test_stick_begins_where_a_spring_just_holds_a_landing():
    system, _ = branch_down()
    onset = at("stick onset")
    guess = {name: float(onset[f"{name}_start"]) for name in system.states}
    left = []
    for share, count in ((0.9995, 1), (1.0005, 0)):
        mu = share * float(onset.mu)
        apart = Apart(system.limit_cycle(guess=guess, mu=mu), mu)
        events, end = apart.after(apart.period)
        assert end.state == pytest.approx(apart.start, abs=1e-9)
        sides = [side for _, side in events]
        # from slip, as a landing that sticks is none
        assert [*pairwise(sides)].count((1, 0)) == 0
        assert [*pairwise(sides)].count((-1, 0)) == count
        lands = events[sides.index(OPEN) + 1][0]
        _, contacts = apart.after(lands * (1.0 - 1e-12))
        state = np.append(contacts.state, 1.0)
        limit = mu * (contacts.rate_row(0) @ state)
        left.append(abs(contacts.speed_row(0) @ state) - limit)
    # the friction at which nothing is left lies where a line through both crosses zero
    between = left[0] / (left[0] - left[1])
    assert 0.9995 + 0.001 * between == pytest.approx(1.0, abs=2e-5)


def test_multipliers_are_those_of_runs_apart_and_one_is_1_at_a_fold():
    fold = at("fold")
    apart, step = Apart(fold, float(fold.mu)), 1e-5
    slopes = [
        np.subtract(
            *(apart.after(apart.period, sign * way)[1].state for sign in (1, -1))
        )
        / step
        for way in 0.5 * step * np.eye(5)
    ]
    polynomial = np.poly(np.array(slopes).T)
    # 1 is a root twice: of the motion itself, and of the fold
    assert np.polyval(polynomial, 1.0) == pytest.approx(0.0, abs=1e-6)
    assert np.polyval(np.polyder(polynomial), 1.0) == pytest.approx(0.0, abs=1e-5)
    told = fold.multiplier_real.values + 1j * fold.multiplier_imag.values
    assert np.poly(told).real == pytest.approx(polynomial, abs=1e-5)


@pytest.mark.parametrize(
    "label",
    [
        "stick onset",
        *(
            pytest.param(each, marks=pytest.mark.release)
            for each in ("fold", "grazing")
        ),
    ],
)
def test_curves_over_the_preload_are_those_over_the_speed(label):
    """Displacements and speeds of a motion grow in proportion to the preload."""
    system, _ = branch_down()
    ranges = {"preload": (0.98, 1.02), "belt_speed": (-0.15 / 0.98, -0.15 / 1.02)}
    by_load, by_speed = (
        system.cycle_curve(
            label.replace(" ", "_"), ("mu", name), start=at(label), to={name: limits}
        )
        for name, limits in ranges.items()
    )
    assert labels(by_load.outcome).values.tolist() == ["end of range"] * 2
    ends = [np.sort(curve.mu.values[[0, -1]]) for curve in (by_load, by_speed)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-11)
    assert ends[0][1] - ends[0][0] > 1e-5


def test_hammering_and_sliding_lie_side_by_side():
    system = two_modes(mu=0.68).system()
    starts = np.array([0.01, 1.0, 2.0])
    basin = system.basin(4000.0, start={"q1": starts})
    assert labels(basin.motion).values.tolist() == ["rest", "rest", "cycle"]
    assert basin.attractor.values.tolist() == [0, 0, 1]
    # (K + k (n + σ μ t) nᵀ) q = (n + σ μ t) P − n P with σ = −1
    push, normal = np.array([-0.68, -1.0]), np.array([0.0, -1.0])
    stiffness = np.array([[2.0, -1.0], [-1.0, 2.0 / 3.0]])
    steady = np.linalg.solve(stiffness + 4 / 3 * np.outer(push, normal), push - normal)
    assert basin.q2_max.values[:2] == pytest.approx(steady[1], rel=1e-9)
    assert basin.c_stretch_max.values[:2] == pytest.approx(
        -0.68 * (1.0 + 4 / 3 * steady[1]), rel=1e-9
    )
    cycle = system.limit_cycle(start={"q1": 2.0}, t_settle=4000.0)
    assert float(cycle.period) == pytest.approx(float(basin.period[2]), rel=1e-9)
    apart = Apart(cycle, 0.68)
    _, end = apart.after(apart.period)
    assert end.state == pytest.approx(apart.start, abs=1e-9)
    heights = [end.state[1]]
    for _ in range(300):
        end.run(apart.period / 300, 0.2)
        heights.append(end.state[1])
    assert max(heights) == pytest.approx(float(basin.q2_max[2]), abs=1e-4)
