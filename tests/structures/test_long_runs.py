"""Long runs of a structure: their estimate, partial answers, and an end that is asked for."""

import contextlib
from dataclasses import replace

import numpy as np
import pytest

from squealpipe import squealing_modes
from squealpipe.codes import Verdict
from squealpipe.structures import elastic_pad
from squealpipe.structures.squeal import settling
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.settling import GROWTH, times_of
from squealpipe.structures.squeal.windows import Running, run_windows
from squealpipe.study.report.squealing import lines
from squealpipe.systems.progress import ask_to_stop, shown
from tests.structures.test_squealing import two_modes


def test_a_window_in_pieces_has_the_statistics_of_one():
    plant = Plant(two_modes(1.0))
    start = plant.pushed(int(plant.unstable[0]), 0.01)[None]
    begun = run_windows(plant, start, 0.1, Running(1e-12, workers=1))
    lengths = np.array([0.02])
    whole, cut = (
        run_windows(plant, begun.final, lengths, how, begun.regimes)
        for how in (
            Running(1e-12, workers=1),
            # eight pieces of five seconds each, if a second of motion took 2000
            Running(1e-12, workers=1, cost=2000.0),
        )
    )
    for name, value in vars(whole).items():
        if name not in ("growth", "late_growth", "steps"):
            pieces = np.asarray(getattr(cut, name), float)
            assert np.asarray(value, float) == pytest.approx(pieces, rel=1e-7, abs=1e-9)


@contextlib.contextmanager
def stop_after(number):
    """Ask for an end with the partial answer of this number; yield all of them."""
    told = []

    def say(line):
        told.append(line)
        if len(told) == number:
            ask_to_stop()

    try:
        with shown(None, say):
            yield told
    finally:
        ask_to_stop(stops=False)


@pytest.fixture
def all_are_long(monkeypatch):
    """Runs of any length are treated as long ones, two starts at a time."""
    rules = replace(settling.RunLengths(), long=0.0, side_by_side=2)
    monkeypatch.setattr(settling, "RunLengths", rules)


def test_long_runs_say_how_long_and_answer_a_few_starts_at_a_time(all_are_long):
    with stop_after(None) as told:
        whole = squealing_modes(two_modes(1.0), samples=5, workers=1)
    assert told[0].startswith("runs of 6 starts in 2 modes: about ")
    assert told[0].endswith("s; shorter with fewer samples")
    assert any("2 of 6 starts have settled (2 near 2.76 kHz" in line for line in told)
    assert any("6 of 6 starts have settled" in line for line in told)
    assert "interrupted" not in whole.attrs


def test_an_end_that_is_asked_for_keeps_what_has_settled(all_are_long):
    # the estimate, three windows of the first two starts, one of the next two
    with stop_after(5):
        part = squealing_modes(two_modes(1.0), samples=5, workers=1)
    assert part.ends_at.values.tolist() == [0, -1, -1, -1, -1]
    assert part.settled_by.values[-1] == 0.0
    assert "2 of 6 starts have settled (2 near 2.76 kHz" in part.attrs["interrupted"]
    # its kind would have taken seven runs more
    assert Verdict(int(part.verdict)) is Verdict.undetermined
    assert float(part.dominant_frequency[0]) == pytest.approx(2.08e3, rel=0.05)
    assert float(part.share_undetermined) == pytest.approx(0.8)


def test_where_nothing_has_settled_an_end_shows_what_moves(all_are_long):
    with stop_after(2):
        part = squealing_modes(two_modes(1.0), samples=3, workers=1)
    assert part.sizes["attractor"] == 0
    assert Verdict(int(part.verdict)) is Verdict.undetermined
    assert "2 not settled, near 2.76 kHz" in part.attrs["interrupted"]
    assert "Undetermined" in lines(part)[0]


def test_a_push_waits_for_its_own_mode_and_modes_beyond_the_band_are_not_pushed():
    pad = elastic_pad(modal_damping=0.01)
    both = Plant(pad.reduce(n_modes=12))
    growth = both.spectrum.values.real[both.asked]
    assert both.asked.tolist() == both.unstable.tolist()
    assert len(growth) == 2
    assert growth[0] > growth[1]
    waits, shortest, longest, _ = times_of(both, growth, None)
    # in 0.01 s the lower mode has 97 periods
    assert longest == pytest.approx(100.0 / both.frequencies[both.asked].min())
    assert waits == pytest.approx(np.maximum(GROWTH / growth, longest))
    assert shortest == pytest.approx(0.25 * longest)
    both.band = 2.0 * np.pi * 20e3
    assert both.frequencies[both.asked] == pytest.approx([9.6e3], rel=0.02)
    # where none within it grows the fastest beyond tells what the motion is
    both.band = 2.0 * np.pi * 1e3
    assert both.asked.tolist() == both.unstable[:1].tolist()
