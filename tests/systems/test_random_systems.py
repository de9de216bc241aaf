"""Systems from a generator, event by event against DOP853, and what is refused."""

import os
from functools import lru_cache

import numpy as np
import pytest

from squealpipe import Switch, System
from squealpipe.functions import cos
from squealpipe.schema import Outcome
from squealpipe.systems.shipped.dry_friction import dry_friction_oscillator
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
from tests.oracles.definition import Definition
from tests.oracles.written import written
from tests.samples import some

T_END, MOST_EVENTS = 15.0, 60
DRAWS = int(
    os.environ.get("SQUEALPIPE_DRAWS", "5")
)  # of each structure, in the release tier


def random_linear(rng, n):
    part = rng.normal(size=(n, n))
    return part - part.T - 0.2 * np.eye(n) - 0.1 * np.diag(rng.random(n))


def random_rates(names, matrix, force):
    """Damped linear rates with a cubic term and forcing."""

    def rates(t, s, p):
        values = [getattr(s, name) for name in names]
        return {
            name: sum(float(a) * v for a, v in zip(row, values, strict=True))
            + float(f) * p.drive * cos(p.omega * t)
            - 0.1 * values[i] * values[i] * values[i]
            for i, (name, row, f) in enumerate(zip(names, matrix, force, strict=True))
        }

    return rates


def random_height(rng, names):
    """An affine function of the states."""
    normal, level = rng.normal(size=len(names)), 0.3 * float(rng.random())

    def height(t, s, p, r):
        parts = (
            float(w) * getattr(s, name) for w, name in zip(normal, names, strict=True)
        )
        return sum(parts) + level

    return height


def patches(rng, names):
    """1 to 4 regimes with fields of their own, one reset, and a ``to`` that decides."""
    keys = [f"r{k}" for k in range(int(rng.integers(1, 5)))]
    force, height = rng.normal(size=len(names)), random_height(rng, names)

    def field_of(rates):
        return lambda t, s, p, r: rates(t, s, p)

    switches = [
        Switch(
            "fall",
            keys[0],
            height,
            to=[(keys[-1], lambda t, s, p, r: s.s1, "aside"), keys[len(keys) // 2]],
            reset=lambda t, s, p, r: {"s0": -0.7 * s.s0 + 0.05},
        )
    ]
    if len(keys) > 1:
        back = lambda t, s, p, r: 0.2 - height(t, s, p, r)  # noqa: E731
        switches.append(Switch("back", tuple(keys[1:]), back, to=keys[0]))
    rates = (random_rates(names, random_linear(rng, len(names)), force) for _ in keys)
    return {
        "regimes": {key: {} for key in keys},
        "field": {key: field_of(each) for key, each in zip(keys, rates, strict=True)},
        "switches": switches,
        "start": {**dict.fromkeys(names, 0.5), "regime": keys[0]},
    }


def stick(rng, names):
    """Dry friction on s1, which sticks at 0 while it can, and an impact with a reset."""
    rates = random_rates(
        names, random_linear(rng, len(names)), rng.normal(size=len(names))
    )
    height, limit = random_height(rng, names), 0.3 + float(rng.random())

    def pull(t, s, p):
        return rates(t, s, p)["s1"]

    def field(t, s, p, r):
        found = rates(t, s, p)
        return {**found, "s1": (1.0 - r.held) * (found["s1"] - limit * r.side)}

    return {
        "regimes": {
            "up": {"side": 1.0, "held": 0.0},
            "down": {"side": -1.0, "held": 0.0},
            "held": {"side": 0.0, "held": 1.0},
        },
        "field": field,
        "switches": [
            Switch(
                "turn",
                ("up", "down"),
                lambda t, s, p, r: r.side * s.s1,
                to=[
                    ("held", lambda t, s, p, r: limit**2 - pull(t, s, p) ** 2, "stick"),
                    ("down", lambda t, s, p, r: r.side),
                    "up",
                ],
                reset=lambda t, s, p, r: {"s1": 0.0},
            ),
            Switch("slip_up", "held", lambda t, s, p, r: limit - pull(t, s, p), "up"),
            Switch(
                "slip_down", "held", lambda t, s, p, r: limit + pull(t, s, p), "down"
            ),
            Switch(
                "impact",
                ("up", "down"),
                lambda t, s, p, r: height(t, s, p, r) + 1.0,
                to=[("up", lambda t, s, p, r: r.side), "down"],
                reset=lambda t, s, p, r: {"s0": -0.7 * s.s0 + 0.05},
            ),
        ],
        "start": {**dict.fromkeys(names, 0.5), "regime": "up"},
    }


@lru_cache(maxsize=1)
def random_system(seed):
    """A system of 2 to 6 states: patches for even seeds, stick for odd ones."""
    rng = np.random.default_rng(seed)
    names = [f"s{i}" for i in range(int(rng.integers(2, 7)))]
    return System(
        f"random {seed}",
        states=dict.fromkeys(names, "1"),
        parameters={"drive": 1.0, "omega": 1.3},
        **(patches, stick)[seed % 2](rng, names),
        period=lambda p: 2.0 * np.pi / p.omega,
    )


@written
def run_apart(seed, start, given, max_step):
    """Events and last state by DOP853."""
    system = random_system(seed)
    truth = Definition(system, given, max_step=max_step)
    begin = [start[name] for name in system.states]
    return truth.run(begin, system.start["regime"], T_END, MOST_EVENTS)


@pytest.mark.parametrize(
    ("seed", "draws"),
    [
        *((n, 1) for n in range(6)),
        *(
            pytest.param(n, DRAWS, marks=pytest.mark.release)
            for n in some(range(6, 60))
        ),
    ],
)
def test_events_of_random_systems_are_those_of_dop853(seed, draws):
    """Some runs of one structure, event by event."""
    system = random_system(seed)
    rng = np.random.default_rng(100 + seed)
    for _ in range(draws):
        start = {name: float(rng.uniform(0.2, 1.0)) for name in system.states}
        given = {
            "drive": float(rng.uniform(0.5, 2.0)),
            "omega": float(rng.uniform(0.5, 2.0)),
        }
        run = system.simulate(T_END, start=start, **given)
        kinds = run.event_kind.attrs["flag_meanings"].split()
        mine = [kinds[int(k)] for k in run.event_kind]
        growth = (
            abs(
                float(
                    system.ensemble(
                        T_END, start=start, horizon=True, **given
                    ).lyapunov_exponent
                )
            )
            * T_END
        )
        if growth > np.log(1e6):
            continue  # chaotic: the lists need not agree to the end
        accumulates, trapped = int(run.outcome) == Outcome.accumulation, False
        # DOP853 sees two crossings in one of its steps as none, or as one at its start
        for max_step in (0.2, 0.01, 0.001, 1e-4):
            events, z = run_apart(seed, start, given, max_step)
            if accumulates:  # where it falls through the surface, or is beyond all
                trapped = len(events) == MOST_EVENTS
                trapped = trapped and abs(events[-1][0] - float(run.end_time)) < 1e-8
                events = [
                    event for event in events if event[0] < float(run.end_time) - 1e-8
                ]
            ends = accumulates or len(events) == MOST_EVENTS
            times = [time for time, _ in events]
            if mine[: len(events) if ends else None] == [
                kind for _, kind in events
            ] and np.allclose(run.event_time[: len(events)], times, 1e-7, 1e-8):
                break
        if accumulates:
            assert trapped or len(events) > 2
        elif len(events) < MOST_EVENTS:
            assert len(mine) == len(events)
        assert mine[: len(events)] == [kind for _, kind in events]
        times = run.event_time[: len(events)]
        np.testing.assert_allclose(times, [t for t, _ in events], atol=1e-8)
        if len(events) < MOST_EVENTS and not accumulates:
            np.testing.assert_allclose(
                [run[n][-1] for n in system.states], z, atol=1e-7
            )


def test_stick_at_rest_is_left_once():
    """Released where the pull reaches the limit: the speed begins at zero with zero slope.

    Round-off of the rate hides its side, not that of the speed, which is exactly zero; late in the
    run the angle of the forcing has lost four digits.
    """
    run = dry_friction_oscillator.simulate(20000.0, omega=0.5)
    assert int(run.outcome) == Outcome.converged
    sticks = 2.0 * 20000.0 * 0.5 / (2.0 * np.pi)
    assert run.sizes["event"] == pytest.approx(2.0 * sticks, abs=5)
    assert (np.diff(run.event_time) > 0.1).all()


def test_growth_is_that_of_a_small_difference_through_impacts():
    """δz by a difference of two runs whose starts differ by 1e-7, over the 1e-7."""
    given = {"omega": 1.2, "amplitude": 0.6}
    base = impact_oscillator.ensemble(12.0, horizon=True, **given)
    assert int(base.count_impact) > 1
    step = 1e-7 / np.sqrt(2.0)
    ends = [
        impact_oscillator.ensemble(12.0, start={"x": s * step, "v": s * step}, **given)
        for s in (1.0, -1.0)
    ]
    difference = (
        np.hypot(float(ends[0].x - ends[1].x), float(ends[0].v - ends[1].v)) / 2e-7
    )
    assert np.exp(12.0 * float(base.lyapunov_exponent)) == pytest.approx(
        difference, rel=1e-5
    )


def bounce(t, s, p, r):
    return {"v": -s.v}


GOOD = {
    "states": {"x": "m", "v": "m/s"},
    "parameters": {"gap": 1.0},
    "regimes": {"free": {}},
    "field": lambda t, s, p, r: {"x": s.v, "v": -s.x},
    "switches": [Switch("hit", "free", lambda t, s, p, r: p.gap - s.x, "free", bounce)],
    "start": {"x": 0.0, "v": 0.0},
}


LAST = [("free", GOOD["field"])]


def pull(force):
    return {"field": lambda t, s, p, r: {"x": s.v, "v": force(s)}}


def hit(when, leaves="free", to="free", reset=None):
    return {"switches": [Switch("hit", leaves, when, to, reset)]}


STUCK = hit(lambda t, s, p, r: p.gap - s.x, reset=lambda t, s, p, r: {"v": 2.0 * s.v})


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        (
            {"field": lambda t, s, p, r: {"x": s.v}},
            ValueError,
            "lacks the rate of the state 'v'",
        ),
        (pull(lambda s: abs(s.x)), TypeError, "make each side a reg"),
        (pull(lambda s: -np.cos(s.x)), TypeError, "take squealpipe.functions"),
        (pull(lambda s: -s.y), AttributeError, "has no 'y'"),
        (pull(lambda s: -s.x / 0.0), ValueError, "the field: .* in each regime"),
        (
            pull(lambda s: -1.0 if s.x == 0.0 else 0.0),
            TypeError,
            "make each side a reg",
        ),
        ({"parameters": {"x0": 1.0}}, ValueError, "the name is taken"),
        ({"parameters": {"gap": 1.0, "x_max": 1.0}}, ValueError, "the name is taken"),
        (
            {"parameters": {"gap": 1.0, "count_hit": 1.0}},
            ValueError,
            "the name is taken",
        ),
        ({"parameters": {"gap": 1.0, "self": 1.0}}, ValueError, "the name is taken"),
        (
            {"outputs": {"x0": ("m", lambda t, s, p, r: s.x)}},
            ValueError,
            "the name is taken",
        ),
        (
            {"stops": {"converged": lambda t, s, p, r: s.x}},
            ValueError,
            "the name is taken",
        ),
        ({"regimes": {"free": {"c": float("inf")}}}, ValueError, "'c'. = inf"),
        ({"regimes": {"a/b": {}}}, ValueError, "a name without /"),
        ({"parameters": {"1st gap": 1.0}}, ValueError, "letters, digits and _"),
        ({"start": {"x": 0.0}}, ValueError, "lacks the state 'v'"),
        (hit(lambda t, s, p, r: s.x, leaves="fre"), ValueError, "'free'"),
        (hit(lambda t, s, p, r: s.x - s.x), ValueError, "constant in regime 'free'"),
        (hit(lambda t, s, p, r: p.gap - 1.0), ValueError, "constant in regime 'free'"),
        (hit(lambda t, s, p, r: s.x, to=LAST), ValueError, "no last resort"),
        (STUCK, ValueError, "fire again at once"),
        ({**STUCK, "field": {"free": GOOD["field"]}}, ValueError, "fire again at once"),
        (
            {"field": lambda t, s, p, r: {"x": s.v, "v": np.nan}},
            ValueError,
            "finite numbers",
        ),
        (
            {"field": lambda t, s, p, r: {"x": s.v, "v": s.x(t - 1.0)}},
            TypeError,
            "delays",
        ),
    ],
)
def test_a_wrong_definition_is_refused_before_anything_is_compiled(
    change, error, message
):
    with pytest.raises(error, match=message):
        System("wrong", **{**GOOD, **change})


def test_one_switch_may_lead_on_through_256_regimes():
    """Each leaves its own interval of a staircase, at its end, for the next."""
    numbers = range(256)

    def leaves(i):
        return lambda t, s, p, r: 0.25 - (r.end - 1.0 - i) ** 2

    stairs = System(
        "stairs",
        states={"x": "1"},
        parameters={},
        regimes={f"r{i}": {"end": i + 1.0} for i in numbers},
        field=lambda t, s, p, r: {"x": 1.0},
        switches=[
            Switch(
                "up",
                [f"r{i}" for i in numbers][:-1],
                lambda t, s, p, r: r.end - s.x,
                to=[*((f"r{i + 1}", leaves(i)) for i in numbers[:-1]), "r0"],
            )
        ],
        start={"x": 0.0, "regime": "r0"},
    )
    run = stairs.simulate(300.0)
    np.testing.assert_array_equal(run.event_time, np.arange(1, 256))
    np.testing.assert_array_equal(run.event_regime, np.arange(1, 256))


@pytest.mark.parametrize("method", ["simulate", "ensemble", "basin"])
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"gpa": 1.0}, "did you mean 'gap'"),
        ({"start": {"y": 1.0}}, "'y' is unknown"),
        ({"start": {"regime": "fre"}}, "did you mean 'free'"),
        ({"start": {"regime": ["free"]}}, "did you mean 'free'"),
    ],
)
def test_arguments_of_a_run_are_checked(method, options, message):
    with pytest.raises(ValueError, match=message):
        getattr(System("good", **GOOD), method)(**{"t_end": 1.0, "start": {}} | options)


def test_a_guess_serves_a_forced_system_without_switches_and_excludes_a_start():
    def field(t, s, p, r):
        return {"x": s.v, "v": cos(np.pi * t) - 0.2 * s.v - s.x}

    system = System(
        "forced", **GOOD | {"switches": (), "field": field}, period=lambda _: 2.0
    )
    cycle = system.limit_cycle(guess={"x": 0.1})
    assert float(cycle.x_max) == pytest.approx(
        1.0 / np.hypot(1.0 - np.pi**2, 0.2 * np.pi)
    )
    with pytest.raises(ValueError, match="start, guess"):
        system.limit_cycle(start={}, guess={})


def test_instants_outside_the_run_and_a_period_below_zero_are_refused():
    for times in ([-3.0, 4.0], [2.0, 1.0], [4.0, 5.5]):
        with pytest.raises(ValueError, match="ascend from 0 to t_end"):
            System("good", **GOOD).simulate(5.0, times=times)
    with pytest.raises(ValueError, match="a time from 0 to t_end"):
        System("good", **GOOD).ensemble(5.0, t_late=6.0)
    with pytest.raises(ValueError, match="period of its forcing"):
        impact_oscillator.limit_cycle(omega=-1.9)


def test_a_run_starts_in_the_regime_that_it_is_given():
    """Without surfaces both regimes fit; the first is taken unless another is named."""
    system = System(
        "growth or decay",
        states={"x": "1"},
        parameters={},
        regimes={"grows": {"rate": 1.0}, "decays": {"rate": -1.0}},
        field=lambda t, s, p, r: {"x": r.rate * s.x},
        start={"x": 1.0},
    )
    for start, end in (({}, np.e), ({"regime": "decays"}, 1.0 / np.e)):
        assert float(system.ensemble(1.0, start=start).x) == pytest.approx(
            end, rel=1e-14
        )
        assert float(system.simulate(1.0, start=start).x[-1]) == pytest.approx(
            end, rel=1e-14
        )
