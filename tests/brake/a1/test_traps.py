"""What other integrators with events got wrong, tried on ours; closed forms at (π/2, π).

There K is the identity for equal springs, so in contact y oscillates about κ/(1 + κ) at √(1 + κ),
in units of m = k = l_pre = 1. In stiff contacts the friction limit is the largest term of the stick
margin."""

import numpy as np
import pytest

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.codes import Event
from squealpipe.schema import Outcome
from tests.former import FORMER
from tests.oracles.a1_long_double import simulate_reference

IDENTITY = {"alpha1": 0.5 * np.pi, "alpha2": np.pi, "model": "A1-linear-springs"}
KAPPA = 0.75
REST, OMEGA = KAPPA / (1 + KAPPA), np.sqrt(1 + KAPPA)
FRICTIONLESS = FORMER.with_(k3=KAPPA, mu=0.0)


def random_runs(size, seed):
    rng = np.random.default_rng(seed)
    parameters = {
        "k2": rng.uniform(0.3, 3.0, size),
        "k3": rng.uniform(0.3, 3.0, size),
        "mu": rng.uniform(0.0, 0.8, size),
        "belt_speed": rng.choice([0.05, 0.3, 5.0, 100.0, -0.3], size),
        "length1": rng.uniform(2.0, 30.0, size),
    }
    return parameters, rng.uniform(0, np.pi, size), rng.uniform(0, np.pi, size)


@pytest.mark.parametrize("exponent", range(-14, -2))
@pytest.mark.parametrize("phase", [0.3, 1.0, 2.0])
def test_two_crossings_inside_a_step(exponent, phase):
    """y rises above l_pre by the depth alone: it leaves the belt and lands again."""
    depth = 10.0**exponent
    amplitude = 1.0 + depth - REST
    state = (
        0.0,
        REST + amplitude * np.cos(-phase),
        0.0,
        -amplitude * OMEGA * np.sin(-phase),
    )
    t_top = phase / OMEGA
    # In flight y'' = −y: the mass is back after about 2 √(2 depth).
    flight = 2.0 * np.sqrt(2.0 * depth)
    options = {
        "t_end": t_top + 2.0,
        "initial_state": state,
        "log_events": 4,
        **IDENTITY,
    }
    run = run_ensemble(FRICTIONLESS, **options)
    if exponent == -14 and run.separations == 0:
        # As deep as the state's own round-off after a step.
        assert abs(run.lowest_contact_force) < 2e-14
        return
    assert run.outcome == Outcome.converged
    assert run.event_kinds.tolist() == [Event.separation, Event.contact, -1, -1]
    assert abs(run.event_times[:2].mean() - t_top) < 0.3 * flight
    assert run.event_times[1] - run.event_times[0] == pytest.approx(
        flight, rel=0.1 + 3e-15 / depth
    )
    near = 10.0**-13 if exponent < -12 else depth
    missed = (
        0.0,
        REST + (1.0 - near - REST) * np.cos(phase),
        0.0,
        (1.0 - near - REST) * OMEGA * np.sin(phase),
    )
    assert (
        run_ensemble(FRICTIONLESS, **options | {"initial_state": missed}).separations
        == 0
    )


def test_an_event_at_the_end_and_at_an_asked_instant():
    params = FORMER.with_(k3=2.0)
    time = float(
        run_ensemble(params, t_end=5.0, log_events=1, **IDENTITY).event_times[0]
    )
    before, after = np.nextafter(time, 0.0), np.nextafter(time, np.inf)
    counts = []
    for t_end in (before, time, after):
        run = run_ensemble(params, t_end=t_end, log_events=3, times=[t_end], **IDENTITY)
        assert run.outcome == Outcome.converged
        assert run.time == t_end
        assert run.samples[0, 1] == pytest.approx(1.0, abs=2e-15)
        counts.append(int(run.separations))
    assert counts[0] == 0
    assert counts[2] == 1
    asked = [before, time, after]
    run = run_ensemble(params, t_end=5.0, times=asked, log_events=9, **IDENTITY)
    assert (run.event_kinds == Event.separation).sum() == run.separations
    np.testing.assert_allclose(run.samples[:, 1], 1.0, rtol=0, atol=2e-15)


def test_no_event_of_a_step_that_is_cut():
    """A run to t has the events of a longer one before t, and no other."""
    parameters, *angles = random_runs(200, 5)
    ends = np.random.default_rng(6).uniform(1.0, 20.0, 200)
    long = run_ensemble(parameters, *angles, t_end=25.0, log_events=99)
    short = run_ensemble(parameters, *angles, t_end=ends, log_events=99)
    # Times that a longer run reaches before this one's end are the same bits.
    kept = np.where(long.event_times < ends[:, None], long.event_times, np.nan)
    assert kept.tobytes() == short.event_times.tobytes()
    assert np.isfinite(kept).sum() > 500


@pytest.mark.parametrize("speed", [0.0, 1e-3, -0.02])
def test_an_approach_to_stick_in_ever_shorter_slips_moves_on(speed):
    rng = np.random.default_rng(8)
    starts = rng.uniform(-0.3, 0.3, (50, 4))
    params = FORMER.with_(k3=2.0, mu=0.6, belt_speed=speed)
    run = run_ensemble(
        params, 1.2, 2.6, t_end=200.0, initial_state=starts, log_events=2000
    )
    assert (run.outcome == Outcome.converged).all()
    assert (run.sticks > 0).all()
    assert (run.event_kinds[:, -1] == -1).all()
    y, kinds = run.event_states[..., 1], run.event_kinds
    landed = (kinds >= 0) & (kinds != Event.separation)
    assert (y[landed] <= 1.0 + 1e-9).all()


def test_the_derivative_of_an_event_time():
    """dt/dκ of the first separation, t = arccos(1 − (1 + κ)/κ)/√(1 + κ), through the event."""
    kappa, step = 2.0, 1e-4
    found = run_ensemble(
        {"k3": kappa + step * np.array([-2.0, -1.0, 1.0, 2.0])},
        t_end=5.0,
        log_events=1,
        **IDENTITY,
    ).event_times[:, 0]
    slope = (found[0] - 8.0 * found[1] + 8.0 * found[2] - found[3]) / (12.0 * step)
    cosine, omega = -1.0 / kappa, np.sqrt(1.0 + kappa)
    exact = (
        -(1.0 / kappa**2) / np.sqrt(1.0 - cosine**2) / omega
        - 0.5 * np.arccos(cosine) / omega**3
    )
    assert slope == pytest.approx(exact, rel=1e-10)


COUNT = 40


def runs(kappa):
    """Unequal springs on slow belts of both directions."""
    rng = np.random.default_rng(5)
    parameters = {
        "k2": rng.uniform(0.5, 2, COUNT),
        "k3": np.full(COUNT, kappa),
        "mu": rng.uniform(0.05, 0.8, COUNT),
        "belt_speed": rng.choice([-1, 1], COUNT) * rng.uniform(0.05, 1.0, COUNT),
        "length1": rng.uniform(2, 8, COUNT),
        "length2": rng.uniform(2, 8, COUNT),
    }
    return parameters, rng.uniform(0, np.pi, (2, COUNT))


@pytest.mark.parametrize("kappa", [5e4, 1e6, 1e8])
def test_no_run_ends_in_steps_of_length_zero(kappa):
    parameters, angles = runs(kappa)
    found = run_ensemble(parameters, *angles, t_end=20.0)
    assert (found.outcome == Outcome.converged).all()
    assert found.slips.sum() > 200
    assert found.steps.max() < 2000


def test_releases_are_where_long_double_has_them():
    """First releases of contacts 1e5 times as stiff as the springs, to the round-off of y k3."""
    parameters, angles = runs(1e5)
    found = run_ensemble(parameters, *angles, t_end=2.0, log_events=4)
    judged = 0
    for job in range(10):
        params = FORMER.with_(
            **{name: float(values[job]) for name, values in parameters.items()}
        )
        exact = simulate_reference(params, *map(float, angles[:, job]), t_end=2.0)
        count = min(4, len(exact.event_times))
        np.testing.assert_allclose(
            found.event_times[job, :count],
            np.float64(exact.event_times[:count]),
            atol=1e-7,
        )
        judged += count
    assert judged >= 20


def test_a_mass_that_falls_straight_onto_a_belt_at_rest_sticks_at_once():
    """No event of its own, for it lands at the belt's speed."""
    params = FORMER.with_(belt_speed=0.0, mu=0.3)
    run = run_ensemble(
        params,
        1.0,
        1.0,
        t_end=20.0,
        model="A1-linear-springs",
        initial_state=(0.0, -1.5, 0.0, 0.0),
    )
    assert run.contacts > 3
    assert run.sticks == run.slips == run.reversals == 0
    assert run.stick_time + run.separated_time == pytest.approx(20.0, rel=1e-14)


@pytest.mark.parametrize("model", ["A1", "A1-no-stick"])
def test_a_mass_that_starts_at_belt_speed_goes_where_the_springs_pull(model):
    """Friction of μ = 0.05 cannot hold it: it slips to that side without an event."""
    x = np.array([1.5, -1.5])
    starts = np.stack([x, 0 * x, 0 * x + 0.5, 0 * x], axis=-1)
    params = FORMER.with_(belt_speed=0.5, mu=0.05)
    run = run_ensemble(params, 1.0, 1.2, t_end=0.01, model=model, initial_state=starts)
    assert not (run.reversals + run.sticks + run.slips).any()
    assert (np.sign(run.final_state[:, 2] - 0.5) == -np.sign(x)).all()
