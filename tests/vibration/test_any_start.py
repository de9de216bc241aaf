"""Motions are followed to where they end, also far below the present value."""

from types import SimpleNamespace

import numpy as np
import pytest

from squealpipe.vibration.any_start import any_start, lead, sides_of
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


@pytest.mark.parametrize("fold", [0.0213, 0.0041])
def test_a_motion_that_lasts_far_beyond_is_followed_to_its_fold(fold):
    """It dies out if its value changes by a tenth at once, and no other start finds it."""
    below = 0.4 * np.geomspace(1.0, 1e-3, 60)[1:]
    cure = Cure(0.4, lambda value: value, below, np.zeros(0))
    (side,) = sides_of({"mu": cure})
    side.motions = [np.array([0.0226])]

    def dies_out(sides, values):
        found = []
        for each, value in zip(sides, values, strict=True):
            last = float(each.motions[0][0])
            lasts = value > fold and abs(value - last) < 0.1 * last
            if lasts:
                each.motions = [np.array([value])]
            found.append(not lasts)
        return found

    quiet_from = {"mu": 0.0225}
    found = any_start(
        {"mu": cure}, [side], quiet_from, False, False, None, dies_out, dies_out
    )
    assert 0.989 * fold < found["mu"] <= fold


@pytest.mark.parametrize("lasting", [1.0, 0.02])
def test_a_boundary_before_the_first_value_is_reached_from_any_start(lasting):
    """A brake that was quiet up to 5 % more stiffness was said to be so "unless struck"."""
    cure = Cure(1.0, lambda value: value, np.zeros(0), np.array([1.12, 1.25]))

    def dies_out(sides, values):
        return [value < 1.0 + lasting for value in values]

    quiet_from = {"contact_stiffness": 1.05}
    sides = sides_of({"contact_stiffness": cure})
    found = any_start(
        {"contact_stiffness": cure},
        sides,
        quiet_from,
        True,
        True,
        None,
        dies_out,
        dies_out,
    )
    expected = min(1.05, 1.0 + lasting)
    assert found["contact_stiffness"] == pytest.approx(expected, rel=1e-2)


def test_a_motion_is_not_led_to_where_there_is_no_steady_sliding():
    """Friction may jam just before the quiet value: an assessment ended in StopIteration."""
    motion = np.array([1.0])
    cures = {
        name: Cure(1.0, lambda value: value, np.array([0.5]), np.zeros(0))
        for name in ("jams", "slides")
    }
    sides = sides_of(cures)
    for side in sides:
        side.motions = [motion]

    class Subjects:
        def starts(self, subject, number, motions):  # noqa: ARG002
            return [] if subject < 0.7 else [START]

        def settle(self, starts):
            last = SimpleNamespace(final=np.array([2.0]))
            return [SimpleNamespace(lasts=True, last=last) for _ in starts]

    lead(sides, {"jams": 0.6, "slides": 0.8}, Subjects())
    assert [float(side.motions[0][0]) for side in sides] == [1.0, 2.0]
