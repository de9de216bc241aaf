"""Limit cycles of A1 and their branches, against published oscillators and differences."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from squealpipe import Parameters, cycle_branch, limit_cycle
from squealpipe.brake.a1.motion_system import brake_of, parameters_of_run
from squealpipe.brake.assess.sliding import Design
from squealpipe.brake.cycles.cycle import cycle_from
from squealpipe.brake.normal_form import exchanged
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.schema import Outcome
from squealpipe.systems.branch_labels import Label
from squealpipe.systems.cycles.guess import once_round
from squealpipe.systems.cycles.solution import Cycle
from tests.former import FORMER
from tests.oracles.a1_long_double import derivative_along
from tests.oracles.friction_oscillators import ANGLES, BSTAB, oscillator


def equilibrium(belt_speed):
    return 0.5 + 0.5 * math.exp(-2.0 * belt_speed)


STICK_SLIP = {1.25: (6.353748505, 5.614853916), 0.5: (6.929871535, 5.013270760)}
UNSTABLE = {1.25: (0.664228586, 0.08019692), 1.55: (1.436881604, 0.35659639)}


@pytest.mark.parametrize("speed", STICK_SLIP)
def test_stick_slip_cycle_of_a_published_oscillator(speed):
    """The error is that of the limit: it falls with the length of the springs."""
    errors = []
    for reach in (1e5, 1e6):
        cycle = limit_cycle(
            oscillator(reach, speed, **BSTAB), *ANGLES, guess=(1.5, 0.25, speed, 0)
        )
        assert cycle.outcome == Outcome.converged
        assert cycle.stable == 1
        period = float(cycle.period)
        slip = period * (1.0 - float(cycle.stick_fraction))
        errors.append(np.abs(np.array([period, slip]) - STICK_SLIP[speed]))
    assert errors[1].max() < 5e-6
    np.testing.assert_allclose(errors[0] / errors[1], 10.0, rtol=0.02)
    assert np.abs(cycle.multiplier_real).min() < 1e-9, "stick forgets one direction"


@pytest.mark.release
@pytest.mark.parametrize("cycles", [1, pytest.param(8, marks=pytest.mark.long)])
def test_trivial_multiplier_and_differences_of_the_return_map(cycles):
    generator = np.random.default_rng(5)
    checked = 0
    while checked < cycles:
        params = FORMER.with_(
            k2=generator.uniform(0.6, 1.6),
            length2=generator.uniform(3.0, 8.0),
            mu=generator.uniform(0.3, 0.7),
            damping1=generator.uniform(0.01, 0.05),
            belt_speed=generator.choice([-1.0, 1.0]) * generator.uniform(0.3, 3.0),
            damping2=generator.uniform(0.01, 0.05),
            mu_static=generator.uniform(0.7, 0.9),
        )
        angles = generator.uniform(0.2, 2.9, 2)
        cycle = limit_cycle(params, *angles, t_settle=6000.0)
        if cycle.outcome != Outcome.converged:
            assert np.isnan(cycle.period)
            continue
        checked += 1
        multipliers = cycle.multiplier_real.values + 1j * cycle.multiplier_imag.values
        # round-off grows by the strongest multiplier on the way round
        assert abs(multipliers[0] - 1.0) < max(1e-9, 1e-13 * np.abs(multipliers).max())
        start = np.array(
            [float(cycle[f"{name}_start"]) for name in ("x", "y", "vx", "vy")]
        )
        given = {"t_end": float(cycle.period), "initial_state": start}
        # round-off of the difference counts in a weak cycle, its curvature in a strong one
        given["step"] = 1e-8 if np.abs(multipliers).max() < 100.0 else 1e-9
        found = [derivative_along(params, *angles, unit, **given) for unit in np.eye(4)]
        distance = np.abs(np.linalg.eigvals(found)[:, None] - multipliers).min(axis=0)
        assert distance.max() < 1e-7 * max(1.0, np.abs(multipliers).max())


def test_mirrored_system_has_the_mirrored_cycle():
    params = FORMER.with_(damping1=0.02, damping2=0.03, belt_speed=1.0, k2=1.1)
    mirrored = params.with_(
        k1=1.1, k2=1.0, damping1=0.03, damping2=0.02, belt_speed=-1.0
    )
    mirrored = mirrored.with_(length1=params.length2, length2=params.length1)
    one = limit_cycle(params, 0.4 * math.pi, 0.6 * math.pi)
    other = limit_cycle(mirrored, 0.6 * math.pi, 0.4 * math.pi)
    assert one.outcome == other.outcome
    np.testing.assert_allclose(one.period, other.period, rtol=1e-9)
    np.testing.assert_allclose(
        [one.x_min, one.x_max], [-other.x_max, -other.x_min], rtol=1e-8
    )
    np.testing.assert_allclose(one.multiplier_real, other.multiplier_real, atol=1e-7)


def test_without_damping_cycles_come_in_families():
    cycle = limit_cycle(FORMER, 5 * math.pi / 6, 5 * math.pi / 6)
    assert cycle.outcome == Outcome.family_member
    assert cycle.stable == 0
    assert cycle.residual < 1e-9


@pytest.mark.release
def test_a_settled_state_of_rest_is_no_cycle_and_without_damping_there_is_none():
    params = FORMER.with_(damping1=0.3, damping2=0.3)
    cycle = limit_cycle(params, 0.75 * math.pi, 0.75 * math.pi)
    assert cycle.outcome == Outcome.equilibrium
    assert np.isnan(cycle.period)
    params = FORMER.with_(
        k1=0.3369548162926997,
        k2=0.33121791549130847,
        k3=0.2689114661069115,
        mu=0.10066315042153495,
        belt_speed=-13.002080446037427,
        length1=20.94848468313279,
        length2=72.09643764912789,
    )
    cycle = limit_cycle(params, 2.2920388457758087, 1.6485212416566715, t_settle=100.0)
    assert cycle.outcome != Outcome.equilibrium


REST = FORMER.with_(
    k1=2.2,
    k2=2.8,
    k3=0.8,
    mu=0.15,
    mu_static=0.18,
    friction_law="exponential",
    friction_speed=0.24,
    belt_speed=-6.6,
    length1=8.7,
    length2=49.0,
    damping1=0.005,
    damping2=0.2,
)


@pytest.mark.parametrize(
    "settle",
    [*(pytest.param(t, marks=pytest.mark.release) for t in (1000.0, 1500.0)), 5000.0],
)
def test_rest_is_rest_in_any_units_and_mirrored(settle):
    """Round-off decides neither whether the place of rest is found nor whether a motion shrinks."""
    length, time = 1e-5, 3e3
    units = {"belt_speed": length / time, "friction_speed": length / time}
    units |= dict.fromkeys(("k1", "k2", "k3"), time**-2)
    units |= dict.fromkeys(("preload", "length1", "length2"), length)
    units |= dict.fromkeys(("damping1", "damping2"), 1.0 / time)
    other = REST.with_(
        **{name: unit * getattr(REST, name) for name, unit in units.items()}
    )
    a1, a2 = 0.8346, 1.5897
    for params, angles, unit in (
        (REST, (a1, a2), 1.0),
        (other, (a1, a2), time),
        (exchanged(REST), (math.pi - a2, math.pi - a1), 1.0),
        (exchanged(REST).with_(belt_speed=6.6), (a2, a1), 1.0),
    ):
        cycle = limit_cycle(params, *angles, t_settle=settle * unit)
        assert cycle.outcome == Outcome.equilibrium


def in_units(params, mass, length, time):
    units = {"mass": mass, "damping1": mass / time, "damping2": mass / time}
    units |= dict.fromkeys(("k1", "k2", "k3"), mass / time**2)
    units |= dict.fromkeys(("preload", "length1", "length2"), length)
    units |= {"belt_speed": length / time, "friction_speed": length / time}
    return params.with_(
        **{name: getattr(params, name) * u for name, u in units.items()}
    )


def test_a_branch_begins_at_the_onset_with_the_same_cycle_in_any_units():
    """An eigenvector's phase depends on units, and with it the state of the first cycle."""
    mass, length, time = 5.0, 1e-4, 2e-3
    here = Parameters(
        friction_law="exponential",
        mu=0.3,
        mu_static=0.6,
        belt_speed=4.0,
        damping1=0.03,
        damping2=0.03,
    )
    one, other = (
        cycle_branch(
            params,
            0.3,
            1.6,
            parameter="belt_speed",
            to=0.25 * params.belt_speed,
            start="onset",
            n_points=3,
        )
        for params in (here, in_units(here, mass, length, time))
    )
    assert one.sizes["point"] == 3
    np.testing.assert_allclose(other.x_start, one.x_start * length, rtol=1e-9)
    np.testing.assert_allclose(other.vy_start, one.vy_start * length / time, rtol=1e-7)


def test_as_a_system_a_pad_has_the_same_cycle_and_branch_in_any_units():
    """Newtons of 1e-9 would be round-off of a condition that is a square of forces."""
    mass, length, time = 1e-5, 3e-4, 50.0
    here = FORMER.with_(damping1=0.02, damping2=0.02, belt_speed=0.5)
    there = in_units(here, mass, length, time)
    angles = 0.4 * math.pi, 0.6 * math.pi
    pad = limit_cycle(here, *angles)
    branches = []
    for params in (here, there):
        numbers = parameters_of_run(params, *angles)
        system = brake_of(params, varied=["k2"])
        cycle = system.limit_cycle(**numbers)
        branch = system.cycle_branch("k2", 1.01 * params.k2, start=cycle, n_points=6)
        clock = math.sqrt(params.mass / params.k1)
        assert float(cycle.period) / clock == pytest.approx(float(pad.period), rel=1e-9)
        assert float(cycle.x_max) / params.preload == pytest.approx(
            float(pad.x_max), rel=1e-9
        )
        assert cycle.sizes["event"] == pad.sizes["event"]
        assert float(branch.k2[-1]) == pytest.approx(1.01 * params.k2, rel=1e-12)
        branches.append(branch)
    one, other = branches
    assert one.label.values.tolist() == other.label.values.tolist()
    np.testing.assert_allclose(other.period, one.period * time, rtol=1e-9)
    np.testing.assert_allclose(other.x_start, one.x_start * length, rtol=1e-7)


@pytest.mark.parametrize("speed", UNSTABLE)
def test_a_smooth_cycle_around_a_state_of_rest_is_found_from_any_phase(speed):
    params = oscillator(1e3, speed, **BSTAB)
    guess = (equilibrium(speed) + UNSTABLE[speed][0], 0.25, 0.0, 0.0)
    cycle = limit_cycle(params, *ANGLES, guess=guess)
    path = np.array([cycle[f"{name}_path"] for name in ("x", "y", "vx", "vy")])
    for state in path[:, ::25].T:
        again = limit_cycle(params, *ANGLES, guess=state)
        assert again.outcome == Outcome.converged
        np.testing.assert_allclose(again.period, cycle.period, rtol=1e-9)


@pytest.mark.long
def test_a_stiff_dashpot_does_not_drive_the_search_for_rest_off():
    params = FORMER.with_(
        k1=0.65,
        k2=1.13,
        k3=0.46,
        mu=1.05,
        mu_static=2.76,
        friction_law="exponential",
        friction_speed=1.82,
        belt_speed=0.2837,
        length1=9.25,
        length2=24.5,
        damping1=1e8,
    )
    cycle = limit_cycle(params, math.pi, 2.4033, guess=(0.1, 0.0, 0.0, 0.0))
    assert cycle.outcome != Outcome.converged


def test_branch_goes_round_a_fold_and_labels_it():
    params = FORMER.with_(damping1=0.02, damping2=0.02, belt_speed=1.0)
    angles = (0.4 * math.pi, 0.6 * math.pi)
    branch = cycle_branch(
        params, *angles, parameter="mu", to=0.05, start=limit_cycle(params, *angles)
    )
    fold = int(np.flatnonzero(branch.label == Label.fold)[0])
    assert float(branch.mu[fold]) == float(branch.mu.min())
    nontrivial = branch.multiplier_real[fold, 1:].values
    assert np.abs(nontrivial - 1.0).min() < 1e-3
    stable = branch.stable.values
    assert stable[: fold - 1].all()
    assert not stable[fold + 1 :].any()


def test_round_off_of_an_undamped_pair_is_no_onset():
    """Its growth is zero up to flutter: the sign of what is left of it is no loss of stability."""
    params = Parameters(k3=0.7, mu=0.3, belt_speed=1.1, length1=50.0, length2=50.0)
    branch = cycle_branch(params, 0.9, 2.8, parameter="mu", to=0.4, start="onset")
    assert branch.sizes["point"] == 0
    assert branch.end == Outcome.no_convergence


def test_branch_is_born_at_the_flutter_onset_of_long_springs():
    params = FORMER.with_(
        damping1=0.01, damping2=0.02, mu=0.0, length1=1e4, length2=1e4, k2=1.1
    )
    angles = (0.22, 0.96)

    def growth(mu):
        k11, k12, k22 = linear_stiffness(params, geometry(*angles))
        c11, c12, c22 = linear_stiffness(
            params.with_(k1=0.01, k2=0.02), geometry(*angles)
        )
        stiffness = np.array([[k11, k12 + mu * params.k3], [k12, k22 + params.k3]])
        damping = np.array([[c11, c12], [c12, c22]])
        matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -damping]])
        return np.linalg.eigvals(matrix).real.max()

    branch = cycle_branch(
        params, *angles, parameter="mu", to=0.9, start="onset", n_points=3
    )
    onset = brentq(growth, 0.05, 0.9)
    np.testing.assert_allclose(branch.mu[0], onset, rtol=1e-3)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"parameter": "gamma"}, "parameter = 'gamma'"),
        ({"parameter": "friction_law"}, "parameter = 'friction_law'"),
        ({"to": 0.3}, "to = 0.3"),
        ({"to": -1.0}, "mu = -1.0"),
        ({"start": "flutter"}, "start = 'flutter'"),
    ],
)
def test_branch_refuses_what_it_cannot_do(change, named):
    given = {"parameter": "mu", "to": 0.5, "start": (0.0, 0.0, 0.0, 0.0)} | change
    with pytest.raises(ValueError, match=named.replace("(", r"\(")):
        cycle_branch(FORMER, 1.0, 2.0, **given)


@pytest.mark.parametrize(
    "rounds", [6, 25, *(pytest.param(n, marks=pytest.mark.release) for n in (2, 3))]
)
def test_a_return_after_several_rounds_gives_the_least_period(rounds):
    params, angles = oscillator(1e4, 1.25, **BSTAB), ANGLES
    once, _ = cycle_from(Design(params, *angles), (1.5, 0.25, 1.25, 0.0))
    parts = once.parts
    several = replace(once.map, events=once.map.events * rounds)
    states, durations = (
        np.tile(parts.states, (rounds, 1)),
        np.tile(parts.durations, rounds),
    )
    point = several.pack(states, durations, 0.0, np.empty(0))
    cycle = once_round(Cycle.at(several, point))
    np.testing.assert_allclose(cycle.period, once.period, rtol=1e-9)


def test_a_cycle_under_a_table_of_friction_does_not_depend_on_the_units():
    """Stick–slip of a pad in SI numbers and of the same in units of m = k1 = l_pre = 1."""
    mass, k1, preload = 0.5, 1e7, 2e-5
    time = math.sqrt(mass / k1)
    speed = preload / time
    table = ((0.0, 0.6), (0.5, 0.45), (1.0, 0.4), (3.0, 0.35))
    one = Parameters(
        k3=0.7,
        belt_speed=0.2,
        damping1=0.02,
        damping2=0.02,
        length1=1000.0,
        length2=1000.0,
        friction_law="linear " + " ".join(f"{v}:{mu}" for v, mu in table),
    )
    pad = Parameters(
        mass=mass,
        k1=k1,
        k2=k1,
        k3=0.7 * k1,
        preload=preload,
        length1=0.02,
        length2=0.02,
        belt_speed=0.2 * speed,
        damping1=0.02 * mass / time,
        damping2=0.02 * mass / time,
        friction_law="linear " + " ".join(f"{v * speed!r}:{mu}" for v, mu in table),
    )
    angles = 0.1 * math.pi, 0.5 * math.pi
    here, there = limit_cycle(one, *angles), limit_cycle(pad, *angles)
    assert here.outcome == there.outcome == Outcome.converged
    assert float(here.stick_fraction) > 0.1
    for name, unit in (("period", time), ("x_max", preload), ("stick_fraction", 1.0)):
        assert float(there[name]) == pytest.approx(float(here[name]) * unit, rel=1e-8)
