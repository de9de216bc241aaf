"""Methods compared: ours are never silently wrong, and the public ones' failures are real."""

import numpy as np
import pytest

from squealpipe.benchmark.schema import Reliability, Role
from squealpipe.paper.comparison.failures import Answer, judge_balances, verdict_of
from squealpipe.paper.comparison.work_precision import work_precision
from squealpipe.schema import Outcome
from tests.former import FORMER


@pytest.fixture(scope="module")
def atlas():
    return judge_balances()


def test_our_methods_are_never_silently_wrong(atlas):
    ours = atlas.role.values != Role.public
    silent = (atlas.verdict == Reliability.silently_wrong).values & ours
    where = [
        (atlas.scene.values[i], atlas.solver.values[j]) for i, j in np.argwhere(silent)
    ]
    assert where == []
    asked = atlas.verdict != Reliability.not_applicable
    for columns in (ours, ~ours):
        assert asked.isel(solver=columns).any("solver").all()


WRONG, SAID = Reliability.silently_wrong, Reliability.flagged
KNOWN = {
    ("σ too small (balance)", "tanh balance, sampled"): WRONG,
    ("σ too large (balance)", "tanh balance, sampled"): WRONG,
    ("aliasing, N ≈ 2N_h", "cold Newton, sampled"): WRONG,
    ("aliasing, N ≈ 2N_h", "paper, Eq. (34) corrected"): WRONG,
    ("aliasing, N ≈ 2N_h", "paper, Eq. (34) as printed"): WRONG,
    ("tongue end", "cold Newton, sampled"): WRONG,
    ("cold start, wrong basin", "cold Newton, sampled"): WRONG,
    ("cold start, wrong basin", "paper, Eq. (34) corrected"): WRONG,
    ("period-doubling window", "Hill's method, sampled"): WRONG,
    ("singular static state", "numpy.linalg"): WRONG,
    ("flutter onset", "numpy.linalg"): WRONG,
    ("singular static state", "closed form, exact orbit"): SAID,
    ("tongue end", "closed form, exact orbit"): SAID,
    ("pole at ω_x/2", "closed-form balance"): SAID,
}


@pytest.mark.parametrize("place", KNOWN)
def test_public_methods_fail_silently_where_we_say_and_ours_say_where_nothing_is(
    atlas, place
):
    cell = atlas.sel(scene=place[0], solver=place[1])
    assert cell.verdict == KNOWN[place]
    assert cell.message.item() or KNOWN[place] == WRONG


@pytest.mark.parametrize(
    ("value", "flag", "truth", "expected"),
    [
        (1.0, "", 1.0 + 1e-4, Reliability.right),
        (1.0, "careful", 1.0 + 1e-4, Reliability.right),
        (1.0, "", 1.1, Reliability.silently_wrong),
        (1.0, "careful", 1.1, Reliability.flagged),
        (np.nan, "no answer", 1.0, Reliability.flagged),
        (np.nan, "", 1.0, Reliability.silently_wrong),
        (1.0, "", np.nan, Reliability.silently_wrong),
        (np.nan, "there is none", np.nan, Reliability.flagged),
        (np.nan, "", np.nan, Reliability.silently_wrong),
    ],
)
def test_verdicts_follow_from_errors_and_flags(value, flag, truth, expected):
    assert verdict_of(Answer(value, flag), truth, 1e-3)[0] == expected


def test_harmonic_balance_converges_as_published():
    """ω falls about like N_h^-4 with closed-form integrals; the printed Eq. (34) is just wrong."""
    found = work_precision(
        FORMER, harmonics=(8, 32), oversampling=(1,), sigmas=(10.0,), repeats=1
    )
    names = zip(found.method.values, found.setting.values, strict=True)
    errors = dict(zip(names, found.error.values, strict=True))
    coarse, fine = (
        errors["cosines, closed-form contact", f"N_h {count}"] for count in (8, 32)
    )
    assert 3.3 < np.log(coarse / fine) / np.log(4.0) < 4.7
    assert fine < 1e-7
    assert errors["exact orbit (shooting)", "with monodromy"] < 1e-12
    printed = found.isel(run=found.method.values == "paper, Eq. (34) as printed")
    assert float(printed.error.min()) > 0.1
    assert (printed.outcome == Outcome.converged).all()
