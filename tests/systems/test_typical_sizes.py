"""Typical sizes of states: numbers, or functions of the parameters, in each run of an ensemble."""

import numpy as np
import pytest
from squealpipe.systems.shipped.brake import brake_of, parameters_of_run

from squealpipe import Parameters, Switch, System


def oscillator(size):
    """A mass on a spring that is reflected at the stop y = 0."""
    return System(
        "oscillator",
        states={"y": ("m", size), "v": ("m/s", size)},
        parameters={"amplitude": 1.0},
        regimes={"free": {}},
        field=lambda t, s, p, r: {
            "y": s.v,
            "v": -s.y * (1.0 + (s.y / p.amplitude) ** 2),
        },
        switches=[
            Switch(
                "bounce",
                "free",
                lambda t, s, p, r: s.y,
                "free",
                reset=lambda t, s, p, r: {"v": -s.v},
            )
        ],
        start={"y": 1.0, "v": 0.0},
    )


def test_motions_of_any_size_in_one_ensemble_are_as_exact_as_alone():
    """In proportion to the size they are one motion, whose energy is kept."""
    sizes = np.array([1e-60, 1e-9, 1.0, 3e12])
    system = oscillator(lambda p: p.amplitude)
    runs = [
        system.ensemble(20.0, start={"y": size}, amplitude=np.array([*sizes, size]))
        for size in sizes
    ]
    for place, (run, size) in enumerate(zip(runs, sizes, strict=True)):
        own = run.isel(amplitude=place)
        alone = run.isel(amplitude=-1)
        for name in ("y", "v", "y_max", "first_bounce", "count_bounce"):
            assert own[name] == alone[name]
        y, v = float(own.y) / size, float(own.v) / size
        assert 0.5 * (v**2 + y**2) + 0.25 * y**4 == pytest.approx(0.75, rel=1e-12)
        np.testing.assert_allclose(
            [y, v, own.count_bounce],
            [runs[2].y[2], runs[2].v[2], runs[2].count_bounce[2]],
            rtol=1e-11,
        )


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


def test_a_size_that_is_not_positive_is_refused():
    """By name, when the system is made and when it is run."""
    with pytest.raises(ValueError, match="typical size of state 'y' is -1"):
        oscillator(lambda p: -p.amplitude)
    with pytest.raises(ValueError, match="typical size of y is 0"):
        oscillator(lambda p: p.amplitude).simulate(1.0, amplitude=0.0)
