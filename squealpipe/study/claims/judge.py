"""Judging: every statement's check is run on one run's datasets."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.reading import corrected, for_linear
from squealpipe.schema import build
from squealpipe.schema.claims import CLAIMS, Origin, Verdict
from squealpipe.study.claims.checks.feasible import standing
from squealpipe.study.claims.evidence import MissingDataError, Run
from squealpipe.study.claims.statement import Statement
from squealpipe.study.claims.statements import PAPER, STATEMENTS

BESIDE = "corrected/"
"""Folder of the datasets of the corrected physics, where it differs from the reading."""


def judge(
    parameters: Parameters,
    sources: Mapping[str, Path | xr.Dataset],
    reading: str = "along_plus_x",
) -> xr.Dataset:
    """The verdict on every statement, in the study's reading and in the corrected physics.

    Args:
        parameters: those of the study.
        sources: dataset name → NetCDF file, or the dataset itself; under ``corrected/`` those of
            the corrected physics.
        reading: in which the other datasets were computed; a name of
            :data:`squealpipe.reading.READINGS`.

    Returns:
        Dataset over claim: statement, section, check, verdict, recorded, value, relation,
        threshold, margin, evidence, dataset, figure; corrected_verdict, corrected_value and
        corrected_evidence; origin (the paper's statement or our list of misprints), basis (fitted
        or predicted) and, for predictions that the inference judges, feasible_share with its
        sample feasible_count and its interval.
    """
    run = Run(for_linear(parameters, reading), sources)
    mended = {
        name.removeprefix(BESIDE): source
        for name, source in sources.items()
        if name.startswith(BESIDE)
    }
    second = Run(corrected(parameters, reading), {**sources, **mended}) if mended else run
    rows = [_row(statement, run, second) for statement in STATEMENTS]
    names = [statement.id for statement in STATEMENTS]
    data = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    shipped = parameters == Parameters() and reading == "as_printed"
    return build(CLAIMS, data, {"claim": names}, {"shipped": int(shipped), "reading": reading})


def _row(statement: Statement, run: Run, second: Run) -> dict[str, Any]:
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
        **_found(statement, run),
    }
    row["dataset"] = "; ".join(run.forget())
    mended = row if second is run else _found(statement, second)
    row |= {
        "corrected_verdict": mended["verdict_here"],
        "corrected_value": mended["value"],
        "corrected_evidence": mended["evidence"],
        "verdict": row["verdict_here"],
    }
    if stands.divides and row["verdict"] != Verdict.cannot_be_decided:
        row["verdict"] = Verdict.depends_on_the_parameters
        if row["corrected_verdict"] == row["verdict_here"]:
            row["corrected_verdict"] = row["verdict"]
    return row


def _found(statement: Statement, run: Run) -> dict[str, Any]:
    try:
        found = statement.check(run)
    except MissingDataError as error:
        return {
            "verdict_here": Verdict.cannot_be_decided,
            "value": nan,
            "relation": "",
            "threshold": nan,
            "margin": nan,
            "evidence": f"Not decided: {error}.",
        }
    return {
        "verdict_here": found.verdict,
        "value": found.value,
        "relation": found.relation,
        "threshold": found.threshold,
        "margin": found.margin,
        "evidence": found.evidence,
    }
