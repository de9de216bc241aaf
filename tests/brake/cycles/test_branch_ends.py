"""Branches of limit cycles: changes of the events, why a branch ends, what is refused."""

import math

import numpy as np
import pytest
from scipy.optimize import root

from squealpipe import cycle_branch, limit_cycle, simulate
from squealpipe.codes import Regime
from squealpipe.schema import Outcome
from squealpipe.systems.branch_labels import Label
from tests.former import FORMER
from tests.oracles.a1_automaton import A1Automaton, EventKind
from tests.oracles.a1_long_double import simulate_reference

PENDULUM = (0.4 * math.pi, 0.6 * math.pi)
STICKING = FORMER.with_(belt_speed=1.0, damping1=0.02, damping2=0.02, k2=1.2)
STATE = ("x", "y", "vx", "vy")
TURN = (EventKind.belt_speed, True)


def start_of(dataset):
    return np.array([float(dataset[f"{name}_start"]) for name in STATE])


@pytest.fixture(scope="module")
def sticking():
    return limit_cycle(STICKING, *PENDULUM)


def located_crossings(branch, parameter):
    """Points where a crossing of belt speed becomes stick: μs N holds the x-force to round-off."""
    found = []
    for point in np.flatnonzero(branch.label == Label.stick_onset):
        here = branch.isel(point=point)
        scene = STICKING.with_(**{parameter: float(here[parameter])}), *PENDULUM
        period, a1 = float(here.period), A1Automaton(*scene)
        run = simulate_reference(*scene, t_end=period, initial_state=start_of(here))
        places = zip(run.event_kinds, run.event_states, run.regimes[1:], strict=True)
        passed = [
            z for kind, z, regime in places if (kind, regime != Regime.stick) == TURN
        ]
        spans = np.diff([0.0, *run.event_times, period])[
            np.equal(run.regimes, Regime.stick)
        ]
        assert (
            min([abs(abs(a1.pull(z)) - a1.grip(z)) for z in passed] + spans.tolist())
            < 1e-7
        )
        found.append(float(here[parameter]))
    return found


@pytest.mark.release
def test_stick_of_no_length_is_an_onset_of_stick(sticking):
    down = cycle_branch(STICKING, *PENDULUM, parameter="mu", to=0.02, start=sticking)
    assert down.end == Outcome.converged
    np.testing.assert_allclose(located_crossings(down, "mu")[1], 0.17793611, atol=1e-8)
    assert float(down.stick_fraction[-1]) == 0.0
    up = cycle_branch(
        STICKING, *PENDULUM, parameter="belt_speed", to=6.0, start=sticking
    )
    assert up.end == Outcome.returned
    np.testing.assert_allclose(
        located_crossings(up, "belt_speed"), [1.0303, 1.0409], atol=5e-5
    )
    fold = int(np.flatnonzero(up.label == Label.fold)[0])
    multipliers = up.multiplier_real[fold].values
    assert abs(multipliers[0] - 1.0) < 1e-9
    assert np.abs(multipliers[1:] - 1.0).min() < 1e-4


@pytest.mark.release
def test_branch_ends_on_the_cycle_of_half_the_period():
    params = FORMER.with_(
        k1=0.8787958456924088,
        k2=1.3068838111256635,
        k3=1.266242024044932,
        mu=0.3036800352221386,
        belt_speed=-1.885,
        damping1=0.02744740168299363,
        damping2=0.026220449336112735,
        friction_law="exponential",
        mu_static=0.42515204931099404,
        friction_speed=0.7,
    )
    angles = (1.8416983400284646, 1.1767777127079984)
    first = limit_cycle(
        params, *angles, guess=(-1.7125886, 9.9902116, 2.3424566, -0.1426892)
    )
    np.testing.assert_allclose(first.period, 31.6469, atol=1e-3)
    branch = cycle_branch(params, *angles, parameter="belt_speed", to=-1.0, start=first)
    assert branch.end == Outcome.tongue_end
    assert branch.label[-1] == Label.end
    assert (branch.label == Label.stick_onset).sum() == 1
    last = branch.isel(point=-1)
    given = {"t_end": 0.5 * float(last.period), "initial_state": start_of(last)}
    half = simulate_reference(
        params.with_(belt_speed=float(last.belt_speed)), *angles, **given
    )
    assert np.abs(half.state - start_of(last)).max() < 0.02
    assert abs(last.multiplier_real[1] - 1.0) < 1e-3
    parameter = branch.belt_speed.values
    folds = np.flatnonzero(branch.label == Label.fold)
    np.testing.assert_allclose(parameter[folds[:2]], [-1.879322, -1.879525], atol=1e-6)


@pytest.mark.release
def test_a_touch_of_stick_that_would_jump_ends_the_branch():
    """With a static coefficient of its own, a mass that touches belt speed stays there."""
    params = FORMER.with_(
        k1=1.3685895636278969,
        k2=1.1717696456380882,
        k3=1.165372514053258,
        mu=0.4863140547913525,
        belt_speed=0.17,
        length2=4.167532071016394,
        damping1=0.011181702363416656,
        damping2=0.02593450195002516,
        mu_static=0.9015819524317354,
    )
    angles = (0.9903645711198943, 0.2685180420617395)
    guess = (-0.0007415, 0.5437495, -0.1917294, -0.1816512)
    branch = cycle_branch(params, *angles, parameter="belt_speed", to=0.27, start=guess)
    assert branch.end == Outcome.tangency
    assert branch.label[-1] == Label.stick_onset
    jumps = []
    for point in (0, -1):
        place = branch.isel(point=point)
        faster = params.with_(belt_speed=float(place.belt_speed) + 1e-4)
        times = float(place.period) * np.arange(20.0, 24.0, 0.01)
        run = simulate(
            faster, *angles, t_end=times[-1], times=times, initial_state=start_of(place)
        )
        jumps.append(abs(float(run.y.max() - place.y_max)))
    assert jumps[0] < 1e-3
    assert jumps[1] > 0.05


def test_every_end_has_its_label_and_reason(sticking):
    branch = cycle_branch(
        STICKING,
        *PENDULUM,
        parameter="mu",
        to=0.02,
        start=sticking,
        n_points=np.int64(7),
    )
    assert branch.end == Outcome.point_limit
    assert branch.sizes["point"] <= 7
    assert branch.label[-1] == Label.end
    assert float(branch.mu[-1]) > 0.02


def test_a_branch_ends_where_the_cycle_shrinks_to_rest():
    params = FORMER.with_(damping1=0.01, damping2=0.01, mu=0.0)
    born = cycle_branch(
        params, 0.22, 0.96, parameter="mu", to=0.9, start="onset", n_points=12
    )
    large = born.isel(point=-1)
    back = cycle_branch(
        params.with_(mu=float(large.mu)),
        0.22,
        0.96,
        parameter="mu",
        to=0.0,
        start=tuple(start_of(large)),
    )
    assert back.end == Outcome.equilibrium
    np.testing.assert_allclose(back.mu[-1], born.mu[0], rtol=1e-2)


@pytest.mark.release
def test_a_hammering_cycle_shrinks_to_rest_at_the_edge_of_contact():
    """It keeps both its events: the springs alone then balance just where contact begins."""
    params = FORMER.with_(
        mass=0.36,
        k1=0.11,
        k2=0.89,
        k3=0.21,
        mu=0.8,
        belt_speed=0.0122,
        preload=0.0311,
        length1=0.1057,
        length2=0.065,
        damping1=0.00237,
        friction_law="exponential",
        mu_static=1.209,
        friction_speed=0.0291,
    )
    angles = (2.512, 2.953)
    start = (0.02881478, 0.06621683, 0.02418213, 0.00180263)
    branch = cycle_branch(params, *angles, parameter="alpha2", to=3.75, start=start)
    assert branch.end == Outcome.equilibrium
    assert branch.events[-1] == 2

    def forces(unknown):
        x, alpha2 = unknown
        ends = (
            (params.k1, params.length1, math.cos(angles[0]), math.sin(angles[0])),
            (params.k2, params.length2, -math.cos(alpha2), math.sin(alpha2)),
        )
        arms = [
            np.array([x - length * c, params.preload - length * s])
            for _, length, c, s in ends
        ]
        pairs = zip(ends, arms, strict=True)
        return sum(
            -k * (1 - length / np.hypot(*arm)) * arm for (k, length, *_), arm in pairs
        )

    x, alpha2 = root(
        forces, [float(branch.x_max[-1]), float(branch.alpha2[-1])], tol=1e-13
    ).x
    np.testing.assert_allclose(branch.alpha2[-1], alpha2, rtol=1e-4)
    np.testing.assert_allclose(branch.x_max[-1], x, rtol=1e-3)
    last = branch.isel(point=-1)
    given = {"t_end": float(last.period), "initial_state": start_of(last)}
    end = simulate_reference(params, angles[0], float(last.alpha2), **given).state
    extent = max(float(last.x_max - last.x_min), float(last.y_max - last.y_min))
    # both are round-off: the cycle has shrunk to it
    assert last.residual >= 0.5 * np.abs(end - start_of(last))[:2].max() / extent


def test_a_run_too_long_to_settle_says_so():
    """Nothing accumulates here: the run ends at the limit of its steps."""
    few = {"max_steps": 20_000}
    cycle = limit_cycle(STICKING, *PENDULUM, t_settle=1e9, **few)
    assert cycle.outcome == Outcome.step_limit
    stiff = STICKING.with_(k2=1e8)
    assert limit_cycle(stiff, *PENDULUM, **few).outcome == Outcome.step_limit


@pytest.mark.release
def test_a_branch_whose_first_cycle_is_too_long_to_settle_says_so():
    branch = cycle_branch(STICKING.with_(k2=1e8), *PENDULUM, parameter="mu", to=0.2)
    assert branch.end == Outcome.step_limit


def test_a_branch_takes_the_limit_of_steps_that_its_end_tells_to_raise():
    stiff = STICKING.with_(k2=1e8)
    told = {"parameter": "mu", "to": 0.2, "max_steps": 2000}
    branch = cycle_branch(stiff, *PENDULUM, **told)
    assert branch.end == Outcome.step_limit
    assert "raise max_steps" in branch.end.comment


@pytest.mark.parametrize(
    ("guess", "outcome"),
    [
        (
            (5.0 * math.cos(PENDULUM[0]), 5.0 * math.sin(PENDULUM[0]), 0, 0),
            "singular_geometry",
        ),
        ((1e200, 1.0, 1.0, 1.0), "not_finite"),
        ((0.0, 0.0, 1e100, 0.0), "not_finite"),
    ],
)
def test_a_pivot_is_told_from_an_overflow(guess, outcome):
    assert limit_cycle(STICKING, *PENDULUM, guess=guess).outcome == Outcome[outcome]
