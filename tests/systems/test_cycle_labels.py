"""Labels of settled motions that can be checked from outside: chaos, tori, families, symmetry."""

from inspect import signature

import numpy as np
import pytest
from numba import njit
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

from squealpipe import Switch, System
from squealpipe.functions import cos, sin
from squealpipe.schema import Outcome, meanings
from squealpipe.systems.branch_labels import Label
from squealpipe.systems.cycles.cycle import limit_cycle as system_cycle
from squealpipe.systems.cycles.event_map import EventMap
from squealpipe.systems.cycles.find import find_cycle, labelled
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.motion import MotionKind
from tests.systems.smooth_systems import (
    ball_on_a_table,
    block_on_a_table,
    duffing_holmes,
    elastic_ball,
    linear,
    oscillator,
    pendulum,
    square_wave,
    two_oscillators,
    ueda,
    van_der_pol,
)


def outcome(cycle):
    return meanings(cycle.outcome)[int(cycle.outcome)]


def lyapunov_exponent(force, periods=(1000, 1500), steps=200):
    """Of Duffing and Holmes' oscillator in some late periods, by the classical Runge–Kutta method.

    The first thousand are left out: at f = 0.56 it is chaotic for hundreds, then periodic.
    """
    return float(_growth(force, *periods, steps)) / (2.0 * np.pi / 1.2)


@njit
def _rates(t, z, force):
    x, v, a, b = z
    acceleration = x - x**3 - 0.2 * v + force * np.cos(1.2 * t)
    return np.array([v, acceleration, b, (1.0 - 3.0 * x**2) * a - 0.2 * b])


@njit
def _growth(force, first, last, steps):
    """Mean growth of a perturbation over a period, as a logarithm."""
    h = 2.0 * np.pi / 1.2 / steps
    z, growth = np.array([1.0, 0.0, 1.0, 0.0]), 0.0
    for period in range(last):
        for n in range(steps):
            t = n * h
            k1 = _rates(t, z, force)
            k2 = _rates(t + 0.5 * h, z + 0.5 * h * k1, force)
            k3 = _rates(t + 0.5 * h, z + 0.5 * h * k2, force)
            k4 = _rates(t + h, z + h * k3, force)
            z = z + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        size = np.hypot(z[2], z[3])
        z[2:] /= size
        growth += np.log(size) * (period >= first)
    return growth / (last - first)


@pytest.mark.parametrize(
    "force",
    [0.28, *(pytest.param(each, marks=pytest.mark.release) for each in (0.3215, 0.55))],
)
def test_chaos_settles_on_no_cycle(force):
    cycle = duffing_holmes.limit_cycle(force=force)
    assert outcome(cycle) == "unsettled"
    assert np.isnan(cycle.period)


@pytest.mark.release
@pytest.mark.parametrize("force", np.linspace(0.2, 0.6, 11))
def test_a_cycle_is_claimed_where_the_lyapunov_exponent_is_negative(force):
    settled = outcome(duffing_holmes.limit_cycle(force=force)) != "unsettled"
    assert settled == (lyapunov_exponent(force) < 0.0)


@pytest.mark.release
def test_chaos_has_a_positive_exponent_and_a_doubled_cycle_is_counted():
    assert lyapunov_exponent(0.3215) > 0.05
    cycle = duffing_holmes.limit_cycle(force=0.22)
    assert outcome(cycle) == "settled_on_2_periods"
    doubled = duffing_holmes.limit_cycle(force=0.22, periods=2)
    assert doubled.outcome == Outcome.converged
    assert doubled.stable == 1
    assert float(doubled.period) == pytest.approx(4.0 * np.pi / 1.2, rel=1e-12)


def test_cycles_of_conservative_systems_are_members_of_families():
    ball = elastic_ball.limit_cycle()
    assert outcome(ball) == "family_member"
    assert int(ball.stable) == 0
    assert float(ball.period) == pytest.approx(np.sqrt(8.0), rel=1e-10)
    swing = pendulum.limit_cycle()
    assert outcome(swing) == "family_member"
    assert int(swing.stable) == 0
    # the arithmetic–geometric mean: T = 2π / agm(1, cos(amplitude / 2))
    a, b = 1.0, np.cos(0.5 * float(swing.x_max))
    for _ in range(6):
        a, b = 0.5 * (a + b), np.sqrt(a * b)
    assert float(swing.period) == pytest.approx(2.0 * np.pi / a, rel=1e-10)
    assert float(swing.x_max) == pytest.approx(1.0, abs=1e-8)


def test_a_damped_ball_and_a_damped_family_are_no_members():
    assert outcome(van_der_pol.limit_cycle()) == "converged"
    assert outcome(linear.limit_cycle()) == "converged"


def test_a_torus_is_no_cycle():
    assert outcome(two_oscillators(2.0).limit_cycle()) == "unsettled"
    assert outcome(two_oscillators(4.0).limit_cycle()) == "family_member"


def test_a_torus_is_no_cycle_in_a_basin():
    starts = {"y": np.array([0.0, 1.0])}
    found = two_oscillators(2.0).basin(400.0, start=starts, workers=1)
    np.testing.assert_array_equal(
        found.motion, [MotionKind.cycle, MotionKind.unsettled]
    )
    np.testing.assert_allclose(found.period, [2.0 * np.pi, np.nan], rtol=1e-8)
    found = two_oscillators(4.0).basin(400.0, start=starts, workers=1)
    np.testing.assert_array_equal(found.motion, [MotionKind.cycle, MotionKind.cycle])
    np.testing.assert_allclose(found.period, 2.0 * np.pi, rtol=1e-8)
    cycle = van_der_pol.basin(200.0, start={"x": np.array([0.5, 3.0])}, workers=1)
    np.testing.assert_array_equal(cycle.motion, MotionKind.cycle)
    np.testing.assert_allclose(cycle.period, 6.663286859, rtol=1e-8)


def test_a_basin_begins_at_any_phase_of_the_forcing():
    """Half a period later this oscillator is its own mirror image."""
    period, places = 2.0 * np.pi / 1.2, np.linspace(-1.0, 1.0, 3)
    starts = {"x": places, "v": 0.4}
    early = duffing_holmes.basin(150.0 * period, start=starts, force=0.2, workers=1)
    starts = {"x": -places, "v": -0.4}
    begin = 0.5 * period
    late = duffing_holmes.basin(
        150.0 * period + begin, t_start=begin, start=starts, force=0.2, workers=1
    )
    assert len(set(early.attractor.values)) == 2
    np.testing.assert_array_equal(late.motion, early.motion)
    np.testing.assert_allclose(late.x_max, -early.x_min, rtol=1e-9)
    with pytest.raises(ValueError, match="a time not before 3"):
        duffing_holmes.basin(2.0, t_start=3.0, start=starts)


def test_a_motion_whose_forcing_has_no_known_period_is_followed_on_its_own_clock():
    driven = System(
        "driven",
        states={"x": "1", "v": "1"},
        parameters={},
        regimes={"all": {}},
        field=lambda t, s, p, r: {"x": s.v, "v": -s.x - 0.2 * s.v + cos(1.2 * t)},
        start={"x": 0.0, "v": 0.0},
    )
    became = driven.basin(401.0, start={"x": np.array([0.0, 1.0])}, workers=1)
    np.testing.assert_array_equal(became.motion, MotionKind.cycle)
    np.testing.assert_allclose(became.period, 2.0 * np.pi / 1.2, rtol=1e-8)


GRID = [
    (w, c)
    for w in np.linspace(0.1, 3.0, 18)
    for c in (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5)
]
TWENTIETH = np.random.default_rng(42).choice(len(GRID), 9, replace=False)


@pytest.mark.parametrize(
    "cases",
    [
        [GRID[i] for i in TWENTIETH],
        pytest.param(GRID[::4], marks=pytest.mark.release),
        pytest.param(GRID, marks=pytest.mark.long),
    ],
    ids=["a twentieth", "a quarter", "all"],
)
def test_forced_linear_oscillators_have_their_closed_form(cases):
    for omega, damping in cases:
        cycle = linear.limit_cycle(omega=float(omega), damping=float(damping))
        assert outcome(cycle) == "converged", (omega, damping)
        size = 1.0 / np.hypot(1.0 - omega**2, damping * omega)
        assert float(cycle.x_max) == pytest.approx(size, rel=1e-9)
        assert int(cycle.stable) == 1
        roots = np.roots([1.0, damping, 1.0])
        expected = np.sort_complex(np.exp(roots * 2.0 * np.pi / omega))
        ours = np.sort_complex(
            cycle.multiplier_real.values + 1j * cycle.multiplier_imag.values
        )
        np.testing.assert_allclose(ours, expected, atol=1e-9)


@pytest.mark.parametrize(
    "omega",
    [
        0.3,
        0.9,
        3.0,
        *(
            pytest.param(w, marks=pytest.mark.release)
            for w in (0.45, 0.7, 1.2, 1.7, 2.4)
        ),
    ],
)
def test_a_square_wave_drives_a_cycle_in_closed_form(omega):
    """Half a period turns the state into its opposite: z = −(e^{Ah} z + (e^{Ah} − 1) A⁻¹ b)."""
    damping, half = 0.2, np.pi / omega
    matrix = np.array([[0.0, 1.0], [-1.0, -damping]])
    values, vectors = np.linalg.eig(matrix)
    flow = (vectors * np.exp(values * half) @ np.linalg.inv(vectors)).real
    forced = np.linalg.solve(matrix, (flow - np.eye(2)) @ [0.0, 1.0])
    state = -np.linalg.solve(np.eye(2) + flow, forced)
    cycle = square_wave().limit_cycle(omega=omega)
    assert outcome(cycle) == "converged"
    assert cycle.sizes["event"] == 2
    rises = int(np.argmax(cycle.event_regime.values == 0))
    ours = [float(cycle[f"event_{name}"][rises]) for name in ("x", "v")]
    np.testing.assert_allclose(ours, state, atol=1e-10)
    assert int(cycle.stable) == 1


def flight_time(strength, adhesion):
    """How long an inelastic ball flies after strength · sin t = 1 + adhesion."""
    leave = np.arcsin((1.0 + adhesion) / strength)

    def height(time):
        moved = strength * (np.sin(leave) - np.sin(leave + time) + time * np.cos(leave))
        return moved - 0.5 * time**2

    return brentq(height, 0.3, 6.0)


def times_of(cycle):
    names = np.array(cycle.event_kind.attrs["flag_meanings"].split())
    return dict(zip(names[cycle.event_kind], cycle.event_time.values, strict=True))


@pytest.mark.parametrize("strength", [1.05, 1.2, 1.5, 1.8, 2.0, 2.5, 3.0])
def test_a_ball_on_a_table_flies_for_its_closed_form_time(strength):
    cycle = ball_on_a_table.limit_cycle(strength=strength, adhesion=1e-3)
    assert outcome(cycle) == "converged"
    times = times_of(cycle)
    flight = (times["land"] - times["leave"]) % (2.0 * np.pi)
    assert flight == pytest.approx(flight_time(strength, 1e-3), abs=1e-9)


@pytest.mark.parametrize("strength", [1.02, 1.1, 1.3, 1.5, 1.7])
def test_a_block_on_a_table_slides_for_its_closed_form_time(strength):
    cycle = block_on_a_table.limit_cycle(strength=strength)
    assert outcome(cycle) == "converged"
    assert int(cycle.stable) == 1
    times, begin = times_of(cycle), np.arcsin(1.0 / strength)

    def speed(time):
        return strength * (np.cos(begin) - np.cos(begin + time)) - time

    slides = brentq(speed, 0.1, 6.0)
    assert times["moves_on"] == pytest.approx(begin, abs=1e-9)
    assert times["moves_back"] == pytest.approx(begin + np.pi, abs=1e-9)
    for first, last in (("moves_on", "stops"), ("moves_back", "stops_back")):
        assert (times[last] - times[first]) % (2.0 * np.pi) == pytest.approx(
            slides, abs=1e-9
        )


def symmetric_cycle(force):
    """(state, multipliers) of the symmetric cycle of x″ + 0.1 x′ + x³ = F cos t, by DOP853."""

    def rates(t, z):
        x, v = z[:2]
        slopes = np.array([[0.0, 1.0], [-3.0 * x**2, -0.1]]) @ z[2:].reshape(2, 2)
        return v, force * np.cos(t) - 0.1 * v - x**3, *slopes.ravel()

    def after(z, time):
        start = [*z, 1.0, 0.0, 0.0, 1.0]
        return solve_ivp(rates, (0.0, time), start, "DOP853", rtol=1e-12, atol=1e-12).y[
            :, -1
        ]

    state = fsolve(lambda z: after(z, np.pi)[:2] + z, [0.6, 1.3], xtol=1e-12)
    return state, np.linalg.eigvals(after(state, 2.0 * np.pi)[2:].reshape(2, 2))


@pytest.mark.parametrize(
    ("bend", "label"), [(0.0, Label.pitchfork), (1.0, Label.transcritical)]
)
def test_branches_that_cross_do_so_by_a_symmetry_or_without(bend, label):
    """x = sin t loses stability at a = 0 to sin t + d, with a = bend d + d²."""
    system = System(
        "crossing branches",
        states={"x": "1"},
        parameters={"a": -0.5, "bend": 0.0},
        regimes={"one": {}},
        field=lambda t, s, p, r: {
            "x": cos(t)
            + p.a * (s.x - sin(t))
            - p.bend * (s.x - sin(t)) ** 2
            - (s.x - sin(t)) ** 3
        },
        start={"x": 0.0},
        period=lambda p: 2.0 * np.pi,
    )
    start = system.limit_cycle(bend=bend)
    branch = system.cycle_branch("a", to=0.3, start=start)
    (at,) = np.flatnonzero(
        np.isin(branch.label, (Label.pitchfork, Label.transcritical))
    )
    assert branch.label[at] == label
    assert float(branch.a[at]) == pytest.approx(0.0, abs=1e-9)
    grown = np.exp(2.0 * np.pi * branch.a.values)
    np.testing.assert_allclose(branch.multiplier_real[:, 0], grown, rtol=1e-9)


def test_a_symmetric_cycle_loses_stability_at_a_pitchfork():
    start = ueda.limit_cycle(force=1.0)
    branch = ueda.cycle_branch("force", 4.0, start=start)
    (at,) = np.flatnonzero(branch.label == Label.pitchfork)
    changes = np.flatnonzero(np.diff(branch.stable.values)) + 1
    assert set(changes) <= {at, at + 1}, "no change of stability without a label"
    force = float(branch.force[at])
    assert force == pytest.approx(2.3, abs=0.05)
    state, multipliers = symmetric_cycle(force)
    assert np.abs(multipliers - 1.0).min() < 1e-7
    ours = [float(branch[f"{name}_start"][at]) for name in ("x", "v")]
    # of a triple root: the equations tell it to the cube root of their round-off
    np.testing.assert_allclose(ours, state, atol=1e-5)


@pytest.mark.parametrize(
    ("mu", "period"),
    [
        (1.0, 6.663286859323),
        (10.0, 19.078369566),
        (100.0, 162.837071092),
        pytest.param(1000.0, 1614.401125808, marks=pytest.mark.release),
    ],
)
def test_relaxation_oscillations_settle(mu, period):
    """Periods between two zeros of v, by DOP853 and, the last one, Radau."""
    cycle = van_der_pol.limit_cycle(mu=mu)
    assert outcome(cycle) == "converged"
    assert float(cycle.period) == pytest.approx(period, rel=1e-9)
    assert float(cycle.x_max) == pytest.approx(2.0, abs=0.02)


@pytest.mark.release
def test_the_step_limit_is_an_argument():
    """mu = 300 with t_settle = 2430 ended as step_limit with nothing to raise."""
    assert outcome(van_der_pol.limit_cycle(mu=300.0, t_settle=2430.0)) == "converged"
    few = van_der_pol.limit_cycle(mu=100.0, max_steps=2000)
    assert outcome(few) == "step_limit"
    assert "raise max_steps" in few.outcome.comment


def test_the_step_limit_has_one_default():
    """A run took 10⁷ steps by default, one on the way to a cycle 10⁶."""
    calls = System.simulate, System.ensemble, System.basin, system_cycle
    defaults = {signature(call).parameters["max_steps"].default for call in calls}
    assert defaults == {10**7}


def test_a_guess_on_the_slow_manifold_is_near_the_cycle():
    x, mu = 1.8, 100.0
    cycle = van_der_pol.limit_cycle(mu=mu, guess={"x": x, "v": x / (mu * (1 - x**2))})
    assert outcome(cycle) == "converged"
    assert float(cycle.period) == pytest.approx(162.837071092, rel=1e-9)


def test_a_cycle_far_longer_than_the_time_scale_is_met():
    slow = System(
        "van der Pol in fiftieths",
        states={"x": "1", "v": "1"},
        parameters={"mu": 20.0},
        regimes={"all": {}},
        field=lambda t, s, p, r: {"x": s.v, "v": p.mu * (1.0 - s.x**2) * s.v - s.x},
        start={"x": 2.0, "v": 0.0},
        time_scale=0.02,
    )
    cycle = slow.limit_cycle()
    assert outcome(cycle) == "converged"
    period = float(van_der_pol.limit_cycle(mu=20.0).period)
    assert float(cycle.period) == pytest.approx(period, rel=1e-9)


def test_multipliers_that_round_off_has_taken_are_not_told():
    """A cycle maps its own direction onto itself; a derivative that does not is none."""
    values = {"mu": 1.0}
    cycle, how = find_cycle(van_der_pol, values, np.array([2.0, 0.0]), guess=False)
    assert how == Outcome.converged
    assert cycle.keeps_its_direction
    lost = Cycle.at(cycle.map, cycle.point)
    lost.__dict__["monodromy"] = 1e29 * np.ones((2, 2))
    assert labelled(lost, how) == (lost, Outcome.unresolved)
    assert np.isnan(lost.multipliers).all()
    assert not lost.is_stable


SLOPES = {"in": -8.0 / 7.0, "up": -5.0 / 7.0, "down": -5.0 / 7.0}
chua = System(
    "Chua's circuit",
    states={"x": "1", "y": "1", "z": "1"},
    parameters={"al": 8.0, "be": 100.0 / 7.0},
    regimes={
        name: {"slope": slope, "offset": (SLOPES["in"] - slope) * side}
        for (name, slope), side in zip(SLOPES.items(), (0.0, 1.0, -1.0), strict=True)
    },
    field=lambda t, s, p, r: {
        "x": p.al * (s.y - s.x - r.slope * s.x - r.offset),
        "y": s.x - s.y + s.z,
        "z": -p.be * s.y,
    },
    switches=[
        Switch("rises", "in", lambda t, s, p, r: 1.0 - s.x, "up"),
        Switch("falls", "in", lambda t, s, p, r: s.x + 1.0, "down"),
        Switch("back", "up", lambda t, s, p, r: s.x - 1.0, "in"),
        Switch("back_up", "down", lambda t, s, p, r: -1.0 - s.x, "in"),
    ],
    start={"x": 0.1, "y": 0.0, "z": 0.0},
)


def test_a_vertical_branch_ends_as_a_family():
    """At one value an outer region has a centre: its cycles up to the one that touches x = 1."""

    def real_part(al):
        outer = [
            [-al * (1.0 + SLOPES["up"]), al, 0.0],
            [1, -1, 1],
            [0, -100.0 / 7.0, 0],
        ]
        values = np.linalg.eigvals(outer)
        return values[np.abs(values.imag) > 0.1].real.max()

    centre = brentq(real_part, 6.0, 7.5, xtol=1e-14)
    start = chua.limit_cycle(t_settle=500.0)
    branch = chua.cycle_branch("al", 6.0, start=start)
    assert meanings(branch.end)[int(branch.end)] == "family_member"
    special = branch.label.values[branch.label.values > 0]
    assert special.tolist() == [Label.family_member]
    assert int(branch.label[-1]) == Label.family_member
    assert int(branch.stable[-1]) == 0
    assert float(branch.al[-1]) == pytest.approx(centre, rel=1e-11)
    assert centre == pytest.approx(6.7976604986, rel=1e-10)


@pytest.mark.parametrize(
    "place",
    [{"x": 0.1}, pytest.param({"x": 0.3, "y": -0.1}, marks=pytest.mark.release)],
    ids=["near rest", "farther"],
)
def test_chaos_is_told_without_newtons_method_on_its_near_returns(place, monkeypatch):
    """2,000 s of settling took 70 s: returns of hundreds of events that are met only once."""
    sizes = []
    kept = EventMap.solve

    def solve(self, *options):
        sizes.append(self.legs)
        return kept(self, *options)

    monkeypatch.setattr(EventMap, "solve", solve)
    assert (
        outcome(chua.limit_cycle(al=8.5, start=place, t_settle=2000.0)) == "unsettled"
    )
    assert sum(size for size in sizes if size > 100) <= 300


@pytest.mark.release
def test_a_homoclinic_end_has_a_name():
    """x″ = x − x² + μ x′ + x x′ (Kuznetsov, Elements of Applied Bifurcation Theory, ch. 6)."""
    system = oscillator(
        "homoclinic",
        lambda t, x, v, p: x - x**2 + p.mu * v + x * v,
        start={"x": 1.2, "v": 0.0},
        mu=-0.9,
    )
    branch = system.cycle_branch("mu", -0.8, start=system.limit_cycle(t_settle=300.0))
    assert meanings(branch.end)[int(branch.end)] == "period_unbounded"
    assert (branch.label.values[:-1] == Label.regular).all()
    # shooting along the saddle's manifolds, which meet at the value
    assert float(branch.mu[-1]) == pytest.approx(homoclinic_value(), abs=1e-8)


def homoclinic_value():
    """Where the unstable and the stable manifold of x = 0 cross v = 0 at one x."""

    def crossing(mu, sign):
        rate = 0.5 * (mu + sign * np.sqrt(mu**2 + 4.0))
        stops = lambda t, z: z[1]  # noqa: E731
        stops.terminal, stops.direction = True, -sign
        run = solve_ivp(
            lambda t, z: (z[1], z[0] - z[0] ** 2 + mu * z[1] + z[0] * z[1]),
            (0.0, sign * 100.0),
            [1e-6, 1e-6 * rate],
            "DOP853",
            events=stops,
            rtol=1e-12,
            atol=1e-14,
        )
        return run.y_events[0][0][0]

    return brentq(
        lambda mu: crossing(mu, 1.0) - crossing(mu, -1.0), -0.9, -0.8, xtol=1e-12
    )
