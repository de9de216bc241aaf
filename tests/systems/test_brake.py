"""The brake as a system: the same motion as A1's own loop, event by event."""

import math

import numpy as np
import pytest

from squealpipe import Parameters, simulate
from squealpipe.brake.a1.motion_system import brake


def test_the_late_part_may_begin_at_an_event():
    """The motion stays the same: the contact at that very instant was lost."""
    given = {
        "k3": 0.75,
        "mu": 0.35,
        "static_mu": 0.35,
        "belt_speed": 0.4,
        "length1": 5.0,
    }
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
    np.testing.assert_allclose(
        late.late_contact_force_max, late.contact_force_max, rtol=1e-12
    )


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
    smooth = simulate(
        Parameters(mu=0.0, belt_speed=3.0), 1.0, 1.0, t_end=1.0, **at_belt
    )
    assert (smooth.event_time > 0.0).all()
