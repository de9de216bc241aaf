"""Folds of branches of cycles against long runs; grazing points against the force there."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from squealpipe import cycle_branch, cycle_curve, limit_cycle, simulate
from squealpipe.schema import Outcome
from squealpipe.systems.branch_labels import Label, Meeting
from tests.brake.cycles.test_branch_ends import start_of
from tests.former import FORMER
from tests.oracles.a1_long_double import simulate_reference

STATE = ("x", "y", "vx", "vy")
ONE_WAY = (FORMER.with_(damping1=0.02, damping2=0.02, belt_speed=1.0), 0.4, 0.6)
OTHER_WAY = (
    FORMER.with_(k1=1.005, damping1=0.02, damping2=0.02, belt_speed=-1.0),
    0.6,
    0.4,
)


@pytest.mark.parametrize(
    ("params", "alpha1", "alpha2"),
    [ONE_WAY, pytest.param(*OTHER_WAY, marks=pytest.mark.release)],
)
def test_long_runs_jump_at_the_fold(params, alpha1, alpha2):
    """Runs swept down in friction, each from the end of the one before, leave past the fold."""
    angles = (alpha1 * math.pi, alpha2 * math.pi)
    branch = cycle_branch(
        params, *angles, parameter="mu", to=0.05, start=limit_cycle(params, *angles)
    )
    fold = int(np.flatnonzero(branch.label == Label.fold)[0])
    before = branch.isel(point=slice(0, fold + 1))
    state, step, t_end = start_of(branch.isel(point=fold - 1)), 1e-3, 1500.0
    follows = []
    for steps in (3.0, 2.0, 1.0, 0.5, -0.5, -1.0):
        mu = float(branch.mu[fold]) + steps * step
        late = np.linspace(t_end - 100.0, t_end, 4001)
        run = simulate(
            params.with_(mu=mu), *angles, t_end=t_end, times=late, initial_state=state
        )
        state = np.array([float(run[name][-1]) for name in STATE])
        extent = np.array([float(run.x.min()), float(run.x.max())])
        order = np.argsort(before.mu.values)
        known = [
            np.interp(mu, before.mu[order], before[name][order])
            for name in ("x_min", "x_max")
        ]
        follows.append(bool(np.abs(extent - known).max() < 0.02))
    assert follows == [True] * 4 + [False] * 2


def turn_next_to_contact(params, angles, cycle):
    """The y of that turn of a cycle which is nearest to where contact begins."""
    start, times = (
        start_of(cycle),
        1.2 * float(cycle.period) * np.linspace(0.0, 1.0, 2001),
    )
    y = simulate(
        params, *angles, t_end=times[-1], times=times, initial_state=start
    ).y.values
    turns = 1 + np.flatnonzero(np.diff(y[1:]) * np.diff(y[:-1]) < 0.0)
    at = turns[np.abs(y[turns] - params.preload).argmin()]

    def state(time):
        return simulate_reference(
            params, *angles, t_end=time, initial_state=start
        ).state

    return float(
        state(brentq(lambda time: float(state(time)[3]), *times[[at - 1, at + 1]]))[1]
    )


@pytest.mark.release
def test_grazing_points_at_random_parameters_just_touch():
    """The force at the touch, be it the least of the cycle or that of another approach."""
    generator = np.random.default_rng(8)
    touched = 0
    while touched < 6:
        params = FORMER.with_(
            k2=generator.uniform(0.8, 1.3),
            k3=generator.uniform(0.5, 1.2),
            mu=0.0,
            length2=generator.uniform(4.0, 8.0),
            damping1=generator.uniform(0.005, 0.02),
            damping2=generator.uniform(0.005, 0.02),
            belt_speed=generator.uniform(20.0, 100.0),
        )
        angles = generator.uniform((0.15, 0.8), (0.3, 1.1))
        branch = cycle_branch(
            params, *angles, parameter="mu", to=0.9, start="onset", n_points=60
        )
        if branch.end == Outcome.no_convergence:
            assert branch.sizes["point"] == 0
            continue
        for point in np.flatnonzero(branch.label == Label.grazing):
            here = branch.isel(point=point)
            touch = turn_next_to_contact(params.with_(mu=float(here.mu)), angles, here)
            assert abs(touch - params.preload) < 1e-9 * params.preload
            touched += 1


@pytest.mark.release
def test_special_points_do_not_depend_on_units():
    """Time 1000 √(m/k1), force 1e-6: what tells a touch from either side has another unit."""
    params, unit = (
        FORMER.with_(
            k1=1.596,
            k2=0.391,
            k3=2.894,
            mu=0.336,
            belt_speed=-1.103,
            length1=5.49,
            length2=5.574,
            damping1=0.0045,
            damping2=0.071,
        ),
        np.array([1e-3, 1e-3, 1e-6, 1e-6]),
    )
    scaled = {
        "mass": 1e3,
        "length1": 1e-3,
        "length2": 1e-3,
        "preload": 1e-3,
        "belt_speed": 1e-6,
    }
    scaled |= dict.fromkeys(("k1", "k2", "k3"), 1e-3) | dict.fromkeys(
        ("damping1", "damping2"), 1.0
    )
    other = params.with_(
        **{name: factor * getattr(params, name) for name, factor in scaled.items()}
    )
    angles, guess = (1.823, 1.037), (-1.51915, 10.9181, 1.45042, -0.12146)
    branches = [
        cycle_branch(
            given, *angles, parameter="alpha1", to=1.1, start=start, n_points=36
        )
        for given, start in ((params, guess), (other, np.array(guess) * unit))
    ]
    special = [np.flatnonzero(branch.label > 0)[:-1] for branch in branches]
    np.testing.assert_array_equal(
        *(b.label[at] for b, at in zip(branches, special, strict=True))
    )
    assert (branches[0].label == Label.stick_onset).any()
    places = [b.alpha1[at] for b, at in zip(branches, special, strict=True)]
    np.testing.assert_allclose(*places, rtol=1e-9)
    curves = [
        cycle_curve(
            given,
            *angles,
            label="stick_onset",
            parameters=("k3", "belt_speed"),
            start=b,
            n_points=20,
            to={"k3": (0.999 * given.k3, 1.001 * given.k3)},
        )
        for given, b in zip((params, other), branches, strict=True)
    ]
    for name, of in (
        ("k3", scaled["k3"]),
        ("belt_speed", scaled["belt_speed"]),
        ("period", 1e3),
    ):
        # points between the ends lie where the steps ended
        one, two = (curve[name].values[[0, -1]] for curve in curves)
        np.testing.assert_allclose(of * one, two, rtol=1e-8)


@pytest.mark.release
def test_a_curve_goes_through_each_located_onset_of_stick():
    """Where runs from the point itself end in reversals without end, or lack a leg."""
    slow, angles = FORMER.with_(belt_speed=1.0), (0.4 * math.pi, 0.6 * math.pi)
    branch = cycle_branch(slow, *angles, parameter="belt_speed", to=1.25, n_points=40)
    onsets = np.flatnonzero(branch.label == Label.stick_onset)
    assert len(onsets) > 2
    for speed, point in zip(branch.belt_speed.values[onsets], onsets, strict=True):
        curve = cycle_curve(
            slow,
            *angles,
            label="stick_onset",
            parameters=("belt_speed", "mu"),
            start=branch.isel(point=point),
            n_points=3,
        )
        there = int(np.abs(curve.mu.values - slow.mu).argmin())
        assert float(curve.mu[there]) == slow.mu
        assert float(curve.belt_speed[there]) == pytest.approx(speed, rel=1e-9)


FLUTTER = (
    FORMER.with_(
        k3=0.65,
        mu=0.01,
        length1=15.0,
        length2=15.0,
        belt_speed=-100.0,
        damping1=0.02,
        damping2=0.02,
    ),
    0.305,
    0.07,
)


@pytest.mark.parametrize(
    ("scene", "label", "other", "ends", "to", "start"),
    [
        pytest.param(
            ONE_WAY, "fold", "k3", (0.735, 0.77), 0.05, None, marks=pytest.mark.release
        ),
        (FLUTTER, "grazing", "alpha1", (0.93, 0.97), 0.7, "onset"),
    ],
)
def test_curves_end_where_branches_have_the_special_point(
    scene, label, other, ends, to, start
):
    """At both limits of the other parameter, on branches in friction alone."""
    params, *angles = scene[0], scene[1] * math.pi, scene[2] * math.pi

    near = None if start else start_of(limit_cycle(params, *angles))

    def branch_at(params, *angles):
        first = start or limit_cycle(params, *angles, guess=near)
        return cycle_branch(params, *angles, parameter="mu", to=to, start=first)

    curve = cycle_curve(
        params,
        *angles,
        label=label,
        parameters=("mu", other),
        to={other: ends},
        start=branch_at(params, *angles),
    )
    assert list(curve.outcome.values) == [Outcome.converged] * 2
    assert (curve.made_by, curve.model) == ("squealpipe.cycle_curve", "A1")
    assert float(curve.residual.max()) < 1e-9
    for end in (0, -1):
        value = float(curve[other][end])
        assert value == pytest.approx(ends[int(value > np.mean(ends))], abs=1e-12)
        there = (params, value, angles[1])
        branch = branch_at(
            *(there if other == "alpha1" else (params.with_(k3=value), *angles))
        )
        mu = branch.mu.values[branch.label.values == Label[label]][0]
        assert float(curve.mu[end]) == pytest.approx(float(mu), abs=1e-9)


@pytest.mark.release
def test_a_curve_of_folds_goes_on_with_another_order_of_events():
    """Round two cusps, until it ends with what changes the order."""
    params, *angles = ONE_WAY[0], 0.4 * math.pi, 0.6 * math.pi
    branch = cycle_branch(
        params, *angles, parameter="mu", to=0.05, start=limit_cycle(params, *angles)
    )
    curve = cycle_curve(
        params,
        *angles,
        label="fold",
        parameters=("mu", "k3"),
        start=branch,
        to={"mu": (0.05, 1.0), "k3": (0.34, 2.0)},
    )
    assert len(set(curve.events.values)) > 1
    assert (curve.label == Meeting.cusp).sum() == 2
    assert set(curve.outcome.values) == {Outcome.converged, Outcome.order_changes}
    assert [bool(text) for text in curve.change.values] == [
        outcome == Outcome.order_changes for outcome in curve.outcome.values
    ]


@pytest.mark.parametrize(
    "moves",
    [(0.0, 1e-12, 1e-9), pytest.param((0.0, 1e-11, 1e-10), marks=pytest.mark.release)],
)
def test_round_off_of_a_start_does_not_decide_whether_a_grazing_curve_goes_on(moves):
    """At a touch a run may have the pair of events or not; on AVX2 it had it, and that was all."""
    params, *angles = FLUTTER[0], FLUTTER[1] * math.pi, FLUTTER[2] * math.pi
    branch = cycle_branch(params, *angles, parameter="mu", to=0.7, start="onset")
    at = branch.isel(point=int(np.flatnonzero(branch.label == Label.grazing)[0]))
    curves = [
        cycle_curve(
            params,
            *angles,
            label="grazing",
            parameters=("mu", "alpha1"),
            n_points=9,
            start=at.assign(mu=at.mu * (1.0 + moved)),
            to={"alpha1": (0.955, 0.9603)},
        )
        for moved in moves
    ]
    for curve in curves:
        assert list(curve.outcome.values) == [Outcome.converged] * 2
        np.testing.assert_allclose(curve.mu[[0, -1]], curves[0].mu[[0, -1]], rtol=1e-9)


@pytest.mark.release
def test_where_folds_are_onsets_of_stick_round_off_makes_no_special_points():
    """Beyond where a curve of folds meets the onset of stick, branches turn at that onset.

    The stick of no length leaves the return map without a derivative all along, and multipliers
    that round-off had made told of a fold–flip, twice.
    """
    params = FORMER.with_(
        k3=0.65,
        belt_speed=-100.0,
        length1=15.0,
        length2=15.0,
        damping1=0.02,
        damping2=0.02,
    )
    angles = (0.83 * math.pi, 0.83 * math.pi)

    def branch_of(params, start):
        return cycle_branch(
            params, *angles, parameter="mu", to=0.01, start=start, n_points=30
        )

    curve = cycle_curve(
        params,
        *angles,
        label="fold",
        parameters=("mu", "k3"),
        to={"k3": (0.06, 0.7)},
        start=branch_of(params, [-6.12, 45.1, 101.48, -0.1]),
    )
    special = [Meeting.regular, Meeting.stick_onset, Meeting.end]
    assert set(curve.label.values) == set(special)
    low = int(curve.k3.values.argmin())
    soft = params.with_(k3=0.09, mu=0.11631937199880295)
    start = [-2.3956, 75.6176, 100.9722, -0.0119]
    softer = cycle_branch(soft, *angles, parameter="k3", to=0.06, start=start)
    turned = branch_of(soft.with_(k3=0.06), start_of(softer.isel(point=-1)))
    turn = int(turned.mu.values.argmin())
    assert turned.label[turn] == Label.stick_onset
    assert float(curve.mu[low]) == pytest.approx(float(turned.mu[turn]), rel=1e-10)
