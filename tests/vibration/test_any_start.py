"""Motions are followed to where they end, also far below the present value."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from squealpipe.systems.progress import shown
from squealpipe.vibration.any_start import any_start, lead, side_by_side, sides_of
from squealpipe.vibration.boundaries import Cure
from squealpipe.vibration.settled_runs import Start

START = Start(
    subject=None,
    state=np.zeros(1),
    sliding=np.zeros(1),
    period=1.0,
    speed=1e-3,
    rate=1e-5,
    measure=float,
)


class Subjects:
    """Subjects that are their value alone; motions end in the value at which they last.

    Args:
        lasts: whether a start of a kind lasts, by the value, the kind and the state.
    """

    def __init__(self, lasts):
        self.lasts, self.run = lasts, []

    def is_quiet_linearly(self, subject):  # noqa: ARG002
        return True

    def fading(self, subject):  # noqa: ARG002
        return -np.inf

    def starts(self, subject, number, motions):
        states = motions if number == 0 else [np.zeros(1)]
        return [replace(START, subject=(subject, number), state=s) for s in states]

    def settle(self, starts):
        self.run += [start.subject for start in starts]
        return [
            SimpleNamespace(
                lasts=self.lasts(*start.subject, float(start.state[0])),
                last=SimpleNamespace(final=np.array([start.subject[0]])),
            )
            for start in starts
        ]


@pytest.mark.parametrize("fold", [0.0213, 0.0041])
def test_a_motion_that_lasts_far_beyond_is_followed_to_its_fold(fold):
    """It dies out if its value changes by a tenth at once, and no other start finds it."""
    below = 0.4 * np.geomspace(1.0, 1e-3, 60)[1:]
    cure = Cure(0.4, lambda value: value, below, np.zeros(0))
    (side,) = sides_of({"mu": cure})
    # led already to the quiet value
    side.motions = [np.array([0.0226])]

    def lasts(value, number, last):
        return number == 0 and value > fold and abs(value - last) < 0.1 * last

    quiet_from = {"mu": 0.0225}
    found = any_start(
        {"mu": cure}, [side], quiet_from, Subjects(lasts), quiet=False, always=False
    )
    assert 0.989 * fold < found["mu"] <= fold


@pytest.mark.parametrize("lasting", [1.0, 0.02])
def test_a_boundary_before_the_first_value_is_reached_from_any_start(lasting):
    """A brake that was quiet up to 5 % more stiffness was said to be so "unless struck"."""
    cures = {
        "contact_stiffness": Cure(
            1.0, lambda value: value, np.zeros(0), np.array([1.12, 1.25])
        )
    }
    found = any_start(
        cures,
        sides_of(cures),
        {"contact_stiffness": 1.05},
        Subjects(lambda value, *_: value >= 1.0 + lasting),
        quiet=True,
        always=True,
    )
    expected = min(1.05, 1.0 + lasting)
    assert found["contact_stiffness"] == pytest.approx(expected, rel=1e-2)


@pytest.mark.parametrize("above", [1.31, 1.7, np.inf])
def test_the_nearer_of_both_ends_is_found_and_no_start_is_run_twice(above):
    """Strikes last below 0.6 and above some value; nothing is looked at beyond the nearer."""
    cures = {
        name: Cure(
            1.0,
            lambda value, factor=factor: factor * value,
            1.0 / np.geomspace(1.0, 10.0, 30)[1:],
            np.geomspace(1.0, 10.0, 30)[1:],
        )
        for name, factor in (("one", 1.0), ("other", -1.0))
    }

    def lasts(value, number, _):
        ends = (0.6, above) if value > 0.0 else (-np.inf, np.inf)
        return number == 2 and not ends[0] < value < ends[1]

    subjects, shares = Subjects(lasts), []
    with shown(shares.append):
        found = any_start(cures, sides_of(cures), {}, subjects, quiet=True, always=True)
    assert shares == sorted(shares)
    assert len(shares) > 5
    assert shares[0] < 0.1
    assert shares[-1] == 1.0
    assert list(found) == ["one"]
    nearer = 0.6 if above - 1.0 > 0.4 else above
    assert found["one"] == pytest.approx(nearer, rel=1.1e-2)
    own = [run for run in subjects.run if run[1] > 0]
    assert len(set(own)) == len(own)
    looked_at = {value for value, _ in own if value > 0.0}
    assert max(looked_at) < 1.0 + 3.5 * abs(nearer - 1.0)


def test_a_motion_is_not_led_to_where_there_is_no_steady_sliding():
    """Friction may jam just before the quiet value: an assessment ended in StopIteration."""
    quiet_from = {"jams": 0.6, "slides": 0.8}
    cures = {
        name: Cure(1.0, lambda value: value, np.array([0.5]), np.zeros(0))
        for name in quiet_from
    }
    sides = sides_of(cures)
    for side in sides:
        side.motions = [np.array([1.0])]

    class Jamming(Subjects):
        def starts(self, subject, number, motions):
            return [] if subject < 0.7 else super().starts(subject, number, motions)

        def settle(self, starts):
            last = SimpleNamespace(final=np.array([2.0]))
            return [SimpleNamespace(lasts=True, last=last) for _ in starts]

    subjects = Jamming(lambda *_: True)
    searches = [lead(side, quiet_from[side.name], subjects) for side in sides]
    side_by_side(searches, subjects.settle)
    assert [float(side.motions[0][0]) for side in sides] == [1.0, 2.0]
