"""A1 as a system in SI units."""

import numpy as np

from squealpipe import Parameters
from squealpipe.brake.a1.motion_system import brake_of, parameters_of_run


def test_brake_in_si_is_the_brake_in_its_own_units():
    """Micrometres, newtons per micrometre and kilohertz change nothing but the units."""
    mass, stiffness, length = 0.31, 2.7e7, 3.3e-6
    time = (mass / stiffness) ** 0.5
    plain = Parameters(k3=0.9, belt_speed=1.3, length1=4.0, length2=6.0, damping1=0.01)
    real = Parameters(
        mass=mass,
        k1=stiffness,
        k2=stiffness,
        k3=0.9 * stiffness,
        belt_speed=1.3 * length / time,
        preload=length,
        length1=4.0 * length,
        length2=6.0 * length,
        damping1=0.01 * (mass * stiffness) ** 0.5,
    )
    times = np.linspace(0.0, 30.0, 61)
    ours, theirs = (
        brake_of(params).simulate(
            30.0 * unit, times=times * unit, **parameters_of_run(params, 2.6, 2.6)
        )
        for params, unit in ((real, time), (plain, 1.0))
    )
    assert theirs.sizes["event"] > 5
    np.testing.assert_array_equal(ours.event_kind, theirs.event_kind)
    np.testing.assert_allclose(ours.event_time / time, theirs.event_time, rtol=1e-11)
    np.testing.assert_allclose(ours.x / length, theirs.x, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(
        ours.vy * time / length, theirs.vy, rtol=1e-10, atol=1e-11
    )
