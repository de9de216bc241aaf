"""When a start has settled, and on what, by windows whose statistics are written down."""

from dataclasses import replace

import numpy as np
import pytest

from squealpipe.codes import Verdict
from squealpipe.systems.progress import shown
from squealpipe.vibration.settled_runs import Horizon, SettledRun, Start, settle
from squealpipe.vibration.settling import settling_of_verdicts
from squealpipe.vibration.windows import Windows

START = Start(
    subject=None,
    state=np.zeros(2),
    sliding=np.zeros(2),
    period=1.0,
    speed=1e-3,
    rate=0.1,
    measure=lambda _: 1.0,
)


def window(velocities, length=1.0, *, losses=5, switched=True):
    """One run whose contact is lost five times, for a fifth of the time, or as often as given."""
    one, two = np.ones((1, 1)), np.array([velocities])
    return Windows(
        final=np.zeros((1, 2)),
        regimes=np.zeros((1, 1), int),
        velocities=two,
        largest_velocity=two.max(axis=1),
        separated=(0.2 if losses else 0.0) * one,
        stuck=0.0 * one,
        separations=losses * one,
        forces=one,
        switched=np.array([switched]),
        finished=np.array([True]),
        length=np.array([length]),
        growth=np.array([np.nan]),
        late_growth=np.array([np.nan]),
        fades=np.array([False]),
    )


def merged(parts):
    """The mean of windows of equal length."""
    values = {
        name: np.mean([getattr(part, name) for part in parts], axis=0)
        for name in vars(parts[-1])
    }
    return Windows(**{**values, "length": sum(part.length for part in parts)})


def settled(velocities_of_turns, length_of_known=1.0, **horizon):
    """Settle a start whose windows have these velocities, beside a known motion."""
    turns = []

    def advance(_rows, _states, _begun, seconds, turn):
        turns.append(turn)
        return window(velocities_of_turns(turn), seconds[0])

    last = window([1.0, 0.01], length_of_known).row(0)
    lengths = Horizon(np.ones(1), np.ones(1), np.full(1, 100.0), **horizon)
    (run,) = settle(
        [START],
        advance,
        lengths,
        settling_of_verdicts,
        known=[SettledRun(Verdict.hammers, last, 10.0)],
        merged=merged,
    )
    return run, len(turns)


@pytest.mark.parametrize(
    ("velocities", "windows"),
    [
        # louder by 2 %: that motion after one window, and not compared with the next
        ([1.02, 0.01], 2),
        # 10 % louder, or a component that has yet to grow or to decay: by its own two windows
        ([1.10, 0.01], 3),
        ([1.0, 0.005], 3),
        ([1.0, 0.02], 3),
    ],
)
def test_one_window_shows_that_a_start_has_come_to_a_known_motion(velocities, windows):
    def of(turn):
        return velocities if turn else [0.1, 0.01]

    run, count = settled(of, growth_windows=1)
    assert run.verdict is Verdict.hammers
    assert count == windows
    assert run.arrived == (windows == 2)


def test_last_windows_together_show_it_before_a_push_has_grown_for_its_time():
    """Windows that swing by 8 % about the known motion agree with it by their mean alone."""

    def of(turn):
        return [0.1, 0.1] if turn < 5 else [1.08 if turn % 2 else 0.92, 0.01]

    run, count = settled(of, growth_windows=50, length_of_known=4.0)
    assert run.arrived
    assert count == 7  # the two after those of the transient
    assert run.last.length == 2.0
    # beside a shorter known motion no two windows are merged: they settle by themselves
    run, count = settled(of, growth_windows=10, length_of_known=1.0)
    assert not run.arrived


STEADY = {"losses": 0, "switched": False}
LOUD = [1.0, 0.01]


@pytest.mark.parametrize(
    ("rate", "windows", "count", "verdict"),
    [
        (0.1, lambda _: window(LOUD), 2, Verdict.hammers),
        # a single loss may be the last one of a transient; it comes back in the third window
        (0.1, lambda turn: window(LOUD, losses=5 if turn else 1), 3, Verdict.hammers),
        (0.1, lambda _: window(LOUD, losses=0), 2, Verdict.squeals),
        # e^½ of growth or decay is seen in a window of 8 units at 1/16, and in no shorter one
        (1 / 16, lambda turn: window(LOUD, 2.0**turn, **STEADY), 4, Verdict.squeals),
        (0.0, lambda _: window(LOUD, **STEADY), 2, Verdict.squeals),
        # a decay that no run shows: small is up to 10 times the push, 1e-2 here
        (0.0, lambda _: window([9e-3, 0.0], **STEADY), 2, Verdict.quiet),
        # where decay is known, what is small but not a tenth of the push has to show a part of it
        (
            -1.0,
            lambda turn: window([2e-3 * 0.5**turn, 0.0], **STEADY),
            2,
            Verdict.quiet,
        ),
        (-1.0, lambda _: window([2e-3, 0.0], **STEADY), 2, Verdict.squeals),
    ],
)
def test_a_start_has_settled_when_two_windows_show_the_same(
    rate, windows, count, verdict
):
    turns = []

    def advance(_rows, _states, _begun, _seconds, turn):
        turns.append(turn)
        return windows(turn)

    lengths = Horizon(np.ones(1), np.ones(1), np.full(1, 1e3))
    start = replace(START, rate=rate)
    (run,) = settle([start], advance, lengths, settling_of_verdicts)
    assert (run.verdict, len(turns)) == (verdict, count)


def test_the_time_left_is_told_as_if_the_next_window_were_the_last():
    """As a share of the longest time it was told as hours where a minute was left."""
    shares = []
    lengths = Horizon(np.ones(1), np.ones(1), np.full(1, 1e3))
    windows = (window(LOUD, 2.0**turn, **STEADY) for turn in range(10))
    with shown(shares.append):
        settle(
            [replace(START, rate=1 / 16)],
            lambda *_: next(windows),
            lengths,
            settling_of_verdicts,
            told=lambda *_: None,
        )
    assert shares == [0.0, 0.5, 0.5, 0.5]


def test_a_motion_that_is_led_waits_for_no_slow_growth():
    """Beside a boundary each value that a motion was led to cost it 10,000 periods."""
    rate = 1e-5
    slow = replace(START, rate=rate)
    led = replace(slow, is_led=True)
    horizon = Horizon.of([replace(START, rate=0.5 / 400.0), slow, led], 20_000.0)
    # ½ over the rate, as long as that is no more than a quarter of the longest run
    np.testing.assert_allclose(horizon.first, [400.0, 5000.0, 50.0])
