"""Systems from a generator, event by event against DOP853, and what is refused."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealpipe import Switch, System
from squealpipe.functions import cos
from squealpipe.schema import Outcome
from squealpipe.systems.impact_oscillator import impact_oscillator

T_END, MOST_EVENTS = 20.0, 60


def random_system(seed):
    """Damped linear regimes with a cubic term and forcing, one reset, and a `to` that decides."""
    rng = np.random.default_rng(seed)
    n, regimes = int(rng.integers(2, 5)), int(rng.integers(1, 4))
    names = [f"s{i}" for i in range(n)]
    matrices = {}
    for k in range(regimes):
        part = rng.normal(size=(n, n))
        matrices[f"r{k}"] = part - part.T - 0.2 * np.eye(n) - 0.1 * np.diag(rng.random(n))
    force, normal = rng.normal(size=n), rng.normal(size=n)
    level = 0.3 * float(rng.random())

    def field_of(matrix):
        def field(t, s, p, r):
            values = [getattr(s, name) for name in names]
            return {
                name: sum(float(a) * v for a, v in zip(row, values, strict=True))
                + float(f) * p.drive * cos(p.omega * t)
                - 0.1 * values[i] * values[i] * values[i]
                for i, (name, row, f) in enumerate(zip(names, matrix, force, strict=True))
            }

        return field

    def height(t, s, p, r):
        return (
            sum(float(w) * getattr(s, name) for w, name in zip(normal, names, strict=True)) + level
        )

    keys = list(matrices)
    switches = [
        Switch(
            "fall", keys[0], height,
            to=[(keys[-1], lambda t, s, p, r: s.s1, "aside"), keys[regimes // 2]],
            reset=lambda t, s, p, r: {"s0": -0.7 * s.s0 + 0.05},
        )
    ]  # fmt: skip
    if regimes > 1:
        back = lambda t, s, p, r: 0.2 - height(t, s, p, r)  # noqa: E731
        switches.append(Switch("back", tuple(keys[1:]), back, to=keys[0]))
    return System(
        f"random {seed}",
        states=dict.fromkeys(names, "1"),
        parameters={"drive": 1.0, "omega": 1.3},
        regimes={key: {} for key in keys},
        field={key: field_of(matrix) for key, matrix in matrices.items()},
        switches=switches,
        start={**dict.fromkeys(names, 0.5), "regime": keys[0]},
    )


def independent_run(system, start, parameters):
    """The same functions on floats, by DOP853; times and kinds of the events."""
    p = SimpleNamespace(**{**system.parameters, **parameters})
    names, regime, t = list(system.states), system.start["regime"], 0.0
    z, found = np.array([start[name] for name in names]), []

    def state(values):
        return SimpleNamespace(**dict(zip(names, values, strict=True)))

    while t < T_END and len(found) < MOST_EVENTS:
        here = [
            s for s in system.switches if regime in ([s.leaves], s.leaves)[type(s.leaves) is tuple]
        ]

        def rates(time, values, regime=regime):
            return list(system.field[regime](time, state(values), p, None).values())

        def guard(switch):
            def value(time, values):
                return switch.when(time, state(values), p, None)

            value.terminal, value.direction = True, -1
            return value

        run = solve_ivp(
            rates, (t, T_END), z, "DOP853", rtol=1e-12, atol=1e-12, max_step=0.05,
            events=[guard(s) for s in here],
        )  # fmt: skip
        t, z = run.t[-1], run.y[:, -1]
        if run.status != 1:
            break
        switch = here[next(i for i, times in enumerate(run.t_events) if len(times))]
        s, targets = state(z), [switch.to] if isinstance(switch.to, str) else switch.to
        for entry in targets:
            regime, condition, kind = ((entry, None, switch.name), entry)[type(entry) is tuple]
            if condition is None or condition(t, s, p, None) >= 0.0:
                break
        found.append((t, kind))
        for name, new in (switch.reset(t, s, p, None) if switch.reset else {}).items():
            z[names.index(name)] = new
    return found, z


@pytest.mark.parametrize("seed", range(8))
def test_events_of_random_systems_are_those_of_dop853(seed):
    system = random_system(seed)
    rng = np.random.default_rng(100 + seed)
    for _ in range(2):
        start = {name: float(rng.uniform(0.2, 1.0)) for name in system.states}
        given = {"drive": float(rng.uniform(0.5, 2.0)), "omega": float(rng.uniform(0.5, 2.0))}
        run = system.simulate(T_END, start=start, **given)
        events, z = independent_run(system, start, given)
        kinds = run.event_kind.attrs["flag_meanings"].split()
        mine = [kinds[int(k)] for k in run.event_kind]
        growth = abs(float(system.ensemble(T_END, start=start, horizon=True, **given)
                           .lyapunov_exponent)) * T_END  # fmt: skip
        if growth > np.log(1e6):
            continue  # chaotic: the lists need not agree to the end
        accumulates = int(run.outcome) == Outcome.accumulation
        if accumulates:  # where DOP853 falls through the surface
            events = [event for event in events if event[0] < float(run.end_time) - 1e-8]
            assert len(events) > 5
        elif len(events) < MOST_EVENTS:
            assert len(mine) == len(events)
        assert mine[: len(events)] == [kind for _, kind in events]
        times = run.event_time[: len(events)]
        np.testing.assert_allclose(times, [t for t, _ in events], atol=1e-8)
        if len(events) < MOST_EVENTS and not accumulates:
            np.testing.assert_allclose([run[n][-1] for n in system.states], z, atol=1e-7)


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
    difference = np.hypot(float(ends[0].x - ends[1].x), float(ends[0].v - ends[1].v)) / 2e-7
    assert np.exp(12.0 * float(base.lyapunov_exponent)) == pytest.approx(difference, rel=1e-5)


GOOD = {
    "states": {"x": "m", "v": "m/s"},
    "parameters": {"gap": 1.0},
    "regimes": {"free": {}},
    "field": lambda t, s, p, r: {"x": s.v, "v": -s.x},
    "switches": [
        Switch(
            "hit", "free", lambda t, s, p, r: p.gap - s.x, "free", lambda t, s, p, r: {"v": -s.v}
        )
    ],
    "start": {"x": 0.0, "v": 0.0},
}


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"field": lambda t, s, p, r: {"x": s.v}}, ValueError, "lacks the rate of the state 'v'"),
        (
            {"field": lambda t, s, p, r: {"x": s.v, "v": abs(s.x)}},
            TypeError,
            "make each side a reg",
        ),
        ({"field": lambda t, s, p, r: {"x": s.v, "v": -s.y}}, AttributeError, "has no 'y'"),
        ({"parameters": {"x0": 1.0}}, ValueError, "the name is taken"),
        ({"parameters": {"times": 1.0}}, ValueError, "the name is taken"),
        ({"start": {"x": 0.0}}, ValueError, "lacks the state 'v'"),
        (
            {"switches": [Switch("hit", "fre", lambda t, s, p, r: s.x, "free")]},
            ValueError,
            "'free'",
        ),
        (
            {"switches": [Switch("hit", "free", lambda t, s, p, r: p.gap - 1.0, "free")]},
            ValueError,
            "constant in regime 'free'",
        ),
        (
            {
                "switches": [
                    Switch("hit", "free", lambda t, s, p, r: s.x, [("free", GOOD["field"])])
                ]
            },
            ValueError,
            "no last resort",
        ),
        (
            {"switches": [Switch("hit", "free", lambda t, s, p, r: p.gap - s.x, "free")]},
            ValueError,
            "fire again at once",
        ),
    ],
)
def test_a_wrong_definition_is_refused_before_anything_is_compiled(change, error, message):
    with pytest.raises(error, match=message):
        System("wrong", **{**GOOD, **change})


@pytest.mark.parametrize("method", ["simulate", "ensemble", "basin"])
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"gpa": 1.0}, "did you mean 'gap'"),
        ({"start": {"y": 1.0}}, "'y' is unknown"),
        ({"start": {"regime": "fre"}}, "did you mean 'free'"),
        ({"start": 1.0}, "start = 1.0"),
        ({"gap": float("nan")}, "gap = nan"),
        ({"tol": 0.0}, "tol = 0.0"),
        ({"t_end": -1.0}, "t_end = -1.0"),
    ],
)
def test_arguments_of_a_run_are_checked(method, options, message):
    with pytest.raises(ValueError, match=message):
        getattr(System("good", **GOOD), method)(**{"t_end": 1.0, "start": {}} | options)


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
        assert float(system.ensemble(1.0, start=start).x) == pytest.approx(end, rel=1e-14)
        assert float(system.simulate(1.0, start=start).x[-1]) == pytest.approx(end, rel=1e-14)
