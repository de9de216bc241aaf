"""Cycles under laws of the user's own: the limit of stick changes with what the law reads."""

import numpy as np
import pytest
from scipy.optimize import brentq

from squealpipe import Parameters, cycle_branch, cycle_curve, limit_cycle, stability_map
from squealpipe.brake.assess.sliding import Design
from squealpipe.brake.cycles.cycle import cycle_from
from squealpipe.codes import Event
from squealpipe.parameters import NUMBERS_OF_A1
from squealpipe.systems.branch_labels import Label
from squealpipe.systems.cycles.branch import first_point
from tests.former import FORMER
from tests.oracles.differences import assert_jacobian

ANGLES = 0.1 * np.pi, 0.5 * np.pi
LAW = """
def coefficient(speed, p):
    return p.mu*(1 + 0.5/(1 + speed**2*4))
"""
TABLE = "cubic 0:0.45 0.5:0.35 2:0.3"
STATE = ("x", "y", "vx", "vy")


@pytest.fixture(scope="module")
def falling():
    return Parameters(friction_law=LAW, belt_speed=0.5, damping1=0.05, damping2=0.05)


def start_of(point):
    return [float(point[f"{name}_start"]) for name in STATE]


@pytest.fixture(scope="module")
def branch(falling):
    return cycle_branch(falling, *ANGLES, parameter="mu", to=0.4, n_points=8)


def test_a_branch_in_mu_is_that_of_the_cycles_at_each_mu(falling, branch):
    assert float(branch.period[0]) == pytest.approx(7.290344960, abs=1e-8)
    for i in (0, branch.sizes["point"] - 1):
        point = branch.isel(point=i)
        there = falling.with_(mu=float(point.mu))
        cycle = limit_cycle(there, *ANGLES, guess=start_of(point))
        assert float(cycle.period) == pytest.approx(float(point.period), rel=1e-10)
        assert float(cycle.x_max) == pytest.approx(float(point.x_max), rel=1e-9)


def test_the_derivative_by_mu_is_that_of_two_cycles(falling):
    # the tangent of a branch is dT/dμ, so a cycle a little further along lies on it
    near = cycle_branch(
        falling, *ANGLES, parameter="mu", to=0.3 * (1 + 1e-6), n_points=4
    )
    further = limit_cycle(falling.with_(mu=0.3 * (1 + 1e-6)), *ANGLES)
    assert float(near.period[-1]) == pytest.approx(float(further.period), rel=1e-11)


@pytest.mark.release
@pytest.mark.parametrize(("label", "code"), [("stick_onset", 5), ("fold", 1)])
def test_a_curve_in_mu_is_where_branches_have_its_points(falling, label, code):
    over_speed = cycle_branch(
        falling, *ANGLES, parameter="belt_speed", to=1.5, n_points=60
    )
    curve = cycle_curve(
        falling,
        *ANGLES,
        label=label,
        parameters=("belt_speed", "mu"),
        start=over_speed,
        n_points=5,
    )
    assert curve.sizes["point"] >= 3
    assert np.ptp(curve.mu.values) > 1e-4
    for i in (0, -1):
        mu, speed = float(curve.mu[i]), float(curve.belt_speed[i])
        alone = cycle_branch(
            falling.with_(mu=mu), *ANGLES, parameter="belt_speed", to=1.5, n_points=30
        )
        onsets = alone.belt_speed.values[alone.label.values == code]
        assert np.abs(onsets / speed - 1.0).min() < 1e-8


def test_the_static_coefficient_is_followed_by_its_own_name():
    slow = FORMER.with_(belt_speed=1.0, damping1=0.02, damping2=0.02, mu_static=0.45)
    scene = 0.4 * np.pi, 0.6 * np.pi
    branch = cycle_branch(slow, *scene, parameter="mu_static", to=0.5, n_points=6)
    last = branch.isel(point=-1)
    assert float(last.mu_static) == pytest.approx(0.5)
    cycle = limit_cycle(
        slow.with_(mu_static=float(last.mu_static)), *scene, guess=start_of(last)
    )
    assert Event.stick in cycle.event_kind
    assert float(cycle.period) == pytest.approx(float(last.period), rel=1e-9)
    assert not np.isclose(branch.period[0], branch.period[-1], rtol=1e-6)


@pytest.mark.parametrize(
    ("change", "parameter", "why"),
    [
        ({}, "friction_speed", "coulomb"),
        ({"friction_law": "exponential"}, "friction_speed", "without mu_static"),
        ({"friction_law": TABLE}, "mu", "law stands for it"),
        ({"contact_law": "linear 0:0 1:1 2:3"}, "k3", "law stands for it"),
        ({"contact_law": "linear 0:0 1:1 2:3"}, "preload", "at one preload"),
        ({}, "damping3", "does not read it"),
        ({"friction_law": LAW.replace("p.mu", "0.3")}, "mu", "does not read it"),
    ],
)
def test_what_nothing_reads_is_not_followed(change, parameter, why):
    params = Parameters(**change)
    with pytest.raises(ValueError, match=f"{parameter} cannot vary.*{why}"):
        cycle_branch(params, *ANGLES, parameter=parameter, to=2.0)


PAD = Parameters(
    friction_law="exponential",
    mu_static=0.45,
    friction_speed=0.5,
    belt_speed=0.5,
    damping1=0.05,
    damping2=0.05,
)
"""Stick, slip, dashpots and a law that reads all of its numbers."""


@pytest.fixture(scope="module")
def pad():
    return PAD


@pytest.fixture(scope="module")
def cycle(pad):
    return cycle_from(Design(pad, *ANGLES))[0]


@pytest.mark.parametrize(
    "name", [*(name for name in NUMBERS_OF_A1 if getattr(PAD, name)), "alpha1"]
)
def test_cycles_change_with_each_parameter_as_their_equations_say(cycle, name):
    """By both stiffnesses and dashpots the equations' derivative was 0."""
    state, first = first_point(cycle, name, cycle.parts.values[name] * 1.1)
    known, step = state.point[:-1], 1e-6

    def equations(followed):
        values, jacobian = first.map.evaluate(np.append(known, followed))
        return values, jacobian[:, -1:]

    assert_jacobian(equations, state.point[-1:], step=step, rtol=1e-6, atol=1e-8)
    assert np.abs(equations(state.point[-1:])[1]).max() > 1e-4


@pytest.mark.release
@pytest.mark.parametrize("name", ["k1", "damping1"])
def test_an_onset_of_stick_is_followed_in_stiffness_and_damping(pad, name):
    over_speed = cycle_branch(pad, *ANGLES, parameter="belt_speed", to=1.0)
    curve = cycle_curve(
        pad,
        *ANGLES,
        label="stick_onset",
        parameters=("belt_speed", name),
        start=over_speed,
        n_points=7,
    )
    assert curve.sizes["point"] == 7
    value, speed = float(curve[name][-1]), float(curve.belt_speed[-1])
    assert value > getattr(pad, name) * 1.005
    there = pad.with_(**{name: value})
    alone = cycle_branch(there, *ANGLES, parameter="belt_speed", to=1.0)
    onsets = alone.belt_speed.values[alone.label.values == Label.stick_onset]
    assert onsets == pytest.approx([speed], rel=1e-10)


def test_a_branch_under_a_table_is_born_at_the_onset_of_a3():
    params = Parameters(
        friction_law="cubic 0:0.6 1:0.4 3:0.3",
        belt_speed=4.0,
        damping1=0.03,
        damping2=0.03,
        length1=1e6,
        length2=1e6,
    )

    def growth(speed):
        there = params.with_(belt_speed=speed)
        found = stability_map(there, *([angle] for angle in ANGLES))
        return found.growth_rate.item()

    onset = brentq(growth, 1.2, 3.0, xtol=1e-12)
    branch = cycle_branch(
        params, *ANGLES, parameter="belt_speed", to=1.2, start="onset", n_points=2
    )
    assert float(branch.belt_speed[0]) == pytest.approx(onset, abs=1e-3)
