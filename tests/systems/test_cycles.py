"""Cycles, branches and derivatives of systems against closed forms and differences."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.linalg

from squealpipe import Switch, System, labels
from squealpipe.functions import cos
from squealpipe.schema import Outcome, meanings
from squealpipe.systems.branch_labels import Label
from squealpipe.systems.cycles import following
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.shipped.belt_friction import (
    exponential_oscillator,
    leine_oscillator,
)
from squealpipe.systems.shipped.dry_friction import dry_friction_oscillator
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
from squealpipe.systems.shipped.relief_valve import relief_valve
from tests.samples import some
from tests.systems.smooth_systems import duffing_holmes
from tests.systems.test_random_systems import random_system

V_STAR = 1.83660097221
"""Belt speed at which both cycles of the exponential oscillator vanish (independent, 12 digits)."""


def special(branch, label):
    points = np.flatnonzero(branch.label.values == label)
    return branch[branch.attrs["parameter"]].values[points]


def test_stick_slip_cycles_have_their_known_periods():
    cycle = leine_oscillator.limit_cycle()
    assert float(cycle.period) == pytest.approx(12.001031295, abs=5e-10)
    kinds = np.array(cycle.event_kind.attrs["flag_meanings"].split())[cycle.event_kind]
    assert set(kinds) == {"slip", "stick"}
    slip, stick = (
        float(cycle.event_time[list(kinds).index(k)]) for k in ("slip", "stick")
    )
    assert (stick - slip) % float(cycle.period) == pytest.approx(4.295999525, abs=5e-10)
    for speed, period in ((1.25, 6.353748505), (0.5, 6.929871535)):
        cycle = exponential_oscillator.limit_cycle(belt_speed=speed)
        assert float(cycle.period) == pytest.approx(period, abs=5e-10)
        assert abs(float(cycle.multiplier_real[0]) - 1.0) < 1e-9
        assert abs(float(cycle.multiplier_real[1])) < 1e-12, (
            "stick forgets one direction"
        )


@pytest.mark.parametrize(
    ("speed", "amplitude"), [(1.25, 0.664228586), (1.55, 1.436881604)]
)
def test_the_unstable_cycle_has_its_known_amplitude(speed, amplitude):
    centre = 0.5 + 0.5 * np.exp(-2.0 * speed)
    guess = {"x": centre + amplitude - 1e-4, "v": 0.0}
    cycle = exponential_oscillator.limit_cycle(belt_speed=speed, guess=guess)
    assert float(cycle.x_max) - centre == pytest.approx(amplitude, abs=5e-10)
    assert int(cycle.stable) == 0
    assert cycle.sizes["event"] == 0


def test_both_cycles_of_the_exponential_oscillator_vanish_where_they_meet():
    """Stuck to the corner, round it, and down to the Hopf point, where exp(−2V) = 0.1."""
    stable = exponential_oscillator.limit_cycle(belt_speed=1.25)
    branch = exponential_oscillator.cycle_branch("belt_speed", 1.9, start=stable)
    (corner,) = special(branch, Label.stick_onset)
    assert corner == pytest.approx(V_STAR, abs=2e-11)
    assert branch.end == Outcome.equilibrium
    assert float(branch.belt_speed[-1]) == pytest.approx(-0.5 * np.log(0.1), abs=1e-11)
    at = int(np.argmax(branch.label.values == Label.stick_onset))
    assert branch.stable[:at].all()
    large = (branch.x_max - branch.x_min).values > 0.01
    assert not branch.stable.values[at + 1 :][large[at + 1 :]].any()
    guess = {"x": 0.5 + 0.5 * np.exp(-2.5) + 0.664, "v": 0.0}
    unstable = exponential_oscillator.limit_cycle(belt_speed=1.25, guess=guess)
    other = exponential_oscillator.cycle_branch(
        "belt_speed", 1.9, start=unstable, n_points=30
    )
    (corner,) = special(other, Label.stick_onset)
    assert corner == pytest.approx(V_STAR, abs=2e-11)
    assert other.events[-1] == 2


def test_branch_of_the_impact_oscillator_has_its_closed_form_points():
    start = impact_oscillator.limit_cycle(omega=1.9, amplitude=2.2)
    branch = impact_oscillator.cycle_branch("amplitude", 4.0, start=start)
    assert special(branch, Label.grazing) == pytest.approx(
        np.sqrt((1.0 - 1.9**2) ** 2 + 0.01 * 1.9**2), abs=1e-12
    )
    assert special(branch, Label.fold) == pytest.approx(2.073204825805628, abs=1e-12)
    np.testing.assert_array_equal(branch.events[[0, -1]], [0, 1])
    touches = branch.label == Label.grazing
    np.testing.assert_array_equal(
        branch.multiplier_real.isnull().all("multiplier"), touches
    )
    np.testing.assert_array_equal(
        branch.stable[touches], branch.stable.shift(point=1)[touches]
    )
    assert float(branch.amplitude[-1]) == 4.0
    assert branch.end == Outcome.converged
    middle = (branch.events == 1) & (branch.label == Label.regular)
    assert set(branch.stable.values[middle]) == {0, 1}


def test_flip_of_the_impact_oscillator():
    start = impact_oscillator.limit_cycle(
        omega=2.1, amplitude=4.5, guess={"x": -1.5, "v": 0.5}
    )
    assert start.sizes["event"] == 1
    branch = impact_oscillator.cycle_branch("amplitude", 2.5, start=start)
    flips = special(branch, Label.period_doubling)
    assert np.abs(flips - 3.506188447846005).min() < 1e-12


def test_motion_without_stick_ends_where_closed_forms_say():
    start = dry_friction_oscillator.limit_cycle(omega=0.9)
    for to, expected in ((0.5, 0.722679194438), (1.5, 1.235747152322)):
        branch = dry_friction_oscillator.cycle_branch("omega", to, start=start)
        assert special(branch, Label.stick_onset)[0] == pytest.approx(
            expected, abs=1e-12
        )


def test_the_cycle_of_the_relief_valve_shrinks_to_rest_at_its_hopf_point():
    start = relief_valve.limit_cycle(q=8.0)
    branch = relief_valve.cycle_branch("q", 9.0, start=start)
    assert branch.end == Outcome.equilibrium
    assert float(branch.q[-1]) == pytest.approx(8.491117635183, abs=1e-11)


@pytest.fixture(scope="module")
def ring():
    """Circles of radius 1 + e at level = scale (e³ − depth² e): folds at e = ∓depth/√3."""

    def field(t, s, p, r):
        radius = (s.x**2 + s.v**2) ** 0.5
        e = radius - 1.0
        growth = p.level - p.scale * (e**3 - p.depth**2 * e)
        return {"x": s.v + growth * s.x, "v": -s.x + growth * s.v}

    return System(
        "ring",
        states={"x": "1", "v": "1"},
        parameters={"level": 0.02, "scale": 0.1, "depth": 0.1},
        regimes={"all": {}},
        field=field,
        start={"x": 1.5, "v": 0.0},
    )


@pytest.mark.parametrize(
    "depth", [0.005, *(pytest.param(d, marks=pytest.mark.release) for d in (0.02, 0.1))]
)
def test_two_folds_within_one_step_are_not_passed(ring, depth):
    """Between them multipliers and tangents change by less than anything else is watched for."""
    at = {"level": 0.02, "depth": depth}
    start = ring.limit_cycle(guess={"x": 1.585, "v": 0.0}, **at)
    branch = ring.cycle_branch("level", -0.02, start=start)
    fold = 0.1 * 2.0 / 27.0**0.5 * depth**3
    assert special(branch, Label.fold) == pytest.approx([-fold, fold], abs=1e-13)


def test_the_search_for_rest_leaves_where_a_field_has_no_slope(ring):
    """Newton's method goes to the centre, where the radius has none."""
    cycle = ring.limit_cycle(guess={"x": 1.55, "v": 0.0}, depth=0.1)
    assert cycle.outcome == Outcome.converged
    assert float(cycle.period) == pytest.approx(2.0 * np.pi, rel=1e-12)


def test_a_system_without_switches_has_branches_with_tori():
    """A forced van der Pol oscillator loses its lock: a complex pair is on the unit circle."""
    van_der_pol = System(
        "van der Pol",
        states={"x": "1", "v": "1"},
        parameters={"force": 3.0},
        regimes={"one": {}},
        field=lambda t, s, p, r: {
            "x": s.v,
            "v": 0.3 * (1.0 - s.x * s.x) * s.v - s.x + p.force * cos(1.6 * t),
        },
        start={"x": 1.0, "v": 0.0},
        period=lambda p: 2.0 * np.pi / 1.6,
    )
    branch = van_der_pol.cycle_branch("force", 0.2, start=van_der_pol.limit_cycle())
    (force,) = special(branch, Label.torus)
    (at,) = np.flatnonzero(branch.label == Label.torus)
    guess = {name: float(branch[f"{name}_start"][at]) for name in ("x", "v")}
    cycle = van_der_pol.limit_cycle(guess=guess, force=force)
    size = np.hypot(cycle.multiplier_real, cycle.multiplier_imag)
    np.testing.assert_allclose(size, 1.0, atol=1e-10)
    assert (cycle.multiplier_imag != 0.0).all()


def test_real_multipliers_that_are_inverse_are_no_torus():
    """A saddle of Duffing's oscillator, whose multipliers have the product exp(−d T)."""
    omega = 3.0
    start = duffing_holmes.limit_cycle(
        guess={"x": 0.0, "v": 0.0}, omega=omega, damping=0.1
    )
    branch = duffing_holmes.cycle_branch("damping", to=-0.1, start=start)
    assert branch.end == Outcome.converged
    assert (branch.multiplier_imag == 0.0).all()
    product = branch.multiplier_real.prod("multiplier")
    expected = np.exp(-branch.damping * 2.0 * np.pi / omega)
    np.testing.assert_allclose(product, expected, rtol=1e-12)
    assert branch.damping[0] > 0.0 > branch.damping[-1]  # at 0 they are inverse
    assert set(branch.label.values[:-1]) == {Label.regular}


def test_a_settled_motion_of_more_periods_says_how_many():
    """Below the flip of its cycle at 3.50619, before the chaos at 3.48."""
    given = {"omega": 2.1, "start": {"x": 0.5}}
    for amplitude, number in ((3.5, 2), (3.49, 16)):
        cycle = impact_oscillator.limit_cycle(amplitude=amplitude, **given)
        assert np.isnan(cycle.period)
        assert int(cycle.periods) == number
        said = meanings(cycle.outcome)[int(cycle.outcome)]
        assert said == f"settled_on_{number}_periods"
        longer = impact_oscillator.limit_cycle(
            amplitude=amplitude, periods=number, **given
        )
        assert longer.outcome == Outcome.converged
        expected = number * 2.0 * np.pi / 2.1
        assert float(longer.period) == pytest.approx(expected, rel=1e-12)
    chaos = impact_oscillator.limit_cycle(amplitude=3.48, **given)
    assert meanings(chaos.outcome)[int(chaos.outcome)] == "unsettled"


@pytest.mark.parametrize("amplitude", [3.5065, 3.508])
def test_a_motion_that_settles_to_and_fro_is_one_of_the_shorter_period(amplitude):
    """Next to its flip at 3.50619 a multiplier of the one-impact cycle is just above −1."""
    cycle = impact_oscillator.limit_cycle(
        omega=2.1, amplitude=amplitude, start={"x": 0.0}
    )
    assert cycle.outcome == Outcome.converged
    assert float(cycle.period) == pytest.approx(2.0 * np.pi / 2.1, rel=1e-12)
    assert -1.0 < cycle.multiplier_real.min() < -0.85


def test_samples_of_a_cycle_resolve_its_impacts():
    """Straight lines between samples of a stiff stop's cycle leave out no turn of the motion."""
    stop = System(
        "stiff stop",
        states={"x": "m", "v": "m/s"},
        parameters={"stiffness": 1e8, "omega": 1.9},
        regimes={"free": {"touch": 0.0}, "contact": {"touch": 1.0}},
        field=lambda t, s, p, r: {
            "x": s.v,
            "v": cos(p.omega * t)
            - s.x
            - 0.1 * s.v
            - r.touch * p.stiffness * (s.x - 0.2),
        },
        switches=[
            Switch(
                "hit", leaves="free", when=lambda t, s, p, r: 0.2 - s.x, to="contact"
            ),
            Switch(
                "left", leaves="contact", when=lambda t, s, p, r: s.x - 0.2, to="free"
            ),
        ],
        start={"x": 0.0, "v": 0.0},
        period=lambda p: 2.0 * np.pi / p.omega,
    )
    cycle = next(
        c
        for n in (1, 2, 3, 4, 5)
        if np.isfinite((c := stop.limit_cycle(periods=n)).period)
    )
    assert cycle.sizes["event"] >= 2
    deepest = float(cycle.x_path.max()) - 0.2
    assert deepest == pytest.approx(float(cycle.x_max) - 0.2, rel=0.05)


def stroboscopic_map(system, values, period):
    """(state → state a period later, its events) by plain runs."""

    def after(state, regime):
        start = {**dict(zip(system.states, state, strict=True)), "regime": regime}
        times = np.array([0.0, period])
        run = system.simulate(period, start=start, times=times, tol=1e-15, **values)
        end = np.array([float(run[name][-1]) for name in system.states])
        return end, tuple(run.event_kind.values)

    return after


def compare_with_differences(seed):
    """Multipliers of one random system at some parameters; how many cycles there were."""
    system, rng, checked = random_system(seed), np.random.default_rng(seed), 0
    for _ in range(4):
        values = {
            "drive": float(rng.uniform(0.2, 1.5)),
            "omega": float(rng.uniform(0.5, 3.0)),
        }
        cycle = system.limit_cycle(**values)
        if cycle.outcome != Outcome.converged:
            continue
        state = np.array([float(cycle[f"{name}_start"]) for name in system.states])
        regime = cycle.start_regime.attrs["flag_meanings"].split()[
            int(cycle.start_regime)
        ]
        after = stroboscopic_map(system, values, float(cycle.period))
        back, kinds = after(state, regime)
        np.testing.assert_allclose(back, state, atol=1e-9)
        assert len(kinds) == cycle.sizes["event"]
        matrix = np.empty((len(state), len(state)))
        units = 1e-4 * np.eye(len(state))
        if regime == "held":  # s1 is kept: what differs in it is no motion
            units[1] = 0.0
        for j, unit in enumerate(units):
            ends = [after(state + k * unit, regime) for k in (2.0, 1.0, -1.0, -2.0)]
            if any(end[1] != kinds for end in ends):
                break
            far, near, other, last = (end[0] for end in ends)
            matrix[:, j] = (8.0 * (near - other) - (far - last)) / 12e-4
        else:
            expected = np.poly(np.linalg.eigvals(matrix))
            ours = np.poly(
                cycle.multiplier_real.values + 1j * cycle.multiplier_imag.values
            )
            np.testing.assert_allclose(
                ours, expected, atol=1e-6 * max(1.0, np.abs(expected).max())
            )
            checked += 1
    return checked


RELEASED = [pytest.param([n], 0, marks=pytest.mark.release) for n in some(range(6, 30))]


@pytest.mark.release
@pytest.mark.parametrize(("seeds", "least"), [(range(6), 6), *RELEASED])
def test_multipliers_of_random_systems_are_those_of_differences(seeds, least):
    assert sum(compare_with_differences(seed) for seed in seeds) >= least


def test_a_motion_that_sticks_for_ever_has_a_branch():
    """No event puts it on the held surface: the equations do, and what leaves it is forgotten."""
    system = random_system(11)
    cycle = system.limit_cycle(drive=0.367, omega=1.49)
    assert cycle.sizes["event"] == 0
    assert 0.0 in cycle.multiplier_real
    branch = system.cycle_branch("drive", 0.4, start=cycle)
    assert branch.end == Outcome.converged


def test_a_touch_after_which_the_motion_jumps_ends_a_branch():
    """A stop whose reset is a jump even at no speed."""
    system = random_system(30)
    cycle = system.limit_cycle(drive=0.5065384462562926, omega=1.572767496664528)
    branch = system.cycle_branch("drive", 0.8104615140100683, start=cycle)
    assert branch.end == Outcome.tangency


@pytest.mark.release
@pytest.mark.parametrize("seed", [*range(14), pytest.param(14, marks=pytest.mark.long)])
def test_no_label_of_a_random_branch_is_lost_between_dense_samples(seed, monkeypatch):
    """Labels are those of steps a tenth as long, and each change between those has one."""
    system, rng = random_system(seed), np.random.default_rng(seed)
    values = {
        "drive": float(rng.uniform(0.2, 1.5)),
        "omega": float(rng.uniform(0.5, 3.0)),
    }
    start = system.limit_cycle(**values)
    if start.outcome != Outcome.converged:
        pytest.skip("no cycle of one period")
    to = 1.2 * values["drive"]
    coarse = system.cycle_branch("drive", to, start=start)
    monkeypatch.setattr(
        following, "branch_steps", replace(following.branch_steps, longest_step=0.005)
    )
    dense = system.cycle_branch("drive", to, start=start, n_points=2000)
    for label in (
        Label.fold,
        Label.period_doubling,
        Label.torus,
        Label.grazing,
        Label.stick_onset,
    ):
        np.testing.assert_allclose(
            special(coarse, label), special(dense, label), atol=1e-10
        )
    multipliers = dense.multiplier_real.values + 1j * dense.multiplier_imag.values
    flips, labels = np.prod(multipliers + 1.0, axis=1).real, dense.label.values
    alike = (np.diff(dense.events) == 0) & (labels[:-1] == 0) & (labels[1:] == 0)
    assert (flips[:-1] * flips[1:] > 0.0)[alike].all()
    turns = np.diff(dense.drive[:-1])  # the last point is where it ends
    inner = (labels[:-3] == 0) & (labels[1:-2] == 0) & (labels[2:-1] == 0)
    assert (turns[:-1] * turns[1:] > 0.0)[inner].all()


@pytest.mark.parametrize(
    ("system", "times", "given", "names"),
    [
        (
            leine_oscillator,
            (0.0, 17.0, 30.0),
            {"belt_speed": 0.25},
            ("belt_speed", "x0"),
        ),
        (
            impact_oscillator,
            (0.0, 15.0),
            {"amplitude": 0.6, "omega": 1.2},
            ("amplitude", "omega", "x0", "v0"),
        ),
    ],
    ids=["stick", "impacts"],
)
def test_derivatives_through_events_are_those_of_differences(
    system, times, given, names
):
    """By the belt's speed, to which the reset sets the velocity, by others, and by starts."""
    options = {"times": np.array(times)}
    run = system.simulate(times[-1], sensitivity=names, **options, **given)
    assert run.sizes["event"] > 1
    for name in names:
        ends = []
        for step in (1e-6, -1e-6):
            values, start = dict(given), dict(system.start)
            (start if name[:-1] in start else values)[name.removesuffix("0")] += step
            end = system.simulate(
                times[-1], start=start, tol=1e-15, **options, **values
            )
            ends.append(np.concatenate([end.event_time, end.x[1:], end.v[1:]]))
        slopes = (ends[0] - ends[1]) / 2e-6
        ours = [
            run[f"event_time_by_{name}"],
            *(run[f"{z}_by_{name}"][1:] for z in ("x", "v")),
        ]
        np.testing.assert_allclose(
            np.concatenate(ours), slopes, atol=2e-7 * np.abs(slopes).max()
        )


@pytest.mark.release
def test_a_cycle_passes_through_a_regime_that_it_is_entered_beyond():
    """Regime b is left at once: y decays at one rate up to x = 1, at another up to x = 2."""

    def relay(kick):
        return System(
            "relay",
            states={"x": "1", "y": "1"},
            parameters={"place": 1.0, "kick": kick},
            regimes={"a": {"rate": 0.3}, "b": {"rate": 50.0}, "c": {"rate": 0.8}},
            field=lambda t, s, p, r: {"x": 1.0, "y": -r.rate * s.y},
            switches=[
                Switch("ab", "a", lambda t, s, p, r: p.place + 0.1 * s.y - s.x, "b"),
                Switch("bc", "b", lambda t, s, p, r: 0.2 - s.y, "c"),
                Switch(
                    "ca",
                    "c",
                    lambda t, s, p, r: 2.0 - s.x,
                    "a",
                    reset=lambda t, s, p, r: {"x": 0.0, "y": s.y + p.kick},
                ),
            ],
            start={"x": 0.0, "y": 1.0, "regime": "a"},
        )

    cycle = relay(1.0).limit_cycle()
    assert cycle.outcome == Outcome.converged
    assert list(labels(cycle.event_kind).values).count("bc") == 1

    def after(y):
        """A round, with the instant of x = 1 + y/10 by fixed-point iteration."""
        time = 1.0
        for _ in range(100):
            time = 1.0 + 0.1 * y * np.exp(-0.3 * time)
        return y * np.exp(-0.3 * time - 0.8 * (2.0 - time)) + 1.0

    y = 1.0
    for _ in range(200):
        y = after(y)
    assert float(cycle.y_max) == pytest.approx(y, rel=1e-12)
    assert float(cycle.period) == pytest.approx(2.0, rel=1e-13)
    slope = (after(y + 1e-5) - after(y - 1e-5)) / 2e-5
    multipliers = np.sort(cycle.multiplier_real.values)
    np.testing.assert_allclose(multipliers, [slope, 1.0], rtol=1e-8)
    branch = relay(1.0).cycle_branch("kick", 2.0, start=cycle, n_points=20)
    for kick, highest in zip(branch.kick.values, branch.y_max.values, strict=True):
        # the highest y is that after the reset: y = g(y) + kick
        level = highest
        assert after(level) - 1.0 + kick == pytest.approx(level, rel=1e-9)


def test_multipliers_come_by_falling_magnitude_the_upper_of_a_pair_first():
    turned = 0.5 * np.array([[0.6, -0.8], [0.8, 0.6]])
    matrix = scipy.linalg.block_diag(0.1, turned, -0.9)
    forced = SimpleNamespace(
        monodromy=matrix, keeps_its_direction=True, map=SimpleNamespace(periods=1)
    )
    expected = [-0.9, 0.3 + 0.4j, 0.3 - 0.4j, 0.1]
    np.testing.assert_allclose(Cycle.multipliers.func(forced), expected, atol=1e-15)
