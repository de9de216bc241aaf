"""Typical sizes of states, and scales of units, of each run of an ensemble."""

import numpy as np
import pytest

from squealpipe import Switch, System


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


@pytest.mark.release
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


def test_a_size_that_is_not_positive_is_refused():
    """By name, when the system is made and when it is run."""
    with pytest.raises(ValueError, match="typical size of state 'y' is -1"):
        oscillator(lambda p: -p.amplitude)
    with pytest.raises(ValueError, match="typical size of y is 0"):
        oscillator(lambda p: p.amplitude).simulate(1.0, amplitude=0.0)


def pendulum(**changes):
    """A pendulum pushed round by a rope that goes slack, in any units."""
    given = {
        "states": {"x": "m", "v": "m/s"},
        "parameters": {
            "mass": (1.0, "kg"),
            "stiffness": (1.0, "N m-1"),
            "load": (0.4, "N"),
            "slack": (0.1, "m"),
        },
        "regimes": {"taut": {"pulls": 1.0}, "slack": {"pulls": 0.0}},
        "field": lambda t, s, p, r: {
            "x": s.v,
            "v": (
                p.load - p.stiffness * s.x - r.pulls * p.stiffness * s.x**3 / p.slack**2
            )
            / p.mass,
        },
        "switches": [
            Switch("slackens", "taut", lambda t, s, p, r: p.slack - s.x, "slack"),
            Switch("tightens", "slack", lambda t, s, p, r: s.x - p.slack, "taut"),
        ],
        "start": {"x": 1.0, "v": 0.0},
        "outputs": {"force": ("N", lambda t, s, p, r: p.stiffness * s.x)},
        "scales": lambda p: {
            "kg": p.mass,
            "m": p.slack,
            "N": p.load,
            "s": (p.mass * p.slack / p.load) ** 0.5,
        },
    }
    return System("pendulum", **given | changes)


def test_runs_with_scales_are_the_same_bits_in_any_units():
    """Powers of two alone change no digit of the numbers themselves."""
    mass, length, time = 2.0**-31, 2.0**40, 2.0**-7
    force = mass * length / time**2
    system, number = pendulum(), np.array([0.3, 0.4, 0.5])
    plain = system.ensemble(40.0, load=number, horizon=True)
    other = system.ensemble(
        40.0 * time,
        load=number * force,
        mass=mass,
        stiffness=force / length,
        slack=0.1 * length,
        start={"x": length},
        horizon=True,
    )
    assert (plain.count_slackens > 5).all()
    for name, unit in {
        "x": length,
        "late_v_max": length / time,
        "force_max": force,
        "first_tightens": time,
        "time_in_slack": time,
        "count_slackens": 1.0,
        "lyapunov_exponent": 1.0 / time,
    }.items():
        np.testing.assert_array_equal(other[name] / unit, plain[name].values)
    energy = 0.5 - number
    now = 0.5 * plain.v**2 + 0.5 * plain.x**2 - number * plain.x
    deep = np.minimum(plain.x, 0.1)
    now += 0.25 * (deep**4 - 0.1**4) / 0.01 * (plain.x < 0.1)
    assert np.abs(now - energy).max() < 1e-12


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        (
            {"parameters": {"mass": 1.0, "stiffness": 1.0, "load": 0.4, "slack": 0.1}},
            "the function of 'x' does not have the unit",
        ),
        (
            {"outputs": {"force": ("m", lambda t, s, p, r: p.stiffness * s.x)}},
            "the function of 'force' does not have the unit",
        ),
        ({"states": {"x": "m", "v": "mm/s"}}, "unit 'mm/s': no scale is given of 'mm'"),
        (
            {
                "switches": [
                    Switch("slackens", "taut", lambda t, s, p, r: 0.1 - s.x, "slack"),
                    Switch("tightens", "slack", lambda t, s, p, r: s.x - 0.1, "taut"),
                ]
            },
            "the function of a surface does not have the unit",
        ),
    ],
)
def test_functions_that_do_not_agree_with_the_units_are_refused(changes, why):
    with pytest.raises(ValueError, match=why):
        pendulum(**changes)
