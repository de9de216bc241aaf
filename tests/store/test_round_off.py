"""What round-off decides: where only digits differ two datasets agree, and no further."""

import numpy as np
import pytest
import xarray as xr

from squealpipe import cycle_branch, hammering_map, limit_cycle, simulate
from squealpipe.parameters import SCENES
from squealpipe.schema import Outcome, Variable, all_schemas
from squealpipe.store.comparison.compare import compare_datasets
from squealpipe.store.comparison.differences import Agreement, judge
from squealpipe.systems.branch_labels import Label
from squealpipe.systems.datasets.agreement import ComparedAs, RoundOff
from tests.former import FORMER


def rounded(a, b, how, **entry):
    """Agreement on one variable whose digits round-off decides."""
    dims = ("group", "sample") if how.sample else ("t",)
    sides = [xr.Dataset({"x": (dims, np.asarray(side, float))}) for side in (a, b)]
    return judge(
        "x", *sides, Variable(dims=dims, nan_allowed=True, round_off=how, **entry)
    )


@pytest.mark.parametrize(
    ("a", "b", "same"),
    [
        (2e-14, 9e-13, True),  # both below the floor
        (0.0, 1e-12, True),
        (1e-6, 9e-6, True),
        (1e-6, 2e-5, False),
        (0.0, 2e-11, False),
        (np.nan, np.nan, True),
        (np.inf, np.inf, True),
        (np.inf, 1.0, False),
        (np.nan, 1.0, False),
    ],
)
def test_errors_at_round_off_are_compared_as_magnitudes(a, b, same):
    for pair in ((a, b), (b, a)):
        found = rounded(
            [pair[0]], [pair[1]], RoundOff(ComparedAs.magnitude, "why", floor=1e-12)
        )
        assert (found.verdict < Agreement.different) is same
        assert found.compared_as == "order of magnitude"


def test_chaotic_lifetimes_are_compared_as_samples():
    """Two samples of one exponential law agree; a law of half the mean does not; NaN is late."""
    random = np.random.default_rng(5)
    first, second = random.exponential(1.0, (2, 3, 400))
    how = RoundOff(ComparedAs.sample, "why", sample="sample")
    first[first > 2], second[second > 2] = np.nan, np.nan
    assert rounded(first, second, how).verdict == Agreement.within_tolerance
    assert rounded(first, first, how).verdict == Agreement.equal
    found = rounded(first, second * [[1.0], [0.5], [1.0]], how)
    assert found.verdict == Agreement.different
    assert (found.differing, found.compared, found.where) == (1, 3, {"group": 1})


def test_every_class_of_round_off_states_its_reason():
    entries = [
        one for schema in all_schemas().values() for one in schema.variables.values()
    ]
    classed = [entry.round_off for entry in entries if entry.round_off is not None]
    assert len(classed) >= 10
    assert all(len(how.reason) > 40 for how in classed)


def test_runs_agree_to_the_digits_that_growth_leaves():
    """Fig. 4's run from a start that is off by the last digit, and by a thousand of them."""
    scene = SCENES["F4"]
    place, given = (
        (FORMER, scene.alpha1, scene.alpha2),
        {"t_end": 500.0, "growth": True},
    )
    starts = ((off, 0.0, 0.0, 0.0) for off in (0.0, 2e-16, 1e-12))
    runs = [simulate(*place, initial_state=start, **given) for start in starts]
    assert float(runs[0].growth) > 1e10
    assert compare_datasets("run", *runs[:2]).verdict == Agreement.within_tolerance
    assert compare_datasets("run", runs[0], runs[2]).verdict == Agreement.different
    without = [each.drop_vars("growth") for each in runs[:2]]
    assert compare_datasets("run", *without).verdict == Agreement.different


def test_cells_beyond_the_horizon_are_one_sample_and_the_others_are_not():
    scene = {"alpha1": np.linspace(0.15, 3.0, 12), "alpha2": np.linspace(0.15, 3.0, 12)}
    made = hammering_map(FORMER, **scene, t_end=50.0)
    made.outcome[:, :6] = Outcome.beyond_horizon
    lost = (made.outcome == Outcome.beyond_horizon).values
    verdicts = {}
    for name, change in {
        "one lost cell": lambda v: v.flat.__setitem__(lost.argmax(), v[lost][1]),
        "all lost cells": lambda v: v.__setitem__(lost, v[lost] * 2 + 1),
        "one sure cell": lambda v: v.flat.__setitem__((~lost).argmax(), 3.0),
    }.items():
        other = made.copy(deep=True)
        change(other.peak_contact_force.values)
        verdicts[name] = compare_datasets("map", made, other).verdict
    different = dict.fromkeys(("all lost cells", "one sure cell"), Agreement.different)
    assert verdicts == {"one lost cell": Agreement.within_tolerance, **different}


def places_of(branch, first):
    """Special points and ends, and every other regular point from the first or second on."""
    regular = np.flatnonzero((branch.label == Label.regular).values)
    dropped = [at for at in regular[first::2] if 0 < at < branch.sizes["point"] - 1]
    return np.setdiff1d(np.arange(branch.sizes["point"]), dropped)


def test_points_that_steps_placed_elsewhere_are_no_difference_but_a_special_point_is():
    damped = FORMER.with_(damping1=0.02, damping2=0.02)
    scene = 0.4 * np.pi, 0.6 * np.pi
    start = limit_cycle(damped, *scene)
    branch = cycle_branch(damped, *scene, parameter="mu", to=0.2, start=start)
    fewer = branch.drop_isel(point=2)
    assert (
        compare_datasets("branch", branch, fewer).verdict <= Agreement.within_tolerance
    )
    scaled, places = branch.copy(deep=True), (branch.label == Label.regular).values
    assert places.sum() > 5
    for name in ("x_max", "x_min", "y_max", "y_min"):
        scaled[name][places] *= 1.5
    for pair in ((branch, scaled), (scaled, branch)):
        assert compare_datasets("branch", *pair).verdict == Agreement.different
    # most of the points elsewhere on the same curve: every other one of each side
    odd, even = (branch.isel(point=places_of(branch, first)) for first in (0, 1))
    for pair in ((odd, even), (even, odd)):
        assert compare_datasets("branch", *pair).verdict == Agreement.within_tolerance
    for name, point, value, verdict in (
        ("x_max", 2, branch.x_max[2] * (1 + 1e-5), Agreement.different),
        ("y_max", 2, branch.y_max[2] * (1 + 1e-5), Agreement.different),
        ("y_max", -1, branch.y_max[-1] * (1 + 1e-5), Agreement.different),
        ("label", 2, Label.fold, Agreement.different),
    ):
        other = branch.copy(deep=True)
        other[name][point] = value
        assert compare_datasets("branch", branch, other).verdict == verdict, (
            name,
            point,
        )


def test_a_share_of_cells_may_differ_where_branches_meet():
    values = np.zeros(1000)
    few, many = values.copy(), values.copy()
    few[:3], many[:30] = 1.0, 1.0
    few_may_differ = RoundOff(ComparedAs.most, "why", share=0.01)
    assert rounded(values, few, few_may_differ).verdict == Agreement.within_tolerance
    assert rounded(values, many, few_may_differ).verdict == Agreement.different
    assert (
        rounded(values, many, RoundOff(ComparedAs.unjudged, "why")).verdict
        == Agreement.within_tolerance
    )
