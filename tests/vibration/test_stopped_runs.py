"""Runs that are stopped before all have settled: what is known by then is kept."""

from types import SimpleNamespace

import numpy as np
import pytest

from squealpipe.codes import Verdict
from squealpipe.systems.progress import ask_to_stop
from squealpipe.vibration.settled_runs import Horizon, Start, settle
from squealpipe.vibration.settling import settling_of_verdicts


def start():
    return Start(
        subject=None,
        state=np.zeros(2),
        sliding=None,
        period=1.0,
        speed=1.0,
        rate=1.0,
        measure=lambda _: 0.0,
    )


def test_a_stop_keeps_the_windows_that_have_ended_and_runs_no_more():
    turns = []

    def advance(rows, _states, _begun, _seconds, turn):
        turns.append(turn)
        window = SimpleNamespace(
            final=np.zeros(2), regimes=np.zeros(1, int), finished=True, fades=False
        )
        return SimpleNamespace(
            regimes=np.zeros((len(rows), 1), int), row=lambda _: window
        )

    horizon = Horizon(np.ones(3), np.ones(3), np.full(3, 1e3), growth_windows=1)
    starts = [start() for _ in range(3)]
    try:
        runs = settle(
            starts,
            advance,
            horizon,
            settling_of_verdicts,
            told=lambda *_: ask_to_stop(),
        )
        assert turns == [0]
        assert [run.verdict for run in runs] == [Verdict.undetermined] * 3
        assert all(len(run.windows) == 1 for run in runs)
        with pytest.raises(
            KeyboardInterrupt
        ):  # there is nothing yet that could be kept
            settle(starts, advance, horizon, settling_of_verdicts)
    finally:
        ask_to_stop(stops=False)
