"""Judging: every statement's check is run on one run's datasets."""

from collections.abc import Mapping
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.paper.claims.evidence import Finding
from squealpipe.paper.claims.statement import Check, Statement
from squealpipe.paper.claims.statements import PAPER_STATEMENTS, STATEMENTS
from squealpipe.paper.schema.claims import Basis, ClaimVerdict, Origin, claims_schema
from squealpipe.paper.schema.inference import of_study
from squealpipe.parameters import Parameters
from squealpipe.reading import corrected, for_linear
from squealpipe.schema import build
from squealpipe.study.evidence import Evidence, MissingDataError


def judge(
    parameters: Parameters,
    sources: Mapping[str, Path | xr.Dataset],
    reading: str = "along_plus_x",
) -> xr.Dataset:
    """The verdict on every statement, in the study's reading and in the corrected physics.

    What holds in the reading and fails in the physics with one sign holds only as printed. A study
    whose reading has one sign already is its own physics.
    """
    run = Evidence(for_linear(parameters, reading), sources)
    # datasets of the corrected physics stand here where they differ from the reading's
    corrected_folder = "corrected/"
    mended = {
        name.removeprefix(corrected_folder): source
        for name, source in sources.items()
        if name.startswith(corrected_folder)
    }
    second = (
        Evidence(corrected(parameters, reading), {**sources, **mended})
        if mended
        else run
    )
    rows = [_row(statement, run, second) for statement in STATEMENTS]
    names = [statement.id for statement in STATEMENTS]
    data = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    shipped = parameters == Parameters() and reading == "as_printed"
    return build(
        claims_schema,
        data,
        {"claim": names},
        {"shipped": int(shipped), "reading": reading},
    )


def _row(statement: Statement, run: Evidence, second: Evidence) -> dict[str, Any]:
    basis, share, count = standing(statement, run)
    run.forget()
    judgement = _judged(statement.check, run)
    datasets = "; ".join(run.forget())
    physics = statement.physics or statement.check
    same = second is run and physics is statement.check
    mended = judgement if same else _judged(physics, second)
    printed = (
        judgement.verdict == ClaimVerdict.holds and mended.verdict == ClaimVerdict.fails
    )
    verdict_here = ClaimVerdict.holds_only_as_printed if printed else judgement.verdict
    verdict, corrected_verdict = verdict_here, mended.verdict
    # The paper prints no parameters: what divides the feasible set depends on those one takes.
    # exceptions in less than a tenth of the feasible set, or of its rest, lie at the set's margin
    margin = 0.1
    if margin < share < 1.0 - margin and verdict != ClaimVerdict.cannot_be_decided:
        verdict = ClaimVerdict.depends_on_the_parameters
        if mended.verdict == judgement.verdict:
            corrected_verdict = verdict
    return {
        "statement": statement.text,
        "section": statement.section,
        "check": statement.measure,
        "figure": statement.figure,
        "recorded": statement.recorded,
        "origin": Origin.paper if statement in PAPER_STATEMENTS else Origin.misprints,
        "basis": basis,
        "feasible_share": share,
        "feasible_count": count,
        "verdict": verdict,
        "verdict_here": verdict_here,
        **{
            key: getattr(judgement, key)
            for key in ("value", "relation", "threshold", "evidence")
        },
        "dataset": datasets,
        "corrected_verdict": corrected_verdict,
        "corrected_value": mended.value,
        "corrected_evidence": mended.evidence,
    }


def standing(statement: Statement, run: Evidence) -> tuple[Basis, float, int]:
    """Return how a statement stands to the inference of a run.

    Returns:
        Whether it was fitted or is predicted (unknown without an inference), the share of the
        feasible sets in which it holds, NaN where the inference does not judge it, and their
        number.
    """
    if "parameter_inference" not in run:
        return Basis.unknown, nan, 0
    inference = of_study(run["parameter_inference"])
    # what was fitted as the paper prints it is no test of the paper's words either
    names = {statement.id, statement.consequence, f"{statement.consequence}_printed"}
    if names & set(inference.statement.values.tolist()):
        return Basis.fitted, nan, 0
    count = int(inference.feasible_count)
    if not count or statement.consequence not in inference.consequence.values:
        return Basis.predicted, nan, 0
    share = inference.feasible_share.sel(consequence=statement.consequence)
    return Basis.predicted, float(share), count


def _judged(check: Check, run: Evidence) -> Finding:
    try:
        return check(run)
    except MissingDataError as error:
        undecided = ClaimVerdict.cannot_be_decided
        return Finding(undecided, nan, "", nan, f"Not decided: {error}.")
