"""Slow decay and growth are no cycles: labels against the energy that a motion has later on."""

import numpy as np
import pytest

from squealpipe import System, limit_cycle
from squealpipe.functions import sin
from squealpipe.parameters import Parameters
from squealpipe.schema import meanings
from squealpipe.systems.cycles.solution import CycleAccuracy
from squealpipe.systems.motion import AT_REST, MotionKind
from tests.systems.smooth_systems import elastic_ball, linear, oscillator, van_der_pol

pendulum = oscillator("damped pendulum", lambda t, x, v, p: -sin(x) - p.d * v, d=0.0)
spring = oscillator(
    "stiffening spring",
    lambda t, x, v, p: -p.k * x - p.cubic * x**3 - p.d * v,
    k=1.0,
    cubic=0.0,
    d=0.0,
)


def label(system, **options):
    cycle = system.limit_cycle(**options)
    assert cycle.attrs["closing_tolerance"] == CycleAccuracy.closing
    return meanings(cycle.outcome)[int(cycle.outcome)]


@pytest.mark.parametrize(
    "d", [5e-12, -2e-11, -1e-7, 1e-3, pytest.param(1e-10, marks=pytest.mark.release)]
)
def test_what_decays_or_grows_beyond_round_off_is_unsettled(d):
    assert label(pendulum, d=d) == "unsettled"


@pytest.mark.parametrize(
    "d",
    [
        0.0,
        pytest.param(1e-15, marks=pytest.mark.release),
        pytest.param(-1e-15, marks=pytest.mark.release),
    ],
)
def test_what_round_off_hides_is_a_member_of_a_family(d):
    assert label(pendulum, d=d) == "family_member"


def test_what_dies_out_or_grows_soon_has_its_label():
    assert label(pendulum, d=1e-2) == "equilibrium"
    # a pendulum that gains energy turns over in the end, and a run of its turns takes seconds
    assert label(spring, d=-1e-2, start={"x": 1.0}) == "unsettled"


DRAWS = np.random.default_rng(67).uniform(size=(300, 6))


@pytest.mark.parametrize(
    "draws",
    [
        DRAWS[:2],
        pytest.param(DRAWS[2:34], marks=pytest.mark.release),
        pytest.param(DRAWS, marks=pytest.mark.long),
    ],
    ids=["two", "thirty-two", "all"],
)
def test_random_oscillators_have_the_label_of_their_later_energy(draws):
    """Energy decays at a rate between d and 4/3 d, as of the linear and the cubic spring.

    Mean squares of the speed over the energy, twice the kinetic energy's share, by the virial
    theorem. A cycle is looked for in runs of 240 to 840.
    """
    for stiffness, cubic, amplitude, size, sign, damped in draws:
        d = 10.0 ** (-13.0 + 11.0 * size) * np.sign(sign - 0.4) * (damped < 0.8)
        values = {"k": 0.2 + 3.0 * stiffness, "cubic": cubic, "d": d}
        start = {"x": 0.3 + 1.5 * amplitude}
        allowed = set()
        if d == 0.0:
            allowed = {"family_member"}
        else:
            # decay over a period is beyond round-off: the slowest is 1e-13 over less than 14 s
            slowest, fastest = (
                np.exp(-0.5 * rate * d * 10.0 * run)
                for rate, run in ((1.0, 240.0), (4.0 / 3.0, 840.0))
            )
            if slowest > AT_REST or fastest > AT_REST:
                allowed.add("unsettled")
            if fastest < AT_REST:
                allowed.add("equilibrium")
        assert label(spring, start=start, **values) in allowed, (values, start)


def test_a_basin_tells_decay_by_the_drift_over_the_run():
    half = {"x": np.array([0.5])}
    decay = pendulum.basin(
        3000.0, start=half, d=np.array([0.0, 1e-7, -1e-9]), workers=1
    )
    assert decay.attrs["drift_tolerance"] == 1e-9
    assert decay.motion.values[0].tolist() == [
        MotionKind.cycle,
        MotionKind.unsettled,
        MotionKind.unsettled,
    ]
    grows = pendulum.basin(300.0, start=half, d=np.array([-1e-8, 1e-13]), workers=1)
    assert grows.motion.values[0].tolist() == [MotionKind.unsettled, MotionKind.cycle]


def test_forced_and_bouncing_motions_drift_too():
    """Of a forced oscillator a free motion of half the period decays; a ball loses its height."""
    starts = {"x": np.array([0.5])}
    forced = linear.basin(
        1500.0, start=starts, omega=0.5, damping=np.array([0.0, 1e-8, 0.1]), workers=1
    )
    assert forced.motion.values[0].tolist() == [
        MotionKind.cycle,
        MotionKind.unsettled,
        MotionKind.cycle,
    ]
    restitution = np.array([1.0, 1.0 - 1e-9])
    ball = elastic_ball.basin(
        300.0, start={"x": np.array([1.0])}, restitution=restitution, workers=1
    )
    assert ball.motion.values[0].tolist() == [MotionKind.cycle, MotionKind.unsettled]
    assert label(elastic_ball) == "family_member"
    assert label(elastic_ball, restitution=1.0 - 1e-11) == "unsettled"


def test_a_weak_attraction_is_a_cycle_on_it_and_slow_growth_beside_it():
    assert label(van_der_pol, mu=1e-7) == "converged"
    assert label(van_der_pol, mu=1e-11, start={"x": 1.5}) == "unsettled"


@pytest.mark.release
def test_a_long_chain_of_legs_closes_by_the_rule_of_short_ones():
    """A1 at (1.2, 1.2) with k3 = 1000, of 68 legs, was a member of a family closing to 2e-11."""
    found = limit_cycle(Parameters(k3=1e3), 1.2, 1.2, guess=(0.1, 1.01, 0.0, 0.0))
    assert meanings(found.outcome)[int(found.outcome)] == "family_member"
    assert float(found.residual) < 1e-12


@pytest.mark.parametrize("t_end", [14.0, 30.0, 60.0])
def test_rests_that_still_decay_are_one_attractor(t_end):
    """Of x' = -x all starts come to one rest; of x' = x - x^3 those of each sign do."""
    for rate, starts, numbers in (
        (lambda x: -x, [0.5, 1.0, 2.0, 5.0, 100.0], [0, 0, 0, 0, 0]),
        (lambda x: x - x**3, [-2.0, -0.5, 0.3, 3.0], [0, 0, 1, 1]),
    ):
        system = System(
            "decay",
            states={"x": "m"},
            parameters={"rate": 1.0},
            regimes={"free": {}},
            field=lambda t, s, p, r, rate=rate: {"x": p.rate * rate(s.x)},
            start={"x": 1.0},
            time_scale=1.0,
        )
        found = system.basin(t_end, start={"x": starts})
        assert (found.motion == 1).all()
        assert found.attractor.values.tolist() == numbers
