"""The answer for a real pad, against scipy's DOP853 written from the definition alone."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealpipe import Parameters, Sweep, assess, load, run_sweep, save, stability_map
from squealpipe.brake.assess import windows
from squealpipe.brake.assess.assess import judge
from squealpipe.brake.assess.cures import growth_margin
from squealpipe.brake.assess.designs import cures_of
from squealpipe.brake.assess.levels import levels
from squealpipe.brake.assess.settling import pushed, settle, start_at, strikes
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.assess.windows import run_windows
from squealpipe.brake.schema.assess import CURES
from squealpipe.cli import run
from squealpipe.codes import Verdict
from squealpipe.study.report.answer import first_lines
from squealpipe.substitutes import critical_damping
from squealpipe.vibration.boundaries import linear_intervals
from squealpipe.vibration.levels import error_of_mean
from squealpipe.vibration.schema import Mechanism
from squealpipe.vibration.settled_runs import Horizon
from squealpipe.vibration.settled_runs import settle as settle_runs
from squealpipe.vibration.settling import settling_of_numbers, settling_of_verdicts
from tests.oracles.pad import Pad, strongest_line
from tests.oracles.written import written

NUMBERS = {
    "mass": 0.45,
    "k1": 1e7,
    "k2": 1e7,
    "k3": 7e6,
    "preload": 5.714e-4,
    "mu": 0.37,
    "mu_static": 0.55,
    "friction_speed": 1.7,
    "friction_law": "exponential",
    "belt_speed": 2.0,
    "length1": 0.1,
    "length2": 0.1,
    "damping1": 42.4,
    "damping2": 42.4,
}
PAD = Parameters(**NUMBERS)
HAMMER, SQUEAL = np.radians((22.0, 46.0)), np.radians((30.0, 60.0))


@pytest.fixture(scope="module")
def hammering():
    """A pad that hammers, without what stops it."""
    return judge(PAD, *HAMMER, tol=1e-12).without_cures()


HAMMERING = {
    "frequency": 828.7967842776267,
    "separated": 0.3946634548033516,
    "stuck": 0.016780581424661184,
    "rms": [1.2702916336311825, 2.4100625826417508],
    "peak_force": 7384.643058444144,
    "losses": 166,
}
"""The same by the integrator apart, which takes 2 s: Hz, m/s, N."""


@pytest.mark.release
def test_the_numbers_of_the_integrator_apart_are_those_written_here():
    truth = Pad(NUMBERS, *HAMMER).run((0, 0, 0, 0), 0.4, 0.2)
    assert strongest_line(truth.velocity[1], truth.step) == pytest.approx(
        HAMMERING["frequency"], abs=0.01
    )
    found = {name: getattr(truth, name) for name in ("separated", "stuck", "losses")}
    found |= {"rms": truth.velocity.std(axis=1), "peak_force": truth.peak_force}
    for name, number in found.items():
        assert number == pytest.approx(HAMMERING[name], rel=1e-4), name


@pytest.fixture(scope="module")
def squealing():
    return assess(PAD, *SQUEAL)


def test_a_pad_that_hammers(hammering):
    truth = SimpleNamespace(**HAMMERING)
    assert int(hammering.verdict) == int(hammering.sudden_verdict) == Verdict.hammers
    assert int(hammering.mechanism) == Mechanism.flutter
    linear = stability_map(PAD, *([angle] for angle in HAMMER))
    assert hammering.mode_frequency.values * 2.0 * np.pi == pytest.approx(
        linear.frequency.values[0, 0], rel=1e-14
    )
    assert float(hammering.frequency) == pytest.approx(truth.frequency, abs=1.0)
    assert float(hammering.frequency) == pytest.approx(830.0, abs=2.0)
    assert float(hammering.separated_fraction) == pytest.approx(
        truth.separated, abs=3e-3
    )
    assert float(hammering.stick_fraction) == pytest.approx(truth.stuck, abs=1e-3)
    rms = [float(hammering[f"velocity_rms_{way}"]) for way in ("along", "across")]
    assert rms == pytest.approx(truth.rms, rel=5e-3)
    assert float(hammering.peak_contact_force) == pytest.approx(
        truth.peak_force, rel=5e-3
    )
    assert float(hammering.impact_rate) == pytest.approx(truth.losses / 0.2, rel=0.01)


def test_the_answer_is_told_before_the_search_for_what_stops_it(
    hammering, monkeypatch, capsys
):
    """An interrupted search leaves verdict, cause and level; they came with the cures."""

    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("squealpipe.brake.assess.assess.pad_boundaries", interrupted)
    numbers = [f"--{name.replace('_', '-')}={value}" for name, value in NUMBERS.items()]
    run(["assess", "22deg", "46deg", *numbers])
    assert capsys.readouterr().out.splitlines() == list(first_lines(hammering))


def test_strikes_wait_for_the_search_where_no_fact_depends_on_them(monkeypatch):
    """They take half of the time to a verdict; what a push leaves quiet is "unless struck"."""
    number = []

    def counted(starts, **options):
        number.append(len(starts))
        return settle(starts, **options)

    monkeypatch.setattr("squealpipe.brake.assess.assess.settle", counted)
    noisy = judge(PAD, *HAMMER, tol=1e-10)
    assert (noisy.verdict, len(noisy.later), number) == (Verdict.hammers, 3, [2])
    quiet = judge(PAD.with_(mu=0.0, mu_static=0.0), *HAMMER, tol=1e-10)
    assert (quiet.verdict, len(quiet.later), number) == (Verdict.quiet, 0, [2, 5])
    states = np.array([start.state for start in noisy.later])
    sliding = Sliding.of(noisy.design)
    expected = [start.state for start in strikes(noisy.design, sliding)]
    np.testing.assert_array_equal(states, expected)


@pytest.mark.release
def test_a_pad_that_squeals_in_stick_slip(squealing):
    truth = Pad(NUMBERS, *SQUEAL).run((0, 0, 0, 0), 0.3, 0.2)
    assert int(squealing.verdict) == Verdict.squeals
    assert int(squealing.mechanism) == Mechanism.falling_friction
    line = strongest_line(truth.velocity[0], truth.step)
    assert float(squealing.frequency) == pytest.approx(line, abs=0.5)
    assert float(squealing.frequency) == pytest.approx(750.0, abs=2.0)
    assert float(squealing.stick_fraction) == pytest.approx(truth.stuck, abs=2e-3)
    assert float(squealing.velocity_rms_along) == pytest.approx(
        truth.velocity[0].std(), rel=2e-3
    )
    assert bool(squealing.periodic)
    assert float(squealing.impact_rate) == 0.0


@pytest.mark.parametrize(
    "cure", ["mu", pytest.param("belt_speed", marks=pytest.mark.release)]
)
def test_the_boundary_of_a_cure_has_noise_on_one_side_and_none_on_the_other(
    squealing, cure
):
    """Where A1's linear motion decides, it is exact: a per cent on either side tells."""
    row = squealing.sel(cure=cure)
    # of few digits, for the integrator apart has its answers written down
    away = math.copysign(1.0, float(row.quiet_from - row.value))
    for side, quiet in ((1.01, True), (0.99, False)):
        value = float(row.quiet_from) * side**away
        changed = {cure: value}
        if cure == "mu":
            factor = value / float(row.value)
            changed = {name: factor * NUMBERS[name] for name in ("mu", "mu_static")}
        changed = {name: float(f"{each:.6g}") for name, each in changed.items()}
        design = Design(Parameters(**NUMBERS | changed), *SQUEAL)
        start = pushed(design, Sliding.of(design)).state
        size = np.hypot(*(start - Sliding.of(design).state)[:2])
        late = late_speed(changed, np.round(start, 10).tolist())
        late /= size * 2 * math.pi * float(squealing.frequency)
        assert bool(late < 1.0) is quiet


@written
def late_speed(changed, start):
    """Largest speed along the belt from 0.1 to 0.15 s, by the integrator apart."""
    run = Pad(NUMBERS | changed, *SQUEAL).run(start, 0.15, 0.1, tol=1e-9)
    return float(np.abs(run.velocity[0]).max())


@pytest.mark.release
def test_a_motion_led_to_the_boundary_lasts_up_to_it_and_not_beyond(squealing):
    """Stick–slip beside quiet sliding ends in a fold, which small steps of the speed find."""
    row = squealing.sel(cure="belt_speed")
    first, fold = float(row.quiet_from), float(row.quiet_from_any_start)
    assert fold > 1.2 * first
    state, loud = np.zeros(4), []
    for share in (0.5, 0.65, 0.8, 0.88, 0.92, 0.95, 0.97, 0.985, 1.015):
        last = 0.05 if 0.5 < share < 1.0 else 0.2
        run = Pad(NUMBERS | {"belt_speed": share * fold}, *SQUEAL).run(
            state, last, last - 0.005, tol=1e-8, samples=512
        )
        state = run.final
        loud.append(np.abs(run.velocity[0]).max())
    assert loud[-2] > loud[0]
    assert loud[-1] < 0.1 * loud[-2]


def test_cures_are_sorted_by_their_change_and_within_the_ranges_tried(squealing):
    change = np.abs(squealing.change.values)
    found = change[np.isfinite(change)]
    assert set(map(str, squealing.cure.values)) == set(CURES)
    assert (np.diff(found) >= 0).all()
    assert np.isnan(change[found.size :]).all()
    known = squealing.isel(cure=slice(found.size))
    assert (known.quiet_from >= known.lowest_tried).all()
    assert (known.quiet_from <= known.highest_tried).all()
    # what is quiet from any start is quiet from a push, too
    farther = np.abs(known.change_any_start) >= np.abs(known.change) - 1e-9
    assert (farther | np.isnan(known.change_any_start)).all()


@pytest.mark.release
def test_without_friction_it_is_quiet_and_the_margin_is_where_it_starts():
    damped = PAD.with_(mu=0.05, mu_static=None, friction_law="coulomb")
    quiet = assess(damped, *HAMMER)
    assert int(quiet.verdict) == Verdict.quiet
    assert int(quiet.mechanism) == Mechanism.none
    assert float(quiet.velocity_rms_along) == 0.0
    assert float(quiet.growth_rate) < 0.0
    onset = float(quiet.quiet_from.sel(cure="mu"))
    assert onset > 0.05
    # strikes die out with any damping, though ever more slowly
    assert np.isnan(quiet.quiet_from_any_start.sel(cure="damping"))
    for mu, sign in ((onset * 1.02, 1.0), (onset * 0.98, -1.0)):
        growth = stability_map(damped.with_(mu=mu), HAMMER[:1], HAMMER[1:]).growth_rate
        assert growth.item() * sign > 0.0


@pytest.mark.parametrize("speed", [10.0, 12.0, 14.0])
def test_damping_that_outweighs_a_slight_fall_of_friction_has_a_closed_form(speed):
    """At K12 = 0 the dashpots along the belt and N dμ/dw cancel, though growth is 1e-7 or less."""
    fall = {"mu": 0.37, "mu_static": 0.55, "friction_speed": 1.0, "belt_speed": speed}
    long = {"length1": 1e3, "length2": 1e3, "damping1": 0.0, "damping2": 0.0}
    pad = PAD.with_(**fall, **long)
    force = pad.k3 * pad.preload * pad.k1 / (pad.k1 + pad.k3)
    truth = (
        force * (0.55 - 0.37) * math.exp(-speed) / critical_damping(pad.k1, pad.mass)
    )
    damping = cures_of(Design(pad, math.pi / 4, math.pi / 4))["damping"]
    (interval,) = linear_intervals(damping, growth_margin)
    assert interval.low == pytest.approx(truth, rel=1e-3)
    assert interval.high_open


def test_a_stretch_of_noise_between_two_quiet_values_is_seen():
    """By a program of its own growth is −6e-5 of the rate at 0.65 rad, 4e-4 at 0.6525 rad."""
    pad = Parameters(
        mass=0.8546612717532482,
        k1=12832986.9379285,
        k2=15873947.766090406,
        k3=3597655.482289341,
        preload=0.0003321601047244889,
        belt_speed=1.1419970167674642,
        length1=0.1880677603348185,
        length2=0.1902241108442873,
        damping1=83.84215411195765,
        damping2=84.27815570538593,
        mu=0.4903284252276046,
        friction_law="hyperbolic",
        mu_static=0.5166729296583626,
        friction_speed=2.063646776673715,
    )
    cures = cures_of(Design(pad, 0.4362176191815051, 0.7838847933211535))
    intervals = linear_intervals(cures["alpha1"], growth_margin)
    present = next(each for each in intervals if each.contains(cures["alpha1"].value))
    assert 0.65 < present.high < 0.6525


def test_growth_of_small_motions_is_that_of_a_run():
    """The complex step against the engine: a push grows by exp(σ t)."""
    design = Design(PAD.with_(belt_speed=6.0), *SQUEAL)
    sliding = Sliding.of(design)
    start = sliding.state + 1e-4 * PAD.preload * sliding.push
    truth = Pad(NUMBERS | {"belt_speed": 6.0}, *SQUEAL)
    early, late = (
        np.sqrt((truth.run(start, end, end - 0.01, tol=1e-12).velocity ** 2).mean())
        for end in (0.02, 0.07)
    )
    assert math.log(late / early) / 0.05 == pytest.approx(sliding.growth_rate, rel=5e-3)


@pytest.mark.release
def test_growth_about_a_knot_at_belt_speed_is_that_of_a_run():
    """Small motions about a corner of the law grow by the mean of both slopes."""
    speeds, values = (0.0, 1.0, 2.0, 3.0, 5.0), (0.5, 0.47, 0.42, 0.41, 0.4)

    class Measured(Pad):
        def coefficient(self, speed):
            return np.interp(speed, speeds, values)

    table = "linear" + "".join(
        f" {w}:{mu}" for w, mu in zip(speeds, values, strict=True)
    )
    numbers = NUMBERS | {"mu": values[-1], "mu_static": values[0]}
    own = {"mu", "mu_static", "friction_speed", "friction_law"}
    given = {name: value for name, value in NUMBERS.items() if name not in own}
    pad = Parameters(**given, friction_law=table)
    sliding = Sliding.of(Design(pad, *SQUEAL))
    assert sliding.is_unstable
    start = sliding.state + 1e-4 * PAD.preload * sliding.push
    early, late = (
        np.sqrt(
            (
                Measured(numbers, *SQUEAL)
                .run(start, end, end - 0.01, tol=1e-11)
                .velocity
                ** 2
            ).mean()
        )
        for end in (0.02, 0.07)
    )
    rate = math.log(late / early) / 0.05
    assert rate == pytest.approx(sliding.growth_rate, rel=0.02)
    linear = stability_map(pad, SQUEAL[:1], SQUEAL[1:])
    assert float(linear.growth_rate[0, 0]) == pytest.approx(rate, rel=0.1)


SOFT = NUMBERS | {
    "mass": 0.147,
    "k1": 2.99e6,
    "k2": 1.55e7,
    "k3": 2.48e6,
    "preload": 1.73e-3,
    "mu_static": None,
    "friction_law": "coulomb",
    "length1": 0.127,
    "length2": 0.0802,
}
PAPER = SOFT | {
    "mass": 1.0,
    "k1": 1.0,
    "k2": 1.0,
    "k3": 0.65,
    "preload": 1.0,
    "mu": 0.3,
    "belt_speed": 100.0,
    "length1": 15.0,
    "length2": 15.0,
    "damping1": 0.0,
    "damping2": 0.0,
}


@pytest.mark.parametrize(
    ("pad", "alpha1", "alpha2"),
    [
        (SOFT | {"mu": 0.87}, 64.2, 96.7),
        (SOFT | {"mu": 0.97}, 64.2, 96.7),
        (SOFT | {"mu": 1.05}, 64.2, 96.7),
        (SOFT | {"mu": 1.2}, 64.2, 96.7),
        (SOFT | {"mu": 0.582}, 64.2, 113.4),
        (SOFT | {"mu": 0.582}, 64.2, 120.5),
        (PAPER, 72.0, 100.0),
    ],
)
def test_steady_sliding_is_where_slowly_raised_friction_leads(pad, alpha1, alpha2):
    """Against an overdamped descent; from rest, Newton's method leaves contact but at the first.

    The last but one is just beyond a fold, where the mass lingers before it goes far; at the last
    Newton's method under the whole friction jumps to another branch.
    """
    angles = np.radians((alpha1, alpha2))
    truth, rate = Pad(pad, *angles), (pad["k1"] + pad["k2"]) / (2.0 * pad["mass"])

    def descent(time, place):
        truth.p.mu = truth.p.mu_static = pad["mu"] * min(time / 500.0, 1.0)
        return np.array(truth.field("slower")(0.0, (*place, 0.0, 0.0))[2:]) / rate

    run = solve_ivp(
        descent, (0.0, 6000.0), (0.0, 0.0), method="LSODA", rtol=1e-9, atol=1e-12
    )
    sliding = Sliding.of(Design(Parameters(**pad), *angles))
    np.testing.assert_allclose(sliding.state[:2], run.y[:, -1], rtol=1e-5)


def test_a_belt_at_rest_has_no_steady_sliding():
    still = assess(PAD.with_(belt_speed=0.0), *SQUEAL)
    assert int(still.mechanism) == Mechanism.no_sliding_state
    assert np.isnan(still.sliding_growth_rate)
    assert int(still.verdict) == int(still.sudden_verdict) == Verdict.quiet


SLOWLY = Parameters(
    mass=0.32,
    k1=1.2e7,
    k2=0.9e7,
    k3=1e7,
    preload=4e-4,
    belt_speed=-5.0 / 3.6,
    length1=0.1,
    length2=0.1,
    damping1=19.595917942265427,
    damping2=16.970562748477143,
    friction_law="linear 0.0:0.52 0.5:0.5 1.0:0.47 2.0:0.43 4.0:0.38 10.0:0.34",
)
"""Its second mode, at 1.25 kHz, grows by 0.4 % in a period beneath stick–slip at 940 Hz."""


@pytest.mark.parametrize(
    "start", ["pushed", pytest.param("sudden", marks=pytest.mark.release)]
)
def test_a_mode_that_grows_slowly_beneath_a_loud_one_has_its_time(start):
    """Against own Runge–Kutta runs of two steps, from 7 to 8 s after the push.

    Statistics of two windows agreed after 0.2 s at 0.198 m/s across, 2.44 kN and 7.3 % of stick.
    """
    design = Design(SLOWLY, *np.radians((55.0, 30.0)))
    sliding = Sliding.of(design)
    begun = pushed(design, sliding)
    if start == "sudden":
        begun = start_at(design, sliding, np.zeros(4))
    (settled,) = settle([begun], tol=1e-9, rules=settling_of_numbers)
    found, _ = levels(design, sliding, settled, tol=1e-9)
    assert settled.verdict is Verdict.squeals
    assert found["velocity_rms_along"] == pytest.approx(0.95416, rel=1e-3)
    assert found["velocity_rms_across"] == pytest.approx(0.55343, rel=1e-3)
    assert found["peak_contact_force"] == pytest.approx(3317.94, rel=1e-4)
    assert found["stick_fraction"] == pytest.approx(0.05117, rel=2e-3)
    assert found["velocity_rms_across_error"] == 0.0


def test_the_error_of_a_mean_covers_the_mean_of_dependent_blocks():
    """Of an autoregressive series, whose mean is 0, in 95 of 100 samples or nearly so."""
    rng, inside = np.random.default_rng(5), 0
    for _ in range(400):
        noise, value, series = rng.standard_normal(16), 0.0, []
        for each in noise:
            value = 0.4 * value + each
            series.append(value)
        inside += abs(np.mean(series)) <= error_of_mean(np.array(series))
    assert 0.92 < inside / 400 < 0.99


def begun_loud():
    """A lightly damped pad, its steady sliding, and a start that keeps contact and dies out."""
    pad = PAD.with_(mu=0.1, mu_static=None, friction_law="coulomb")
    design = Design(pad, math.radians(60), math.radians(60))
    sliding = Sliding.of(design)
    loud = 0.3 * (pad.preload - sliding.state[1]) * sliding.push
    return design, sliding, start_at(design, sliding, sliding.state + loud)


@pytest.fixture
def _modes_show_nothing(monkeypatch):
    """The decay of modes does not show that a motion dies out, so that windows have to."""
    monkeypatch.setattr(windows, "dies_out", lambda *_: False)


@pytest.mark.usefixtures("_modes_show_nothing")
def test_a_long_window_that_begins_loud_and_ends_small_is_quiet():
    """Before the last window of a lightly damped pad is over, its motion may have died out."""
    design, sliding, start = begun_loud()
    seconds = 8.0 / abs(sliding.growth_rate)
    lengths = np.array([seconds])
    window = run_windows(
        [design], start.state[None], lengths, settling_of_verdicts, tol=1e-9
    )
    now = window.row(0)
    assert not now.switched
    assert now.largest_velocity > 15.0 * start.speed
    (settled,) = settle_runs(
        [start],
        lambda *_: window,
        Horizon(*[lengths] * 2, 9.0 * lengths),
        settling_of_verdicts,
    )
    assert settled.verdict is Verdict.quiet
    assert settled.elapsed == 2.0 * seconds


@pytest.mark.usefixtures("_modes_show_nothing")
def test_what_decays_as_small_motions_do_is_quiet_though_the_horizon_ends_before():
    design, sliding, start = begun_loud()
    most = 1.2 / abs(sliding.growth_rate) / design.period
    (settled,) = settle([start], tol=1e-9, most=most)
    assert settled.verdict is Verdict.quiet
    assert settled.last.largest_velocity > 10.0 * start.speed
    assert settled.elapsed == pytest.approx(most * design.period)


def test_a_run_that_ends_at_once_is_undetermined_without_a_warning(recwarn):
    design = Design(PAD, 0.0, math.radians(2.0))
    pivot = np.array([PAD.length1, 0.0, 0.0, 0.0])
    (settled,) = settle([start_at(design, None, pivot)], tol=1e-9, most=100.0)
    assert settled.verdict is Verdict.undetermined
    assert not settled.last.finished
    assert not recwarn.list


def test_an_undamped_brake_is_quiet_where_a_push_stays_small():
    brake = Parameters(
        mass=0.45,
        k1=1e7,
        k2=1e7,
        k3=7e6,
        preload=5.714e-4,
        mu=0.1,
        belt_speed=2.0,
        length1=0.1,
        length2=0.1,
    )
    design = Design(brake, math.radians(80), math.radians(20))
    (settled,) = settle([pushed(design, Sliding.of(design))], tol=1e-12)
    assert settled.verdict is Verdict.quiet


@pytest.mark.parametrize("cure", list(CURES))
def test_a_cure_at_the_present_value_changes_nothing(cure):
    design = Design(PAD, *HAMMER)
    found = cures_of(design)[cure]
    same = found.apply(found.value)
    assert (same.alpha1, same.alpha2) == (design.alpha1, design.alpha2)
    assert np.allclose(
        [getattr(same.params, name) for name in ("mu", "k1", "k3", "damping1")],
        [getattr(PAD, name) for name in ("mu", "k1", "k3", "damping1")],
    )


def measured_pad():
    """The pad with its law at twelve speeds."""
    speeds = np.array([0.0, 0.2, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.3, 2.8, 3.5, 5.0])
    law = "cubic" + "".join(
        f" {w!r}:{0.37 + 0.18 * math.exp(-w / 1.7)!r}" for w in speeds.tolist()
    )
    law_of = {"mu", "mu_static", "friction_speed", "friction_law"}
    given = {name: value for name, value in NUMBERS.items() if name not in law_of}
    return Parameters(**given, friction_law=law)


@pytest.mark.parametrize("law", ["exponential", "hyperbolic", "coulomb", "table"])
def test_the_present_friction_is_that_at_belt_speed_whatever_the_law(law):
    """It was that at high speed for laws with a name, and that at belt speed for tables."""
    pad, excess = PAD.with_(belt_speed=-2.0), 0.55 - 0.37
    if law == "table":
        pad = measured_pad().with_(belt_speed=-2.0)
    elif law == "coulomb":
        pad = pad.with_(friction_law=law, mu_static=None)
    else:
        pad = pad.with_(friction_law=law)
    fall = {"coulomb": 0.0, "hyperbolic": 1.0 / (1.0 + 2.0 / 1.7)}
    truth = 0.37 + excess * fall.get(law, math.exp(-2.0 / 1.7))
    cure = cures_of(Design(pad, *SQUEAL))["mu"]
    assert cure.value == pytest.approx(truth, rel=1e-12)
    halved = cure.apply(0.5 * truth).params
    assert halved.drag == pytest.approx(-0.5 * truth, rel=1e-12)
    assert halved.static_mu == pytest.approx(0.5 * pad.static_mu, rel=1e-12)


def test_a_measured_table_squeals_as_its_law_does(squealing):
    design = Design(measured_pad(), *SQUEAL)
    sliding = Sliding.of(design)
    (settled,) = settle([pushed(design, sliding)], tol=1e-9)
    found, _ = levels(design, sliding, settled, tol=1e-9)
    assert settled.verdict is Verdict.squeals
    assert found["frequency"] == pytest.approx(float(squealing.frequency), rel=2e-3)
    assert found["stick_fraction"] == pytest.approx(
        float(squealing.stick_fraction), abs=5e-3
    )


@pytest.mark.release
def test_a_measured_table_gives_the_answer_of_its_law(squealing):
    table = assess(measured_pad(), *SQUEAL)
    assert float(table.frequency) == pytest.approx(float(squealing.frequency), rel=2e-3)
    assert float(table.stick_fraction) == pytest.approx(
        float(squealing.stick_fraction), abs=5e-3
    )
    for cure in ("k3", "belt_speed", "alpha2"):
        assert float(table.change.sel(cure=cure)) == pytest.approx(
            float(squealing.change.sel(cure=cure)), rel=0.1
        )
    for name in ("value", "quiet_from"):
        mine, truth = (float(each[name].sel(cure="mu")) for each in (table, squealing))
        assert mine == pytest.approx(truth, rel=0.1)


def test_it_sweeps_and_survives_a_file(tmp_path, monkeypatch):
    # of any start the boundaries of ``squealing`` are known, and take most of the time
    monkeypatch.setattr(
        "squealpipe.vibration.cures.of_any_start", lambda by_cure, *_, **__: by_cure
    )
    sweep = Sweep(
        task="assess",
        params=PAD,
        vary={"belt_speed": [0.0, 2.0]},
        fixed={"alpha1": SQUEAL[0], "alpha2": SQUEAL[1]},
    )
    swept = load(save(run_sweep(sweep, workers=1), tmp_path / "swept.nc"))
    assert swept.verdict.values.tolist() == [Verdict.quiet, Verdict.squeals]
    assert swept.change.sel(cure="mu").dims == ("belt_speed",)
    assert float(swept.quiet_from.sel(cure="mu")[1]) < PAD.mu


def test_an_undamped_pad_is_pushed_along_its_slowest_mode():
    """Modes that grow alike, not at all, are told apart by their frequency."""
    plain = {"friction_law": "coulomb", "mu": 0.1, "mu_static": None}
    undamped = PAD.with_(damping1=0.0, damping2=0.0, **plain)
    sliding = Sliding.of(Design(undamped, *HAMMER))
    assert not sliding.is_unstable
    squares, shapes = np.linalg.eig(sliding.jacobian[2:, :2])  # −ω²
    slowest = shapes[:, squares.real.argmax()]
    assert abs(slowest @ sliding.push[:2]) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("extreme", ["mass", "damping1", "preload"])
def test_numbers_beyond_those_of_a_double_are_refused_by_name(extreme):
    """1e308 ended in a division by zero, in a matrix with NaNs, or blamed the start."""
    with pytest.raises(ValueError, match=r"with mass = .*use other units"):
        assess(PAD.with_(**{extreme: 1e308}), *SQUEAL)
