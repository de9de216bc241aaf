"""Steps that must not be believed: what their series do not show, the check at their ends does."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from squealpipe import Switch, System
from squealpipe.brake.a1.motion_system import brake_of, parameters_of_run
from squealpipe.functions import cos, exp, sin, tanh
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome


def flight(speed, start, **options):
    """A point at constant speed."""
    return System(
        "flight",
        states={"x": "1"},
        parameters={},
        regimes={"flies": {}, "landed": {}},
        field=lambda t, s, p, r: {"x": speed},
        start={"x": start, "regime": "flies"},
        **options,
    )


def landing(when):
    return [Switch("landing", "flies", when, "landed")]


@pytest.mark.parametrize("number", [0.7, 3.7, 12.0, 300.0])
def test_a_flight_at_constant_speed_lands_on_a_wavy_floor(number):
    """The motion is linear in time, so that it limits no step: the floor has to."""
    floor = System(
        "wavy floor",
        states={"x": "1", "y": "1"},
        parameters={"number": 1.0},
        regimes={"flies": {}, "landed": {}},
        field=lambda t, s, p, r: {"x": 1.0, "y": -0.1},
        switches=landing(lambda t, s, p, r: s.y - 0.05 * sin(p.number * s.x)),
        start={"x": 0.0, "y": 1.0, "regime": "flies"},
    )

    def height(t):
        return 1.0 - 0.1 * t - 0.05 * np.sin(number * t)

    times = np.linspace(0.0, 20.0, 400_001)
    first = int(np.argmax(height(times) < 0.0))
    exact = brentq(height, times[first - 1], times[first], xtol=1e-15)
    run = floor.simulate(20.0, number=number)
    np.testing.assert_allclose(run.event_time, [exact], rtol=1e-12)


@pytest.mark.parametrize(
    ("output", "low", "high"),
    [
        (lambda t, s, p, r: 1.0 / (1.0 + s.x**2), 1.0 / 290.0, 1.0),
        (lambda t, s, p, r: tanh(3.0 * s.x), -np.tanh(9.0), 1.0),
        (lambda t, s, p, r: exp(-50.0 * s.x**2), 0.0, 1.0),
        (lambda t, s, p, r: exp(-5e4 * s.x**2), 0.0, 1.0),
    ],
)
def test_outputs_that_are_no_polynomials_keep_their_range(output, low, high):
    run = flight(1.0, -3.0, outputs={"f": ("1", output)}).ensemble(20.0)
    np.testing.assert_allclose([run.f_min, run.f_max], [low, high], atol=1e-12)


def test_an_output_that_is_never_a_number_has_no_extremes():
    root = ("1", lambda t, s, p, r: (s.x - 50.0) ** 0.5)
    run = flight(1.0, -3.0, outputs={"f": root}).ensemble(20.0)
    assert run.outcome == Outcome.converged
    assert np.isnan([run.f_min, run.f_max, run.late_f_min, run.late_f_max]).all()
    np.testing.assert_allclose([run.x_min, run.x_max], [-3.0, 17.0], rtol=1e-14)


def test_an_exponential_law_acts_where_the_speed_is_nearly_the_belts():
    """First event by DOP853 from the equations of motion, from far outside its layer."""
    speed = 1e-4 * np.sqrt(2e7)
    params = Parameters(
        mass=1.0,
        k1=1.0,
        k2=1.0,
        k3=0.65,
        preload=1.0,
        length1=15.0,
        length2=15.0,
        mu=0.3,
        mu_static=0.4,
        friction_law="exponential",
        friction_speed=0.004 / speed,
        belt_speed=0.47 / speed,
    )
    start = {"x": 2.0, "y": -0.55, "vx": -2.1, "vy": -2.25}
    run = brake_of(params).simulate(
        3.0, start=start, **parameters_of_run(params, 2.84, 1.10)
    )
    assert float(run.event_time[0]) == pytest.approx(2.62010873, abs=2e-8)


def test_a_layer_that_a_step_leads_through_is_not_lost():
    """A kick of width 0.002 in the middle of a free flight."""
    kicked = System(
        "kick",
        states={"x": "1", "v": "1"},
        parameters={},
        regimes={"only": {}},
        field=lambda t, s, p, r: {
            "x": 1.0,
            "v": exp(-((s.x - 3.0) * 500.0) * ((s.x - 3.0) * 500.0)),
        },
        start={"x": 0.0, "v": 0.0},
    )
    end = float(kicked.ensemble(20.0).v)
    assert end == pytest.approx(np.sqrt(np.pi) / 500.0, rel=1e-10)


def test_surfaces_composed_with_monotone_functions_fire_when_dop853_says():
    """A pendulum whose angle passes a level; the surface hides it in saturation."""

    def wrap(f):
        return lambda t, s, p, r: f(0.4 - s.x)

    own = solve_ivp(
        lambda t, z: [z[1], -np.sin(z[0]) + 0.2 * np.cos(1.7 * z[1])],
        (0.0, 10.0),
        [-1.0, 0.3],
        "DOP853",
        rtol=1e-12,
        atol=1e-12,
        max_step=0.05,
        events=lambda t, z: 0.4 - z[0],
    )
    exact = own.t_events[0][0]
    for f in (
        lambda u: u,
        lambda u: tanh(40.0 * u),
        lambda u: exp(30.0 * u) - 1.0,
        lambda u: u / (1.0 + 100.0 * u * u),
    ):
        pendulum = System(
            "pendulum",
            states={"x": "1", "v": "1"},
            parameters={},
            regimes={"before": {}, "after": {}},
            field=lambda t, s, p, r: {"x": s.v, "v": -sin(s.x) + 0.2 * cos(1.7 * s.v)},
            switches=[Switch("level", "before", wrap(f), "after")],
            start={"x": -1.0, "v": 0.3, "regime": "before"},
        )
        run = pendulum.simulate(10.0)
        np.testing.assert_allclose(run.event_time, [exact], atol=1e-10)


def test_a_mass_that_falls_from_two_metres_meets_the_tanh_of_its_height():
    """The motion is a parabola: no order of it shows what tanh does."""
    fall = System(
        "fall",
        states={"x": "m", "v": "m/s"},
        parameters={},
        regimes={"falls": {}, "landed": {}},
        field=lambda t, s, p, r: {"x": s.v, "v": -9.8},
        switches=[Switch("lands", "falls", lambda t, s, p, r: tanh(s.x), "landed")],
        start={"x": 2.0, "v": 0.0, "regime": "falls"},
    )
    times = fall.simulate(1.0).event_time
    np.testing.assert_allclose(times, [np.sqrt(4.0 / 9.8)], rtol=1e-14)


def crossing(when):
    """An oscillator that passes x = 0 after a quarter of its period of 2π."""
    return System(
        "crossing",
        states={"x": "1", "v": "1"},
        parameters={"scale": 1.0},
        regimes={"before": {}, "after": {}},
        field=lambda t, s, p, r: {"x": s.v, "v": -s.x},
        switches=[Switch("pass", "before", when, "after")],
        start={"x": 1.0, "v": 0.0, "regime": "before"},
    )


@pytest.mark.parametrize("power", [3, 5, 7, 9, 11])
def test_a_root_of_odd_multiplicity_is_an_event(power):
    oscillator = crossing(lambda t, s, p, r: -1e-165 * tanh(2.0 * (-s.x) ** power))
    run = oscillator.ensemble(5.0, start={"x": np.linspace(0.5, 2.0, 20)})
    np.testing.assert_allclose(run.first_pass, np.pi / 2, rtol=1e-14)
    assert crossing(lambda t, s, p, r: s.x ** (power + 1)).simulate(5.0).event.size == 0


@pytest.mark.parametrize("power", [3, 5, 7, 9, 11])
def test_a_multiple_root_that_round_off_hides_is_an_outcome(power):
    """The same root, where no form of the surface shows that it is multiple."""
    oscillator = crossing(lambda t, s, p, r: s.x**power + s.x**power * s.v**2)
    run = oscillator.ensemble(5.0, start={"x": np.linspace(0.5, 2.0, 20)})
    assert (run.outcome == Outcome.hidden_event).all()
    assert run.first_pass.isnull().all()


@pytest.mark.parametrize("level", [0.1, 0.25, 0.6])
@pytest.mark.parametrize("power", [3, 4, 5, 8])
def test_powers_of_states_fall_when_they_should(power, level):
    """Order K of the series of xⁿ is up to n^K times that of x."""
    run = crossing(lambda t, s, p, r: s.x**power - level).simulate(2.0)
    exact = np.arccos(level ** (1.0 / power))
    np.testing.assert_allclose(run.event_time, [exact], rtol=2e-12)


def test_a_surface_of_any_scale_is_the_same_surface():
    oscillator = crossing(lambda t, s, p, r: p.scale * (s.x + 0.3 * s.v))
    run = oscillator.ensemble(5.0, scale=np.array([1e-200, 1e-165, 1.0, 1e150]))
    np.testing.assert_allclose(run.first_pass, np.arctan(1.0 / 0.3), rtol=1e-14)


BALL = System(
    "ball over a floor",
    states={"y": "m", "v": "m/s"},
    parameters={"floor": 0.0, "restitution": 0.9, "gravity": 9.81},
    regimes={"flight": {}},
    field=lambda t, s, p, r: {"y": s.v, "v": -p.gravity},
    switches=[
        Switch(
            "impact",
            "flight",
            lambda t, s, p, r: s.y - p.floor,
            "flight",
            reset=lambda t, s, p, r: {"v": -p.restitution * s.v},
        )
    ],
    start={"y": 1.0, "v": 0.0},
)


@pytest.mark.parametrize("floor", [0.0, 1.0, 1e3, 1e5])
def test_impacts_accumulate_wherever_zero_is_and_however_soon_the_run_ends(floor):
    """The last impacts fall on round-off of the height; their times are a geometric series."""
    for ratio in (0.3, 0.6, 0.9, 0.97):
        exact = np.sqrt(2.0 / 9.81) * (1.0 + ratio) / (1.0 - ratio)
        for later in (1e-3, 1e-2, 0.1, 1.0):
            run = BALL.simulate(
                exact * (1.0 + later),
                times=np.zeros(1),
                start={"y": floor + 1.0},
                floor=floor,
                restitution=ratio,
            )
            assert run.outcome == Outcome.accumulation
            assert abs(run.end_time - exact) < 1e-4 * exact


def drop(height, gravity, restitution):
    """A ball falls from rest; its impacts come to an end at the time in closed form."""
    exact = np.sqrt(2.0 * height / gravity) * (1.0 + restitution) / (1.0 - restitution)
    run = BALL.simulate(
        2.0 * exact,
        times=np.zeros(1),
        start={"y": height},
        gravity=gravity,
        restitution=restitution,
    )
    assert run.outcome == Outcome.accumulation
    assert float(run.end_time) == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize(("height", "restitution"), [(7000.0, 0.3), (6000.0, 0.9)])
def test_a_ball_from_a_great_height_bounces_on(height, restitution):
    """Round-off of the height hides the floor from the first impact on, or once it is low."""
    drop(height, 9.81, restitution)


@pytest.mark.release
def test_random_balls_come_to_rest_at_the_closed_form_time():
    rng = np.random.default_rng(23)
    for _ in range(200):
        height, gravity = 10.0 ** rng.uniform([-4.0, -6.0], [5.0, 4.0])
        drop(height, gravity, rng.uniform(0.1, 0.95))


def test_a_level_that_is_passed_from_a_great_height_is_passed_once():
    """By a marker, and by regimes that share it: the fall is 1, the way back up 1/2 each way."""
    field = {
        "states": {"y": "m", "v": "m/s"},
        "parameters": {},
        "field": lambda t, s, p, r: {"y": s.v, "v": -9.81 + r.lift},
        "start": {"y": 1.0, "v": 0.0, "regime": "above"},
    }
    marked = System(
        "level",
        regimes={"above": {"lift": 0.0}},
        switches=[Switch("pass", "above", lambda t, s, p, r: s.y, "above")],
        **field,
    )
    shared = System(
        "spring of constant force",
        regimes={"above": {"lift": 0.0}, "below": {"lift": 3.0 * 9.81}},
        switches=[
            Switch("in", "above", lambda t, s, p, r: s.y, "below"),
            Switch("out", "below", lambda t, s, p, r: -s.y, "above"),
        ],
        **field,
    )
    for height in np.geomspace(1e3, 1e5, 20):
        fall = np.sqrt(2.0 * height / 9.81)
        options = {"times": np.zeros(1), "start": {"y": height}}
        run = marked.simulate(3.0 * fall, **options)
        np.testing.assert_allclose(run.event_time, [fall], rtol=1e-14)
        run = shared.simulate(10.5 * fall, **options)
        exact = fall * np.array([1.0, 2.0, 4.0, 5.0, 7.0, 8.0, 10.0])
        np.testing.assert_allclose(run.event_time, exact, rtol=1e-13)


PAIR = System(
    "pair that chatters",
    states={"x": "m", "u": "m/s", "y": "m", "v": "m/s"},
    parameters={"restitution": 0.61},
    regimes={"free": {}},
    field=lambda t, s, p, r: {
        "x": s.u,
        "u": (0.97 - 6.8 * s.x) / 7.0,
        "y": s.v,
        "v": -(1.69 + 1.17 * s.y) / 5.3,
    },
    switches=[
        Switch(
            "impact",
            "free",
            lambda t, s, p, r: s.y - s.x + 0.28,
            "free",
            reset=lambda t, s, p, r: {
                "u": s.u + 5.3 / 12.3 * (1.0 + p.restitution) * (s.v - s.u),
                "v": s.v - 7.0 / 12.3 * (1.0 + p.restitution) * (s.v - s.u),
            },
        )
    ],
    start={"x": 0.01, "u": 1.6, "y": 2.0, "v": 0.5},
)


@pytest.mark.parametrize(
    "restitution",
    [0.2, 0.9, *(pytest.param(r, marks=pytest.mark.release) for r in (0.4, 0.61, 0.8))],
)
def test_a_pair_that_chatters_does_so_whatever_time_its_run_has_left(restitution):
    """One of 10,000 random pairs ended as a hidden event, just before the end of its run."""
    options = {"times": np.zeros(1), "restitution": restitution}
    long = PAIR.simulate(200.0, **options)
    assert long.outcome == Outcome.accumulation
    for later in np.geomspace(1e-3, 1.0, 30):
        run = PAIR.simulate(float(long.end_time) + later, **options)
        assert run.outcome == Outcome.accumulation
        assert abs(run.end_time - long.end_time) < 1e-6


def test_a_crossing_at_the_very_end_of_a_step_is_not_passed():
    """A step saw it beyond its end, and the next one, whose surface has other round-off, before.

    It was passed where the surface is 0, or a few ulps beyond, as the next step starts.
    """
    swing = System(
        "swing",
        states={"x": "1", "y": "1", "z": "1", "w": "1"},
        parameters={"level": 0.0, "speed": 1.0},
        regimes={"flies": {}, "landed": {}},
        field=lambda t, s, p, r: {
            "x": 1e-3 * s.x * s.x - p.speed,
            "y": -p.speed,
            "z": s.w,
            "w": -s.z,
        },
        switches=landing(lambda t, s, p, r: 0.1 * s.x + 0.2 * s.y - p.level),
        start={"x": 3.0, "y": 3.0, "z": 0.7, "w": 0.4, "regime": "flies"},
    )
    rng = np.random.default_rng(4)
    for steps in 8 * (1, 2, 4, 7):
        first, speed = float(rng.uniform(33.0, 45.0)), float(rng.uniform(0.8, 1.3))
        given = {"start": {"x": first, "y": 0.7 * first}, "speed": speed, "workers": 1}
        # the state at the end of the last of the steps
        end = swing.ensemble(12.0, level=-99.0, max_steps=steps, **given)
        height = float(0.1 * end.x + 0.2 * end.y)
        levels = height + 0.5 * np.spacing(height) * np.arange(-4, 5)
        run = swing.ensemble(12.0, level=levels, **given)
        assert (run.count_landing == 1).all()
