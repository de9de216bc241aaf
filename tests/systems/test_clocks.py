"""Switches on the time alone: a clock fires where it falls through zero, not on entry."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from squealpipe import Switch, System, labels
from squealpipe.functions import cos, sin

PERIOD, SOURCE, L, C, R = 1e-4, 10.0, 1.5e-3, 2e-5, 40.0


def boost(phase=0.0):
    """A current-mode boost converter: a clock closes the switch, the peak current opens it."""
    return System(
        "boost converter",
        states={"i": ("A", 1.0), "v": ("V", 10.0)},
        parameters={"limit": 1.0},
        regimes={"on": {"d": 0.0}, "off": {"d": 1.0}},
        field=lambda t, s, p, r: {
            "i": (SOURCE - r.d * s.v) / L,
            "v": (r.d * s.i - s.v / R) / C,
        },
        switches=[
            Switch("peak", "on", lambda t, s, p, r: p.limit - s.i, "off"),
            Switch(
                "tick",
                "off",
                lambda t, s, p, r: -sin(2.0 * np.pi * t / PERIOD - phase),
                "on",
            ),
        ],
        start={"i": 0.4, "v": 20.0, "regime": "on"},
        period=lambda p: PERIOD,
        time_scale=PERIOD,
    )


def exact(limit, i, v, time, end, first_tick=0.0):
    """Times of peaks and ticks from closed forms, and the state at the end; starts switched on."""
    events, on = [], True
    matrix = np.array([[0.0, -1.0 / L], [1.0 / C, -1.0 / (R * C)]])
    rest = np.array([SOURCE / R, SOURCE])
    while True:
        if on:
            span = max(0.0, (limit - i) * L / SOURCE)
        else:
            ticks = np.floor((time - first_tick) / PERIOD + 1e-9) + 1.0
            span = first_tick + ticks * PERIOD - time
        last = time + span >= end
        span = end - time if last else span
        if on:
            i, v = i + SOURCE / L * span, v * np.exp(-span / (R * C))
        else:
            i, v = expm(matrix * span) @ (np.array([i, v]) - rest) + rest
        time += span
        if last:
            return events, np.array([i, v])
        events.append((time, "peak" if on else "tick"))
        on = not on


@pytest.mark.parametrize(
    ("limit", "phase", "t_start"),
    [(1.0, 0.0, 0.0), (2.0, 1.0, 0.0), (0.8, 0.0, 0.37 * PERIOD), (3.0, 2.0, 5e-3)],
)
def test_a_boost_converter_switches_when_closed_forms_say(limit, phase, t_start):
    end = t_start + 20.3 * PERIOD
    run = boost(phase).simulate(
        end, t_start=t_start, times=np.array([t_start, end]), limit=limit
    )
    first = phase / (2.0 * np.pi) * PERIOD
    events, final = exact(limit, 0.4, 20.0, t_start, end, first)
    assert labels(run.outcome).item() == "converged"
    assert labels(run.event_kind).values.tolist() == [name for _, name in events]
    times = np.array([time for time, _ in events])
    assert np.abs(run.event_time.values - times).max() < 1e-10 * PERIOD
    assert [run.i.values[-1], run.v.values[-1]] == pytest.approx(final, rel=1e-9)


def test_its_cycle_has_the_multipliers_of_the_map_from_tick_to_tick():
    cycle = boost().limit_cycle(limit=0.8)
    assert labels(cycle.outcome).item() == "converged"
    assert float(cycle.period) == pytest.approx(PERIOD, rel=1e-12)

    def after_a_period(state):
        return exact(0.8, *state, 0.0, PERIOD * (1.0 - 1e-13))[1]

    state = np.array([0.4, 12.0])
    for _ in range(300):
        state = after_a_period(state)
    step = np.diag([1e-5, 1e-4])
    columns = [
        (after_a_period(state + h) - after_a_period(state - h)) / (2.0 * h.sum())
        for h in step
    ]
    expected = np.sort(np.linalg.eigvals(np.array(columns).T).real)
    assert np.sort(cycle.multiplier_real.values) == pytest.approx(expected, abs=1e-6)


def test_ticks_of_an_ensemble_are_those_of_single_runs():
    limits = np.array([0.3, 0.8, 1.5, 2.5])
    found = boost().ensemble(30.5 * PERIOD, limit=limits)
    for place, limit in enumerate(limits):
        run = boost().simulate(30.5 * PERIOD, limit=limit)
        ticks = labels(run.event_kind).values == "tick"
        assert int(found.count_tick[place]) == ticks.sum()
        assert float(found.first_tick[place]) == run.event_time.values[ticks][0]


def toggled():
    """A state that goes up or down, turned at each tick of one clock."""
    return System(
        "toggle",
        states={"x": "1"},
        parameters={},
        regimes={"up": {"speed": 1.0}, "down": {"speed": -1.0}},
        field=lambda t, s, p, r: {"x": r.speed},
        switches=[
            Switch(name, leaves, lambda t, s, p, r: cos(2.0 * np.pi * t), to)
            for name, leaves, to in (("fall", "up", "down"), ("rise", "down", "up"))
        ],
        start={"x": 0.0},
    )


def test_one_tick_is_one_switch_though_both_regimes_watch_the_clock():
    run = toggled().simulate(5.1)
    assert labels(run.outcome).item() == "converged"
    assert run.event_time.values == pytest.approx(0.25 + np.arange(5), abs=1e-13)


def test_a_tick_at_the_very_instant_of_entry_counts_once():
    # the comparator, at 1 from the start, and the clock, at whole times, coincide at t = 1
    system = System(
        "coincidence",
        states={"x": "1"},
        parameters={"limit": 1.0},
        regimes={"on": {"speed": 1.0}, "off": {"speed": -0.5}},
        field=lambda t, s, p, r: {"x": r.speed},
        switches=[
            Switch("peak", "on", lambda t, s, p, r: p.limit - s.x, "off"),
            Switch("tick", "off", lambda t, s, p, r: -sin(2.0 * np.pi * t), "on"),
        ],
        start={"x": 0.0, "regime": "on"},
    )
    run = system.simulate(2.5)
    # on at t = 1 again, it is still at its limit: one pulse is skipped, until t = 2
    kinds, times = labels(run.event_kind).values.tolist(), run.event_time.values
    assert kinds[:4] == ["peak", "tick", "peak", "tick"]
    assert times[:4] == pytest.approx([1.0, 1.0, 1.0, 2.0], abs=1e-12)
    assert labels(run.outcome).item() == "converged"
    # started switched off at a tick, it is switched on there
    run = system.simulate(0.5, start={"regime": "off"})
    assert labels(run.event_kind).values.tolist() == ["tick"]
    assert run.event_time.values[0] == 0.0


def test_a_clock_may_kick_the_state_of_the_regime_that_it_leaves():
    kicked = System(
        "kicked",
        states={"x": "1"},
        parameters={},
        regimes={"only": {}},
        field=lambda t, s, p, r: {"x": -s.x},
        switches=[
            Switch(
                "kick",
                "only",
                lambda t, s, p, r: cos(2.0 * np.pi * t),
                "only",
                reset=lambda t, s, p, r: {"x": s.x + 1.0},
            )
        ],
        start={"x": 0.0},
        period=lambda p: 1.0,
    )
    run = kicked.simulate(10.0, times=[0.0, 10.0])
    assert run.event_time.values == pytest.approx(0.25 + np.arange(10), abs=1e-12)
    expected = np.exp(-(10.0 - run.event_time.values)).sum()
    assert run.x.values[-1] == pytest.approx(expected, rel=1e-12)
    cycle = kicked.limit_cycle()
    assert labels(cycle.outcome).item() == "converged"
    assert cycle.multiplier_real.values == pytest.approx([np.exp(-1.0)], rel=1e-9)
    top = brentq(lambda x: (x * np.exp(-1.0) + 1.0) - x, 0.0, 5.0)
    assert float(cycle.x_max) == pytest.approx(top, rel=1e-9)


def test_a_start_beyond_a_clock_waits_for_its_next_tick():
    # the clock is below zero from the start, in every regime of the second system
    run = boost().simulate(2.0 * PERIOD, t_start=0.25 * PERIOD, start={"regime": "off"})
    assert run.event_time.values[0] == pytest.approx(PERIOD, rel=1e-12)
    late = toggled().simulate(1.5, t_start=0.3)
    assert late.event_time.values == pytest.approx([1.25], abs=1e-12)


@pytest.mark.parametrize("t_start", [0.0, 0.3, 1.0])
def test_a_tick_that_only_marks_the_start_counts_too(t_start):
    marked = System(
        "marked",
        states={"x": "1"},
        parameters={},
        regimes={"only": {}},
        field=lambda t, s, p, r: {"x": -s.x},
        switches=[
            Switch("tick", "only", lambda t, s, p, r: -sin(2.0 * np.pi * t), "only")
        ],
        start={"x": 1.0},
        period=lambda p: 1.0,
    )
    run = marked.simulate(3.5, t_start=t_start)
    expected = np.arange(np.ceil(t_start), 4.0)
    assert run.event_time.values == pytest.approx(expected, abs=1e-12)
    assert labels(run.outcome).item() == "converged"
    found = marked.ensemble(3.5, t_start=t_start, start={"x": np.array([1.0, 2.0])})
    assert found.count_tick.values.tolist() == [len(expected)] * 2
