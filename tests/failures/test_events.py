"""The hard cases of set-valued friction and unilateral contact, against closed forms.

At (π/2, π) with equal springs the linearized stiffness is k times the identity: x and y are
harmonic within each regime and every event time has a closed form (units of m = k = l_pre = 1).
"""

import numpy as np
import pytest

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.codes import Event, Regime
from squealpipe.schema import Outcome
from tests.former import FORMER
from tests.oracles.a1_scipy import simulate_scipy

IDENTITY = {"alpha1": 0.5 * np.pi, "alpha2": np.pi, "model": "A1-linear-springs"}
VERTICAL = {"alpha1": 0.5 * np.pi, "alpha2": 0.5 * np.pi, "model": "A1-linear-springs"}
SEPARATION, CONTACT, STICK, SLIP, REVERSAL = Event
KAPPA, MU, SPEED = 0.75, 0.4, 0.1
REST = KAPPA / (1 + KAPPA)  # y at rest, and the contact force there
GRIP = MU * REST  # the largest elastic x-force that friction holds
FRICTION = FORMER.with_(k3=KAPPA, mu=MU, belt_speed=SPEED)


def events(run):
    return list(
        zip(run.event_kind.values.tolist(), run.event_time.values.tolist(), strict=True)
    )


def assert_events(run, expected, *, error=1e-12):
    found = events(run)[: len(expected)]
    assert [kind for kind, _ in found] == [kind for kind, _ in expected]
    np.testing.assert_allclose(
        [t for _, t in found], [t for _, t in expected], atol=error
    )


@pytest.mark.parametrize("kappa", [1.5, 3.0, 50.0, 1e4, 1e6])
def test_separation_and_contact(kappa):
    rate, rest = np.sqrt(1 + kappa), kappa / (1 + kappa)
    leaves = np.arccos(-1 / kappa) / rate
    flight = 2 * np.arctan(rest * rate * np.sin(rate * leaves))
    params = FORMER.with_(k3=kappa, belt_speed=1e6)
    run = simulate(params, t_end=1.5 * (leaves + flight), **IDENTITY)
    assert run.outcome == Outcome.converged
    assert_events(run, [(SEPARATION, leaves), (CONTACT, leaves + flight)])


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_stick_then_slip(direction):
    """Reaches belt speed where friction can hold it; is released where it no longer can."""
    amplitude = 0.2
    reach = np.sqrt(amplitude**2 - SPEED**2)
    assert reach < 2 * GRIP
    sticks = np.arcsin(SPEED / amplitude)
    params = FRICTION.with_(belt_speed=direction * SPEED)
    start = (direction * (GRIP - amplitude), REST, 0, 0)
    run = simulate(params, t_end=8.0, initial_state=start, **IDENTITY)
    assert_events(run, [(STICK, sticks), (SLIP, sticks + reach / SPEED)])


def test_reversal_there_and_back():
    """Passes belt speed where friction cannot hold it, comes back, and then sticks."""
    amplitude = 0.45
    beyond = np.sqrt(amplitude**2 - SPEED**2) - 2 * GRIP  # −(x + grip) at the crossing
    assert 0 < beyond < 2 * GRIP
    first = np.arcsin(SPEED / amplitude)
    second = first + 2 * np.arctan(beyond / SPEED)
    run = simulate(
        FRICTION, t_end=4.0, initial_state=(GRIP - amplitude, REST, 0, 0), **IDENTITY
    )
    assert_events(run, [(REVERSAL, first), (STICK, second)])


def test_released_mass_does_not_stick_again_without_end():
    """After the release ẋ returns to V tangentially once a period: no chatter, and it goes on."""
    run = simulate(FRICTION, t_end=200.0, initial_state=(0, REST, SPEED, 0), **IDENTITY)
    assert run.outcome == Outcome.converged
    assert_events(run, [(SLIP, GRIP / SPEED)])
    assert run.event_time.size < 4 * 200 / (2 * np.pi) + 2
    orbit = np.hypot(run.x - GRIP, run.vx)[run.time.values > GRIP / SPEED]
    np.testing.assert_allclose(orbit, SPEED, rtol=1e-9)


def test_separation_during_stick():
    """K11 = 0 and no x-force: the mass sticks from start to separation, and again at contact."""
    params = FORMER.with_(k3=4.0, belt_speed=0.5)
    rate, rest = np.sqrt(6.0), 4.0 / 6.0
    leaves = np.arccos(1 - 1 / rest) / rate
    upward = rest * rate * np.sin(rate * leaves)
    flight = 2 * np.arctan(upward / np.sqrt(2)) / np.sqrt(2)
    run = simulate(params, t_end=5.0, initial_state=(0, 0, 0.5, 0), **VERTICAL)
    assert run.outcome == Outcome.converged
    assert run.regime[0] == Regime.stick
    assert_events(run, [(SEPARATION, leaves), (CONTACT, leaves + flight)])
    after = run.regime.values[np.searchsorted(run.time, leaves + flight) + 1]
    assert after == Regime.stick
    np.testing.assert_array_equal(run.vx, 0.5)


def test_contact_at_exactly_belt_speed_slips_where_springs_pull():
    """ẋ = V at contact, where N = 0 holds nothing: it slips to the side that the springs pull."""
    params = FORMER.with_(k3=KAPPA, mu=MU, belt_speed=0.0)
    fall = np.arccos(1 / 1.5)
    for x in (-0.3, 0.3):
        # ẋ at contact is −x sin t; start so that it is exactly zero there.
        start = (x * np.cos(fall), 1.5, x * np.sin(fall), 0.0)
        run = simulate(params, t_end=fall + 1e-3, initial_state=start, **IDENTITY)
        assert events(run)[0][0] == CONTACT
        np.testing.assert_allclose(events(run)[0][1], fall, atol=1e-14)
        assert np.sign(run.vx[-1]) == -np.sign(x)


def test_belt_at_rest_holds_the_mass():
    """V = 0 from rest with an x-force below the grip: sticks until the grip has faded."""
    run = simulate(FORMER.with_(belt_speed=0.0), 1.0, 1.4, t_end=20.0)
    assert run.outcome == Outcome.converged
    assert run.regime[0] == Regime.stick
    assert int(run.event_kind[0]) in {SLIP, SEPARATION}


@pytest.mark.parametrize(
    ("vy", "regime", "first"), [(0.5, Regime.separated, CONTACT), (-0.5, 0, SEPARATION)]
)
def test_start_exactly_at_the_threshold_moving(vy, regime, first):
    run = simulate(FORMER, t_end=6.0, initial_state=(0, 1.0, 0, vy), **IDENTITY)
    assert run.regime[0] == regime
    assert run.y[0] == 1.0
    assert events(run)[0][0] == first
    assert events(run)[0][1] > 0.5


def test_start_exactly_at_the_threshold_at_rest():
    """The springs pull down there: it is in contact, and comes back to the threshold."""
    run = simulate(
        FORMER.with_(k3=KAPPA), t_end=4.0, initial_state=(0, 1.0, 0, 0), **IDENTITY
    )
    assert run.regime[0] == Regime.slip_slower
    # N = 0 is grazed at the top of the free oscillation about y = κ/(1 + κ).
    np.testing.assert_allclose(
        run.y, REST + (1 - REST) * np.cos(np.sqrt(1.75) * run.time), atol=1e-9
    )


def test_no_friction_never_sticks():
    params, angles = FORMER.with_(mu=0.0, belt_speed=0.2), np.linspace(0, np.pi, 40)
    run = run_ensemble(params, 0.3, angles, t_end=50.0)
    assert (run.outcome == Outcome.converged).all()
    assert not np.any([run.sticks, run.stick_time])


def test_two_springs_on_one_side_and_a_belt_at_rest():
    """x-force and contact force vanish at one time: separation comes before friction."""
    params = FORMER.with_(k3=4.0, belt_speed=0.0)
    run = simulate(params, t_end=3.0, **VERTICAL)
    assert run.outcome == Outcome.converged
    assert events(run)[0][0] == SEPARATION
    np.testing.assert_array_equal(run.x, 0.0)


def test_without_stick_the_sliding_mode_has_no_solution():
    start, scene = (-0.1, REST, 0, 0), (FRICTION, 0.5 * np.pi, np.pi)
    run = simulate(*scene, t_end=8.0, model="A1-no-stick", initial_state=start)
    sticks = simulate(*scene, t_end=8.0, initial_state=start)
    assert run.outcome == Outcome.accumulation
    first = sticks.event_time.values[sticks.event_kind.values == STICK][0]
    np.testing.assert_allclose(run.time_reached, first, atol=1e-12)
    assert np.isnan(run.x.values[run.time.values > first]).all()


@pytest.mark.parametrize("offset", [0.0, 1e-12, 1e-9, 1e-5])
def test_a_mass_that_meets_a_pivot_says_so(offset):
    """Springs of half the preload's length, straight above: the mass is thrown at their end."""
    params = FORMER.with_(k3=5.0, length1=0.5, length2=5.0, belt_speed=0.0)
    angles = 0.5 * np.pi, 0.5 * np.pi
    run = run_ensemble(params, *angles, t_end=10.0, initial_state=(offset, 0, 0, 0))
    meets = offset < 1e-7
    assert run.outcome == (Outcome.singular_geometry if meets else Outcome.converged)
    assert (run.time < 2.0) == meets


def test_an_exact_equilibrium_stays():
    """No derivative bounds the step of a mass at rest."""
    params = FORMER.with_(mu=0.0, k3=1.0)
    run = simulate(params, t_end=30.0, initial_state=(0.0, 0.5, 0.0, 0.0), **IDENTITY)
    assert run.outcome == Outcome.converged
    np.testing.assert_allclose(run.y, 0.5, atol=1e-15)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_without_stick_a_run_has_the_events_of_a1_until_it_would_stick(direction):
    """The arrival that friction holds is one event, however often friction then reverses."""
    judged, several, draw = 0, 0, np.random.default_rng(3)
    while judged < 4:
        params = FORMER.with_(mu=0.3, belt_speed=direction * draw.uniform(0.02, 0.3))
        angles = draw.uniform(0.0, np.pi, 2)
        start = draw.uniform([-0.2, -0.1, -1, -0.3], [0.2, 0.3, 1, 0.3])
        scene = {"t_end": 20.0, "initial_state": start}
        reference = simulate_scipy(params, *angles, tol=1e-12, **scene)
        if Regime.stick not in reference.regimes:
            continue
        until = reference.regimes.index(Regime.stick)
        run = simulate(params, *angles, model="A1-no-stick", **scene)
        assert run.outcome == Outcome.accumulation
        # the reference calls every arrival at belt speed by one name
        expected = [REVERSAL if k == STICK else k for k in reference.event_kinds]
        assert run.event_kind.values.tolist() == expected[:until]
        np.testing.assert_allclose(
            run.event_time, reference.event_times[:until], atol=1e-8
        )
        judged += 1
        several += until > 1
    assert several >= 1
