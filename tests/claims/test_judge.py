"""Every statement has a row; verdicts follow from the data, and a row says when it cannot."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from squealpipe.claims.datasets import READ
from squealpipe.claims.judge import judge
from squealpipe.claims.statements import STATEMENTS
from squealpipe.claims.table import rows, table
from squealpipe.parameters import Parameters
from squealpipe.schema.claims import Verdict
from squealpipe.store.netcdf import save
from squealpipe.store.provenance import stamp

ROWS = """
T1 S1 S2 S3 F2a F2b F2c F2d F2e F3 F4 F5a F5b F6a F6b F6c F6d F6e F7a F7b F8a F8b F8c F8d
F9a F9b F9c F10 F11 F12 F10b F11b F12b F13 C1 C2 C3 C4 C5 E1 E2 E3 E4 E5 E6 E7 E8 E9 E10 E11 E12
"""
CLAIMS = ROWS.split()


def verdicts(claims: xr.Dataset) -> dict[str, Verdict]:
    return {
        str(name): Verdict(int(value))
        for name, value in zip(claims.claim.values, claims.verdict.values, strict=True)
    }


def test_every_statement_of_the_list_has_its_row_in_order() -> None:
    assert [statement.id for statement in STATEMENTS] == CLAIMS


def test_verdicts_at_the_baseline_are_those_recorded(
    evidence: dict[str, xr.Dataset], baseline: Parameters
) -> None:
    claims = judge(baseline, evidence)
    differing = claims.claim.values[(claims.verdict_here != claims.recorded).values]
    assert list(differing) == []
    assert np.isfinite(claims.value).all()


def test_without_datasets_nothing_is_decided_and_the_reason_names_what_is_missing(
    baseline: Parameters,
) -> None:
    claims = judge(baseline, {})
    assert (claims.verdict == Verdict.cannot_be_decided).all()
    for text in claims.evidence.values:
        assert "the run has no dataset" in str(text)


def test_the_list_of_datasets_read_is_complete(
    evidence: dict[str, xr.Dataset], baseline: Parameters
) -> None:
    used = {
        name.split(" (")[0]
        for row in rows(judge(baseline, evidence))
        for name in row["dataset"].split("; ")
    }
    assert used == set(READ)


def test_a_grid_without_the_cell_gives_a_reason(
    evidence: dict[str, xr.Dataset], baseline: Parameters
) -> None:
    coarse = {
        **evidence,
        "stability_map": evidence["stability_map"].isel(alpha1=slice(0, None, 3)),
    }
    claims = judge(baseline, coarse).sel(claim="F6d")
    assert int(claims.verdict) == Verdict.cannot_be_decided
    assert "no cell (0.4π, 0.6π)" in str(claims.evidence.item())


def test_rows_name_the_datasets_that_were_read(
    evidence: dict[str, xr.Dataset], baseline: Parameters
) -> None:
    named = {row["id"]: row["dataset"] for row in rows(judge(baseline, evidence))}
    assert named["F5a"].startswith("simulate/F5a (")
    assert "simulate/F5b (" in named["F5a"]
    assert "stability_map (" in named["F6b"]
    assert "quasi_static_map (" in named["F6b"]


@pytest.mark.parametrize(
    ("parameters", "change", "code"),
    [
        (Parameters(), False, 0),
        (Parameters(), True, 1),
        (Parameters(mu=0.2), True, 0),
    ],
    ids=["as recorded", "differs at the baseline", "differs elsewhere"],
)
def test_exit_code(
    tmp_path,
    evidence: dict[str, xr.Dataset],
    parameters: Parameters,
    change: bool,
    code: int,
) -> None:
    claims = judge(parameters, evidence)
    claims["verdict_here"] = claims.recorded.copy().assign_attrs(claims.verdict.attrs)
    if change:
        claims.verdict_here[0] = Verdict.fails
    path = save(stamp(claims, config={}, wall_time=0.0), tmp_path / "claims.nc")
    found, exit_code = table(path)
    assert exit_code == code
    assert found[0]["as_recorded"] is not change
    assert set(found[0]) >= {
        "id",
        "statement",
        "verdict",
        "value",
        "threshold",
        "evidence",
        "dataset",
        "figure",
    }


def test_a_statement_that_divides_the_feasible_set_depends_on_the_parameters(
    evidence: dict[str, xr.Dataset], baseline: Parameters
) -> None:
    inference = evidence["parameter_inference"].copy(deep=True)
    inference.feasible_share[list(inference.consequence.values).index("F7_black")] = 0.7
    claims = judge(baseline, {**evidence, "parameter_inference": inference}).sel(claim="E10")
    assert int(claims.verdict) == Verdict.depends_on_the_parameters
    assert int(claims.verdict_here) == Verdict.fails
    assert float(claims.feasible_share) == pytest.approx(0.3)


def test_constraints_of_the_inference_hold_in_all_of_the_feasible_set(
    evidence: dict[str, xr.Dataset], baseline: Parameters
) -> None:
    claims = judge(baseline, evidence)
    constraints = [str(name) for name in evidence["parameter_inference"].statement.values]
    assert (claims.feasible_share.sel(claim=constraints) == 1.0).all()
