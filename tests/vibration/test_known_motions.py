"""A start with the statistics of a motion that is known to be irregular has come to it."""

import numpy as np
import pytest

from squealpipe.codes import Verdict
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


def window(velocities, length=1.0):
    """One run whose contact is lost five times, for a fifth of the time."""
    one, two = np.ones((1, 1)), np.array([velocities])
    return Windows(
        final=np.zeros((1, 2)),
        regimes=np.zeros((1, 1), int),
        velocities=two,
        largest_velocity=two.max(axis=1),
        separated=0.2 * one,
        stuck=0.0 * one,
        separations=5.0 * one,
        forces=one,
        switched=np.array([True]),
        finished=np.array([True]),
        length=np.array([length]),
        growth=np.array([np.nan]),
        late_growth=np.array([np.nan]),
    )


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
    turns = []

    def advance(_rows, _states, _begun, seconds, turn):
        turns.append(turn)
        # what the push grows through agrees with the known motion, and is not looked at
        return window(velocities if turn else [1.0, 0.01], seconds[0])

    known = SettledRun(Verdict.hammers, window([1.0, 0.01]).row(0), 10.0)
    lengths = Horizon(np.ones(1), np.ones(1), np.full(1, 100.0), grows_first=True)
    (run,) = settle([START], advance, lengths, settling_of_verdicts, known=[known])
    assert run.verdict is Verdict.hammers
    assert len(turns) == windows
