"""Resets by the regime entered, markers, runs that begin late, and what makes no progress."""

import numpy as np
import pytest

from squealpipe import Component, Switch, System, labels
from squealpipe.functions import cos, sin
from squealpipe.schema import Outcome


def landing(**options):
    """A ball that bounces while it is fast and stays where it lands slowly."""
    return System(
        "landing",
        states={"x": "m", "v": "m/s"},
        parameters={"restitution": 0.5, "fast": 1.5},
        regimes={"flies": {"free": 1.0}, "rests": {"free": 0.0}},
        field=lambda t, s, p, r: {"x": r.free * s.v, "v": -1.0 * r.free},
        switches=[
            Switch(
                "land",
                "flies",
                lambda t, s, p, r: s.x,
                to=[("flies", lambda t, s, p, r: -s.v - p.fast, "bounce"), "rests"],
                reset={
                    "flies": lambda t, s, p, r: {"v": -p.restitution * s.v},
                    "rests": lambda t, s, p, r: {"x": 0.0, "v": 0.0},
                },
            )
        ],
        start={"x": 2.0, "v": 0.0, "regime": "flies"},
        **options,
    )


def test_a_reset_depends_on_the_regime_entered():
    run = landing().simulate(6.0, sensitivity=["restitution", "fast"])
    assert list(labels(run.event_kind).values) == ["bounce", "land"]
    # it falls for 2, bounces at speed 2 · 0.5, and lands after 2 more
    np.testing.assert_allclose(run.event_time, [2.0, 4.0], rtol=1e-14)
    assert float(run.x[-1]) == float(run.v[-1]) == 0.0
    np.testing.assert_allclose(run.event_time_by_restitution, [0.0, 4.0], atol=1e-13)
    np.testing.assert_array_equal(run.event_time_by_fast, 0.0)


def test_a_perturbation_takes_the_reset_of_the_regime_entered():
    run = landing().ensemble(3.0, horizon=True)
    # an impact turns (δx, δv) into (−e δx, −e δv + (1 + e) δx / 2) at the speed of 2
    early = np.array([[1.0, 2.0], [0.0, 1.0]]) @ [1.0, 1.0] / np.sqrt(2.0)
    after = np.array([[-0.5, 0.0], [0.75, -0.5]]) @ early
    late = np.array([[1.0, 1.0], [0.0, 1.0]]) @ after
    growth = np.log(np.hypot(*late))
    assert 3.0 * float(run.lyapunov_exponent) == pytest.approx(growth, rel=1e-12)
    rests = landing().ensemble(6.0, horizon=True)
    assert np.isneginf(rests.lyapunov_exponent)


def test_a_reset_into_a_regime_that_is_not_entered_is_refused():
    with pytest.raises(ValueError, match="does not lead to regime 'b'"):
        System(
            "wrong",
            states={"x": "1"},
            parameters={},
            regimes={"a": {}, "b": {}},
            field=lambda t, s, p, r: {"x": 1.0},
            switches=[
                Switch(
                    "turn",
                    "a",
                    lambda t, s, p, r: 1.0 - s.x,
                    "a",
                    {"b": lambda t, s, p, r: {"x": 0.0}},
                )
            ],
            start={"x": 0.0},
        )


def test_resets_of_components_go_by_their_own_regimes():
    def ball(name):
        return Component(
            {"flies": {"free": 1.0}, "rests": {"free": 0.0}},
            [
                Switch(
                    "land",
                    "flies",
                    lambda t, s, p, r: getattr(s, f"x{name}"),
                    to=[
                        ("flies", lambda t, s, p, r: -getattr(s, f"v{name}") - 1.5),
                        "rests",
                    ],
                    reset={
                        "flies": lambda t, s, p, r: {
                            f"v{name}": -0.5 * getattr(s, f"v{name}")
                        },
                        "rests": lambda t, s, p, r: {f"v{name}": 0.0},
                    },
                )
            ],
            ["flies"],
        )

    balls = System(
        "two balls",
        states=dict.fromkeys(("x1", "v1", "x2", "v2"), "1"),
        parameters={},
        components={"one": ball(1), "two": ball(2)},
        field=lambda t, s, p, r: {
            "x1": r.one.free * s.v1,
            "v1": -1.0 * r.one.free,
            "x2": r.two.free * s.v2,
            "v2": -1.0 * r.two.free,
        },
        start={"x1": 2.0, "v1": 0.0, "x2": 0.125, "v2": 0.0},
    )
    run = balls.simulate(5.0)
    np.testing.assert_allclose(run.event_time, [0.5, 2.0, 4.0], rtol=1e-14)
    assert float(run.v1[-1]) == float(run.v2[-1]) == 0.0


def test_a_marker_changes_nothing_and_counts_what_falls():
    swing = System(
        "swing",
        states={"x": "1", "v": "1"},
        parameters={"level": 0.25},
        regimes={"all": {}},
        field=lambda t, s, p, r: {"x": s.v, "v": -s.x},
        switches=[Switch("pass", "all", lambda t, s, p, r: s.x - p.level, "all")],
        start={"x": 1.0, "v": 0.0},
    )
    run = swing.simulate(20.0)
    assert run.outcome == Outcome.converged
    exact = np.arccos(0.25) + 2.0 * np.pi * np.arange(3)
    np.testing.assert_allclose(run.event_time, exact, rtol=1e-13)
    np.testing.assert_allclose(run.x, np.cos(run.time), atol=1e-12)
    # a start below the level is no crossing, nor is one at it that falls
    for x, v, first in ((0.0, 1.0, np.pi - np.arcsin(0.25)), (0.25, -1.0, None)):
        start = {"x": x, "v": v}
        times = swing.simulate(6.0, start=start).event_time.values
        assert times[:1] == pytest.approx([] if first is None else [first], rel=1e-12)
    bunch = swing.ensemble(20.0, level=np.array([-0.5, 0.0, 0.5, 2.0]), horizon=True)
    np.testing.assert_array_equal(bunch.count_pass, [3, 3, 4, 0])


forced = System(
    "forced",
    states={"x": "1", "v": "1"},
    parameters={"omega": 1.3, "force": 1.0},
    regimes={"up": {"side": 1.0}, "down": {"side": -1.0}},
    field=lambda t, s, p, r: {"x": s.v, "v": p.force * cos(p.omega * t) + r.side - s.x},
    switches=[
        Switch("falls", "up", lambda t, s, p, r: sin(0.7 * t), "down"),
        Switch("rises", "down", lambda t, s, p, r: -sin(0.7 * t), "up"),
    ],
    start={"x": 0.3, "v": 0.0},
    time_scale=0.5,
)


def test_a_run_that_begins_late_goes_on_where_another_ended():
    whole = forced.simulate(20.0, sensitivity=["force"])
    first = forced.simulate(7.0)
    state = {name: float(first[name][-1]) for name in ("x", "v")}
    rest = forced.simulate(20.0, t_start=7.0, start=state, sensitivity=["x0", "v0"])
    assert float(rest.time[0]) == 7.0
    later = whole.event_time > 7.0
    np.testing.assert_allclose(rest.event_time, whole.event_time[later], rtol=1e-13)
    np.testing.assert_allclose(rest.x[-1], whole.x[-1], atol=1e-11)
    # without force by the state both directions turn as free motion does
    turned = [[np.cos(13.0), np.sin(13.0)], [-np.sin(13.0), np.cos(13.0)]]
    ours = [[float(rest[f"{a}_by_{b}0"][-1]) for b in "xv"] for a in "xv"]
    np.testing.assert_allclose(ours, turned, atol=1e-11)
    many = forced.ensemble(20.0, t_start=7.0, start=state, force=np.array([1.0, 2.0]))
    assert float(many.x[0]) == pytest.approx(float(whole.x[-1]), abs=1e-11)
    falls = np.pi / 0.7 * np.arange(1, 9, 2)
    first_fall = falls[falls > 7.0][0]
    assert float(many.first_falls[0]) == pytest.approx(first_fall, rel=1e-13)
    # 0.9 − 0.2 + 0.2 is below 0.9
    short = forced.simulate(0.9, t_start=0.2, sensitivity=["x0"])
    assert float(short.end_time) == 0.9
    assert np.isfinite(short.x_by_x0[-1])
    before = forced.simulate(2.0, t_start=-3.0)
    assert float(before.time[0]) == -3.0
    np.testing.assert_allclose(before.event_time, [0.0], atol=1e-13)


def test_a_run_does_not_end_before_it_begins():
    with pytest.raises(ValueError, match="a time not before 3"):
        forced.simulate(2.0, t_start=3.0)


@pytest.mark.parametrize(
    ("level", "to"), [(-10.0, -5.0), (500.0, 505.0), (-1e4, -9.9e3)]
)
def test_a_sawtooth_far_from_zero_makes_progress(level, to):
    saw = System(
        "saw",
        states={"x": "1"},
        parameters={},
        regimes={"falls": {}},
        field=lambda t, s, p, r: {"x": -1.0},
        switches=[
            Switch(
                "jump",
                "falls",
                lambda t, s, p, r: s.x - level,
                "falls",
                lambda t, s, p, r: {"x": to},
            )
        ],
        start={"x": to},
    )
    run = saw.simulate(3.5 * (to - level))
    exact = (to - level) * np.arange(1, 4)
    np.testing.assert_allclose(run.event_time, exact, rtol=1e-12)
