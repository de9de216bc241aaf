"""Judging: every statement's check is run on one run's datasets."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.claims import CLAIMS, Origin, Verdict
from squealpipe.study.claims.checks.feasible import standing
from squealpipe.study.claims.evidence import MissingDataError, Run
from squealpipe.study.claims.statement import Statement
from squealpipe.study.claims.statements import PAPER, STATEMENTS


def judge(parameters: Parameters, sources: Mapping[str, Path | xr.Dataset]) -> xr.Dataset:
    """The verdict on every statement.

    Args:
        parameters: those of the study.
        sources: dataset name → NetCDF file, or the dataset itself.

    Returns:
        Dataset over claim: statement, section, check, verdict, recorded, value, relation,
        threshold, margin, evidence, dataset, figure; origin (the paper's statement or our list
        of misprints), basis (fitted or predicted) and, for predictions that the inference
        judges, feasible_share with its sample feasible_count and its interval.
    """
    run = Run(parameters, sources)
    rows = [_row(statement, run) for statement in STATEMENTS]
    names = [statement.id for statement in STATEMENTS]
    data = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    return build(CLAIMS, data, {"claim": names}, {"shipped": int(parameters == Parameters())})


def _row(statement: Statement, run: Run) -> dict[str, Any]:
    stands = standing(statement, run)
    run.forget()
    row: dict[str, Any] = {
        "statement": statement.text,
        "section": statement.section,
        "check": statement.measure,
        "recorded": statement.recorded,
        "figure": statement.figure,
        "feasible_share": stands.share,
        "feasible_count": stands.count,
        "feasible_share_low": stands.low,
        "feasible_share_high": stands.high,
        "basis": stands.basis,
        "origin": Origin.paper if statement in PAPER else Origin.misprints,
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
            "verdict": Verdict.depends_on_the_parameters if stands.divides else found.verdict,
            "verdict_here": found.verdict,
            "value": found.value,
            "relation": found.relation,
            "threshold": found.threshold,
            "margin": found.margin,
            "evidence": found.evidence,
        }
    row["dataset"] = "; ".join(run.forget())
    return row
