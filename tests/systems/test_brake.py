"""The brake as a system: the same motion as A1's own loop, event by event."""

import math

import numpy as np
import pytest

from squealpipe import Parameters, simulate
from squealpipe.models.variants import VARIANT_RULES
from squealpipe.schema import Outcome
from squealpipe.systems.brake import brake, brake_of, parameters_of_run


@pytest.mark.parametrize(
    ("damping", "model"), [(0.05, "A1"), *((0.0, model) for model in VARIANT_RULES)]
)
def test_events_and_states_are_those_of_a1(damping, model):
    rng = np.random.default_rng(3)
    compared, events = 0, 0
    for _ in range(12):
        params = Parameters(
            mass=0.5,
            k1=100.0,
            k2=100.0 * rng.uniform(0.5, 2.0),
            k3=100.0 * rng.uniform(0.3, 1.5),
            mu=rng.uniform(0.1, 0.7),
            belt_speed=rng.choice([-1, 1]) * 10 ** rng.uniform(-0.5, 2.0),
            length1=rng.uniform(2.0, 8.0),
            length2=rng.uniform(2.0, 8.0),
            damping1=damping,
            damping2=2.0 * damping,
        )
        angles = rng.uniform(0.0, np.pi, 2)
        t_end = 40.0 * params.time_unit
        times = np.linspace(0.0, t_end, 9)
        ours = brake_of(params, model).simulate(
            t_end, times=times, **parameters_of_run(params, *angles)
        )
        other = simulate(params, *angles, t_end=t_end, times=times, model=model)
        if other.outcome == Outcome.accumulation:  # where the mass would stick
            assert not VARIANT_RULES[model].sticks
            assert ours.outcome == Outcome.accumulation
            shared = ours.event_time[: other.sizes["event"]]
            np.testing.assert_allclose(shared, other.event_time, atol=1e-10 * t_end)
            continue
        compared += 1
        np.testing.assert_allclose(ours.event_time, other.event_time, atol=1e-10 * t_end)
        events += ours.sizes["event"]
        names = [
            each.attrs["flag_meanings"].split() for each in (ours.event_kind, other.event_kind)
        ]
        mine, theirs = (
            [n[k] for k in d.event_kind.values] for n, d in zip(names, (ours, other), strict=True)
        )
        assert mine == theirs
        for name in ("x", "y", "vx", "vy"):
            scale = max(1.0, float(np.abs(other[name]).max()))
            np.testing.assert_allclose(ours[name], other[name], atol=1e-9 * scale)
    assert compared > 3
    assert events > 50 or model != "A1"


def test_the_late_part_may_begin_at_an_event():
    """The motion stays the same: the contact at that very instant was lost."""
    given = {"k3": 0.75, "mu": 0.35, "static_mu": 0.35, "belt_speed": 0.4, "length1": 5.0}
    given |= {"length2": 5.0, "alpha1": 0.9, "alpha2": 2.0}
    start = {"y": 1.5, "vy": 0.3}
    run = brake().simulate(12.0, start=start, **given)
    plain, late = (
        brake().ensemble(12.0, start=start, t_late=t, **given)
        for t in (11.0, float(run.event_time[0]))
    )
    assert float(late.first_contact) == float(run.event_time[0])
    for name in ("contact_force_max", "x", "y", "vx", "vy"):
        np.testing.assert_allclose(late[name], plain[name], rtol=1e-9)
    np.testing.assert_allclose(late.late_contact_force_max, late.contact_force_max, rtol=1e-12)


@pytest.mark.parametrize("x", [0.3, -0.3])
def test_mass_at_belt_speed_as_printed_leaves_to_where_the_springs_pull(x):
    params, times = Parameters(belt_speed=0.4), [0.0, 1.0, 3.0]
    ours = brake_of(params, "A1-as-printed").simulate(
        3.0,
        times=times,
        start={"x": x, "y": 0.2, "vx": 0.4, "vy": 0.0},
        **parameters_of_run(params, 0.5, 0.7),
    )
    other = simulate(
        params, 0.5, 0.7, t_end=3.0, times=times, model="A1-as-printed",
        initial_state=(x, 0.2, 0.4, 0.0),
    )  # fmt: skip
    np.testing.assert_allclose(ours.x, other.x, atol=1e-12)


def test_springs_of_a_million_preload_lengths_keep_their_force():
    params, times = Parameters(length1=1e6, length2=2e6), [0.0, 10.0, 20.0]
    ours = brake_of(params).simulate(20.0, times=times, **parameters_of_run(params, 0.5, 0.7))
    other = simulate(params, 0.5, 0.7, t_end=20.0, times=times)
    np.testing.assert_allclose(ours.x, other.x, atol=1e-12)


def test_friction_as_printed_takes_no_table():
    with pytest.raises(ValueError, match="no tables"):
        brake("linear 0:0.4 1:0.3", model="A1-as-printed")


def test_a_mass_at_belt_speed_that_nothing_holds_or_pulls_slides_below_it():
    """Eq. (4) as printed repels from belt speed; without friction nothing happens there."""
    at_belt = {"initial_state": (0.0, 0.0, 3.0, 0.0), "times": np.array([0.0, 0.01])}
    printed = simulate(
        Parameters(belt_speed=3.0),
        math.pi / 2,
        math.pi / 2,
        t_end=1.0,
        model="A1-as-printed",
        **at_belt,
    )
    assert printed.vx[1] < 3.0
    assert (printed.event_time > 0.0).all()
    at_belt["initial_state"] = (0.0, 0.5, 3.0, 0.0)
    smooth = simulate(Parameters(mu=0.0, belt_speed=3.0), 1.0, 1.0, t_end=1.0, **at_belt)
    assert (smooth.event_time > 0.0).all()
