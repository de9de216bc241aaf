"""Every statement has a row; verdicts follow from the data, and a row says when it cannot."""

import re

import numpy as np
import pytest

from squealpipe.brake.dynamics.runs import simulate
from squealpipe.codes import Event
from squealpipe.paper.claims import judge as judging
from squealpipe.paper.claims.checks import motions
from squealpipe.paper.claims.datasets import READ_BY_CHECKS
from squealpipe.paper.claims.judge import judge
from squealpipe.paper.claims.statements import STATEMENTS
from squealpipe.paper.claims.table import rows, table
from squealpipe.paper.figures.linear import fig07
from squealpipe.paper.schema.claims import Basis, ClaimVerdict
from squealpipe.paper.schema.inference import of_study
from squealpipe.parameters import SCENES, Parameters
from squealpipe.reading import corrected
from squealpipe.store.netcdf import save
from squealpipe.store.provenance import stamped
from squealpipe.study.evidence import Evidence

ROWS = """
T1 S1 S2 S3 F2a F2b F2c F2d F2e F3 F4 F5a F5b F6a F6b F6c F6d F6e F7a F7b F8a F8b F8c F8d
F9a F9b F9c F10 F11 F12 F10b F11b F12b F13 C1 C2 C3 C4 C5 E1 E2 E3 E4 E5 E6 E7 E8 E9 E10 E11 E12
"""
CLAIMS = ROWS.split()
CHANGED = dict.fromkeys(("F3", "F6b", "F6c", "F6d", "C2", "E10"), "fails")
"""Verdicts in the corrected physics that differ from those of the paper as printed."""


@pytest.fixture(scope="module")
def claims(evidence, baseline):
    return judge(baseline, evidence, "as_printed")


def test_verdicts_at_the_baseline_are_those_recorded(claims):
    assert (
        [statement.id for statement in STATEMENTS]
        == CLAIMS
        == claims.claim.values.tolist()
    )
    differing = claims.claim.values[(claims.verdict_here != claims.recorded).values]
    assert list(differing) == []
    assert np.isfinite(claims.value).all()


def test_rows_name_their_origin_and_the_datasets_that_were_read(claims):
    table_ = {row["id"]: row for row in rows(claims)}
    misprints = [name for name, row in table_.items() if row["origin"] == "misprints"]
    assert misprints == [f"E{number}" for number in range(1, 13)]
    assert sum(row["origin"] == "paper" for row in table_.values()) == len(CLAIMS) - 12
    read = {name: row["dataset"].split("; ") for name, row in table_.items()}
    assert {one.split(" (")[0] for each in read.values() for one in each} == set(
        READ_BY_CHECKS
    )
    assert [one.split(" (")[0] for one in read["F5a"]] == [
        "simulate/F5a",
        "simulate/F5b",
    ]


@pytest.mark.parametrize(
    ("params", "reason"),
    [
        (Parameters(), "not computed yet"),
        (Parameters(damping1=0.02), "cannot carry damping1"),
    ],
)
def test_without_datasets_nothing_is_decided_and_the_reason_names_what_is_missing(
    params, reason
):
    found = judge(params, {}, "as_printed")
    decided = found.claim.values[
        (found.verdict != ClaimVerdict.cannot_be_decided).values
    ]
    assert list(decided) == ["E9"]  # of the paper alone
    found = found.sel(claim=found.claim != "E9")
    assert all(reason in str(text) for text in found.evidence.values)


def test_only_as_printed_is_true_as_printed_and_false_with_one_sign(
    claims, evidence, baseline
):
    """F3 has a bound with one sign throughout, and Fig. 7 no black region."""
    table_ = rows(claims)
    changed = {row["id"]: row["corrected_verdict"] for row in table_ if row["changes"]}
    assert changed == CHANGED
    only = [row["id"] for row in table_ if row["verdict"] == "holds only as printed"]
    assert only == [row["id"] for row in table_ if row["id"] in CHANGED]
    plain = {
        name: data
        for name, data in evidence.items()
        if not name.startswith("corrected/")
    }
    left = [
        row["id"]
        for row in rows(judge(baseline, plain, "as_printed"))
        if row["changes"]
    ]
    assert left == ["F6b", "F6c", "C2"]  # Eq. (11) is told from the reaction force


@pytest.mark.parametrize("every", [pytest.param(2, marks=pytest.mark.release), 8])
def test_coarse_grids_leave_nothing_undecided(every, evidence, baseline):
    """What is said of a scene is judged at its angles, on no grid."""
    linear = ("quasi_static_map", "stability_map", "natural_frequencies", "linear_pull")
    coarse = dict(evidence)
    for name in (each + of for of in linear for each in ("", "corrected/")):
        coarse[name] = evidence[name].isel(
            alpha1=slice(0, None, every), alpha2=slice(0, None, every)
        )
    claims = judge(baseline, coarse, "as_printed")
    undecided = claims.claim.values[
        (claims.verdict == ClaimVerdict.cannot_be_decided).values
    ]
    assert list(undecided) == []


@pytest.mark.parametrize(
    ("parameters", "change", "code"),
    [(Parameters(), False, 0), (Parameters(), True, 1), (Parameters(mu=0.2), True, 0)],
    ids=["as recorded", "differs at the baseline", "differs elsewhere"],
)
def test_exit_code(tmp_path, claims, evidence, parameters, change, code, monkeypatch):
    if parameters == Parameters():
        claims = claims.copy(deep=True)
    else:
        monkeypatch.setattr(judging, "STATEMENTS", STATEMENTS[:4])
        claims = judge(parameters, evidence, "as_printed")
    claims["verdict_here"] = claims.recorded.copy().assign_attrs(claims.verdict.attrs)
    if change:
        claims.verdict_here[1] = ClaimVerdict.fails
    path = save(stamped(lambda: claims, config={}), tmp_path / "claims.nc")
    found, exit_code = table(path)
    assert exit_code == code
    assert found[1]["as_recorded"] is not change
    columns = "id statement verdict value threshold evidence dataset figure"
    assert set(found[0]) >= set(columns.split())


def judged_alone(claim, baseline, evidence, monkeypatch):
    """One row of the table."""
    one = [statement for statement in STATEMENTS if statement.id == claim]
    with monkeypatch.context() as patch:
        patch.setattr(judging, "STATEMENTS", one)
        return judge(baseline, evidence, "as_printed").sel(claim=claim)


def test_a_statement_that_divides_the_feasible_set_depends_on_the_parameters(
    evidence, baseline, monkeypatch
):
    inference = evidence["parameter_inference"].copy(deep=True)
    at = list(inference.consequence.values).index("S3")
    depends, holds = ClaimVerdict.depends_on_the_parameters, ClaimVerdict.holds
    # exceptions in less than a tenth of the set divide it no more than none do
    for share, verdict in ((0.7, depends), (0.95, holds), (0.05, holds)):
        inference.feasible_share[:, at] = share
        data = {**evidence, "parameter_inference": inference}
        claims = judged_alone("S3", baseline, data, monkeypatch)
        assert int(claims.verdict_here) == holds
        assert int(claims.verdict) == verdict
        assert float(claims.feasible_share) == pytest.approx(share)


def test_each_row_says_whether_it_was_fitted_or_is_predicted(
    claims, evidence, baseline, monkeypatch
):
    """What defined the feasible set is no evidence for it: only predictions get a share."""
    constraints = [
        str(name) for name in evidence["parameter_inference"].statement.values
    ]
    # E10 is Fig. 7's black region, whose constraint has a name of its own
    constraints = [*(name for name in constraints if name in claims.claim), "E10"]
    # Eq. (11) taken literally was fitted too: three rows speak of it
    constraints += ["F6b", "F6c", "C2"]
    fitted = claims.sel(claim=constraints)
    assert (fitted.basis == Basis.fitted).all()
    assert np.isnan(fitted.feasible_share).all()
    predicted = claims.sel(claim=~claims.claim.isin(constraints))
    assert (predicted.basis == Basis.predicted).all()
    shared = predicted.sel(claim=np.isfinite(predicted.feasible_share))
    assert set(shared.claim.values) == {"S3", "F8c", "E8"}
    size = int(of_study(evidence["parameter_inference"]).feasible_count)
    assert (shared.feasible_count == size).all()
    alone = {
        name: data for name, data in evidence.items() if name != "parameter_inference"
    }
    some = {"F3", "S3", *constraints}
    monkeypatch.setattr(judging, "STATEMENTS", [s for s in STATEMENTS if s.id in some])
    assert (judge(baseline, alone, "as_printed").basis == Basis.unknown).all()


def test_one_threshold_of_growth_for_the_figure_and_the_verdict(
    evidence, baseline, monkeypatch
):
    """The reproducer: growth of 1.5 to 2 was black in Fig. 7 and none in E10."""
    validity = evidence["validity_map"]
    kept = validity.separates.values == 0
    validity = validity.assign(regime_linear=0 * validity.regime_linear)
    for growth, black in ((1.9, 0), (2.0, 1)):
        changed = validity.response_growth.copy()
        changed.values[tuple(np.argwhere(kept)[0])] = growth
        maps = {"validity_map": validity.assign(response_growth=changed)}
        row = judged_alone("E10", baseline, {**evidence, **maps}, monkeypatch)
        assert float(row.value) == black
        caption = fig07.caption({"validity_map": maps["validity_map"]})
        assert f"second), {black} of the cells" in caption


def test_where_the_modes_switch_is_read_from_the_map(claims, baseline):
    """C1 against the closed form K11 − K22 = k (cos 2α1 + cos 2α2) between 0 and k3."""
    row = claims.sel(claim="C1")
    angles = np.linspace(0.0, np.pi, 1201)
    sums, differences = angles[:, None] + angles, angles[:, None] - angles
    split = 2.0 * np.cos(sums) * np.cos(differences)
    exact = ((split > 0) & (split < baseline.k3)).mean()
    share = re.search(
        r"it does so in ([\d.]+) % of the cells", str(row.evidence.item())
    )
    assert float(share[1]) / 100.0 == pytest.approx(exact, abs=0.02)
    assert float(row.value) == 0.0  # of no scene of the paper


def test_windows_of_growth_are_those_of_dense_output(claims, evidence):
    """By DOP853's dense output of the same equations; samples alone are up to 0.5 % low."""
    run = Evidence(Parameters(), evidence)
    sizes = motions.windows(run, run["simulate/F3_long"])
    dense = [437.43, 904.89, 1212.3, 1458.3, 1669.9, 1858.7]
    np.testing.assert_allclose(sizes, dense, rtol=5e-5)
    assert float(claims.value.sel(claim="F3")) == pytest.approx(1.11307, abs=2e-5)


def test_without_contact_loss_one_distance_is_compared(claims, baseline):
    """C4's sentence and its number are of the largest distance from the start, by samples here."""
    params = corrected(baseline, "as_printed")
    changes = {}
    for name, scene in SCENES.items():
        runs = [
            simulate(params, scene.alpha1, scene.alpha2, t_end=scene.t_end, model=model)
            for model in ("A1", "A1-no-separation")
        ]
        one, other = (float(np.hypot(run.x, run.y).max()) for run in runs)
        if (runs[0].event_kind == Event.separation).any():
            changes[name] = abs(other / one - 1.0)
    row = claims.sel(claim="C4")
    assert float(row.value) == pytest.approx(
        np.median(list(changes.values())), rel=2e-3
    )
    said = str(row.evidence.item())
    assert all(f"{name} {100 * each:.2g} %" in said for name, each in changes.items())
