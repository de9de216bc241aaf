"""Judging: every statement's check is run on one run's datasets."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.claims.evidence import MissingDataError, Run
from squealpipe.claims.feasible import feasible_shares, undecided_by_paper
from squealpipe.claims.statement import Statement
from squealpipe.claims.statements import STATEMENTS
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.claims import CLAIMS, Verdict


def judge(parameters: Parameters, sources: Mapping[str, Path | xr.Dataset]) -> xr.Dataset:
    """The verdict on every statement.

    Args:
        parameters: those of the study.
        sources: dataset name → NetCDF file, or the dataset itself.

    Returns:
        Dataset over claim: statement, section, check, verdict, recorded, value, relation,
        threshold, margin, feasible_share, evidence, dataset, figure.
    """
    run = Run(parameters, sources)
    shares = feasible_shares(run)
    rows = [_row(statement, run, shares) for statement in STATEMENTS]
    names = [statement.id for statement in STATEMENTS]
    data = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    return build(CLAIMS, data, {"claim": names}, {"shipped": int(parameters == Parameters())})


def _row(statement: Statement, run: Run, shares: Mapping[str, float]) -> dict[str, Any]:
    row: dict[str, Any] = {
        "statement": statement.text,
        "section": statement.section,
        "check": statement.measure,
        "recorded": statement.recorded,
        "figure": statement.figure,
        "feasible_share": shares.get(statement.id, nan),
    }
    try:
        found = statement.check(run)
    except MissingDataError as error:
        row |= {
            "verdict": Verdict.cannot_be_decided,
            "verdict_here": Verdict.cannot_be_decided,
            "value": nan,
            "relation": "",
            "threshold": nan,
            "margin": nan,
            "evidence": f"Not decided: {error}.",
        }
    else:
        row |= {
            "verdict": Verdict.depends_on_the_parameters
            if undecided_by_paper(row["feasible_share"])
            else found.verdict,
            "verdict_here": found.verdict,
            "value": found.value,
            "relation": found.relation,
            "threshold": found.threshold,
            "margin": found.margin,
            "evidence": found.evidence,
        }
    row["dataset"] = "; ".join(run.forget())
    return row
