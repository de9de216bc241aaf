"""Verdicts on chaotic motions: the same from starts, and on processors, that nobody tells apart."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from squealpipe.paper.claims.evidence import passes
from squealpipe.paper.inference.candidates import sets_of
from squealpipe.paper.inference.constraints import (
    SeveralStarts,
    StatementMargin,
    compared_near_the_threshold,
    from_several_starts,
    registered_constraints,
    verdicts,
)
from squealpipe.paper.inference.inference import FULLY_JUDGED, _sample
from squealpipe.paper.schema.growth import growth_margin
from squealpipe.paper.schema.inference import Holds, parameter_inference_schema
from squealpipe.parameters import SCENES
from squealpipe.schema import Outcome
from squealpipe.store.comparison.differences import Agreement, judge

RANGES = {
    "kappa": (0.3, 1.3),
    "mu": (0.02, 0.8),
    "length_ratio": (2.0, 100.0),
    "speed_ratio": (0.1, 316.0),
}
CHECKS = {constraint.name: constraint.check for constraint in registered_constraints}


def candidates(*rows):
    groups = dict(zip(RANGES, np.array(rows).T, strict=True))
    sets = sets_of(groups, tol=1e-9, workers=1).read("as_printed")
    return replace(sets, exact=False)


CHAOTIC = (0.496819139, 0.0312182139, 21.6394175, 0.186224365)
"""Of the samples of the study: whether |x| grows to t = 6000 depends on the last digit."""
STUDY = (0.65, 0.3, 15.0, 100.0)


def test_growth_that_depends_on_the_last_digit_is_undecided():
    """Single runs from ten starts 1e-9 l_pre apart say both; the study's own parameters grow."""
    many = candidates(*[CHAOTIC] * 10)
    states = 1e-9 * np.random.default_rng(3).uniform(-1.0, 1.0, (10, 4))
    sizes, _ = replace(many, initial_state=states).windows(SCENES["F3"])
    assert len({*(growth_margin(sizes) > 0.0)}) == 2
    found = CHECKS["F3"](candidates(CHAOTIC, STUDY))
    assert verdicts(found).tolist() == [Holds.undecided, Holds.yes]


def test_half_of_the_last_window_tells_growth_as_all_of_it_does():
    """Where it does not tell it, or the margin counts, the last window is run to its end."""
    generator = np.random.default_rng(6)
    little_friction = STUDY[0], 0.03, *STUDY[2:]
    around = np.array(STUDY) * generator.uniform(0.5, 1.5, (8, 4))
    some = candidates(*around, little_friction)
    sizes, outcome = some.windows(SCENES["F3"])
    whole, ends = replace(some, exact=True).windows(SCENES["F3"])
    grows = growth_margin(whole) > 0.0
    assert 0 < grows.sum() < grows.size
    np.testing.assert_array_equal(growth_margin(sizes) > 0.0, grows)
    np.testing.assert_array_equal(sizes[grows, :-1], whole[grows, :-1])
    assert (sizes[grows, -1] < whole[grows, -1]).all()
    np.testing.assert_array_equal(outcome[grows], ends[grows])


def test_a_margin_of_zero_holds_no_more_than_a_force_of_zero_is_above_zero():
    margins = np.array([1e-300, 0.0, -1e-300, np.nan])
    found = StatementMargin(margins, np.full(4, int(Outcome.converged)))
    expected = [Holds.yes, Holds.no, Holds.no, Holds.undecided]
    assert verdicts(found).tolist() == expected
    for margin, verdict in zip(margins[:3], expected[:3], strict=True):
        assert passes(margin, ">", 0.0) is (verdict == Holds.yes)
    ended = StatementMargin(np.ones(1), np.array([int(Outcome.step_limit)]))
    assert verdicts(ended).tolist() == [Holds.undecided]


@pytest.mark.release
def test_starts_that_differ_by_a_thousandth_of_that_leave_verdicts():
    """As another processor's last bits do: sets around the study's, motions of F3 and F4."""
    generator = np.random.default_rng(5)
    some = candidates(*(np.array(STUDY) * generator.uniform(0.8, 1.2, (16, 4))))
    moved = some.moved(1e-12, -1e-12)
    for name in ("F3", "F4"):
        one, other = (verdicts(CHECKS[name](each)) for each in (some, moved))
        np.testing.assert_array_equal(one, other)


def counted(margins):
    """A check whose margin depends on how far right it starts, and the sets that it was asked."""
    asked = []

    def check(sets):
        asked.append(sets.size)
        state = np.broadcast_to(sets.initial_state, (sets.size, 4))
        margin = np.array(
            [
                margins[int(k)](x)
                for k, x in zip(sets.fields["mu"], state[:, 0], strict=True)
            ]
        )
        return StatementMargin(margin, np.zeros(sets.size, np.int8))

    return check, asked


def test_more_starts_are_asked_where_two_disagree_only():
    """Regular, chaotic without reaching the threshold, chaotic across it, in this order."""
    margins = (
        lambda _: 0.2,
        lambda x: 0.2 + 0.1 * np.sign(x),
        lambda x: -0.1 + 0.2 * (x > 0),
    )
    sets = replace(candidates(*[STUDY] * 3), initial_state=np.zeros((3, 4)))
    sets.fields["mu"][:] = [0, 1, 2]
    check, asked = counted(margins)
    found = verdicts(from_several_starts(check)(sets))
    assert found.tolist() == [Holds.yes, Holds.yes, Holds.undecided]
    # the second start of the third one disagrees already
    assert asked == [6, len(SeveralStarts.directions) - 1]
    check, asked = counted(margins)
    sampled = replace(sets, sampled=True)
    assert verdicts(from_several_starts(check)(sampled)).tolist() == [1, 1, 0]
    assert asked == [3]


@pytest.mark.parametrize(("distance", "verdict"), [(1e-3, 1), (1e-10, 2)])
def test_a_regular_motion_is_compared_at_its_threshold(distance, verdict):
    check, asked = counted([lambda x: distance + x])
    sets = replace(candidates(STUDY), initial_state=np.zeros(4))
    sets.fields["mu"][:] = 0
    assert verdicts(compared_near_the_threshold(check)(sets)).tolist() == [verdict]
    assert asked == ([1] if verdict == 1 else [1, len(SeveralStarts.directions)])


def test_samples_do_not_depend_on_the_last_bit_of_exp():
    """Nine digits: exp of NumPy differs by a bit between processors with and without AVX-512."""
    groups = _sample(512, 2021, RANGES)
    for name, values in groups.items():
        assert [
            float(f"{v:.9g}") for v in np.nextafter(values, 0.0)
        ] == values.tolist(), name


def test_samples_that_are_judged_further_cover_the_ranges():
    """Of every eighth point of Halton's all κ lay within an eighth of its range."""
    groups = _sample(4096, 2021, RANGES)
    first = slice(int(FULLY_JUDGED * 4096))
    for name, (low, high) in RANGES.items():
        scale = np.log if low > 1.0 or high > 300 else np.asarray
        shares = np.histogram(scale(groups[name][first]), 8, tuple(scale([low, high])))[
            0
        ]
        assert abs(shares - 32).max() <= 4, name


def test_what_one_side_did_not_judge_is_no_difference():
    """A verdict that differs is one; what follows from it, that others were not judged, is not."""
    entry = parameter_inference_schema.variables["holds"]
    one = xr.Dataset({"holds": ("sample", np.array([1, 0, 3, 1], np.int8))})
    other = xr.Dataset({"holds": ("sample", np.array([1, 0, 1, 3], np.int8))})
    assert judge("holds", one, other, entry).verdict == Agreement.equal
    other.holds[0] = Holds.undecided
    found = judge("holds", one, other, entry)
    assert found.verdict == Agreement.different
    assert sum(found.flips.values()) == 1
