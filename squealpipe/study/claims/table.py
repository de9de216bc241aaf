"""The judged statements as plain rows, for the terminal, for machines and for the report."""

from __future__ import annotations

import math
import os
from typing import Any

import xarray as xr

from squealpipe.schema.claims import Basis, Origin, Verdict
from squealpipe.store import load
from squealpipe.study.claims.evidence import passes

TEXT = (
    "statement",
    "section",
    "check",
    "relation",
    "evidence",
    "corrected_evidence",
    "dataset",
    "figure",
)
VERDICTS = ("verdict", "corrected_verdict", "verdict_here", "recorded")
NUMBERS = (
    "value",
    "corrected_value",
    "threshold",
    "margin",
    "feasible_share",
    "feasible_share_low",
    "feasible_share_high",
)
FLAGS = {"basis": Basis, "origin": Origin}


def rows(claims: xr.Dataset) -> list[dict[str, Any]]:
    """One mapping per statement; numbers that do not exist are None.

    Args:
        claims: dataset ``claims``.
    """
    table_ = []
    for index, name in enumerate(claims.claim.values):
        row = claims.isel(claim=index)
        verdicts = {key: Verdict(int(row[key])).words for key in VERDICTS}
        table_.append(
            {
                "id": str(name),
                **{key: str(row[key].item()) for key in TEXT},
                **{key: _number(row[key].item()) for key in NUMBERS},
                **verdicts,
                "changes": verdicts["corrected_verdict"] != verdicts["verdict"],
                "as_recorded": verdicts["verdict_here"] == verdicts["recorded"],
                "unmet": _fails_by_a_further_condition(row),
                "feasible_count": int(row.feasible_count),
                **{key: flags(int(row[key])).name for key, flags in FLAGS.items()},
            }
        )
    return table_


def table(path: str | os.PathLike[str]) -> tuple[list[dict[str, Any]], int]:
    """The judged statements of a run and the exit code for a command line.

    Args:
        path: the dataset ``claims`` of a run, for instance ``results/data/claims.nc``.

    Returns:
        The rows, and 1 if a verdict differs from the one recorded for the shipped baseline,
        else 0. A run with other parameters only reports: its code is 0.
    """
    claims = load(path, schema="claims")
    found = rows(claims)
    shipped = bool(claims.attrs["shipped"])
    return found, int(shipped and not all(row["as_recorded"] for row in found))


def _fails_by_a_further_condition(row: xr.Dataset) -> bool:
    """Whether the statement fails here though its deciding comparison is true."""
    value, relation, threshold = (row[key].item() for key in ("value", "relation", "threshold"))
    fails = int(row.verdict_here) == Verdict.fails
    return fails and relation != "" and passes(value, relation, threshold)


def _number(value: float) -> float | None:
    return None if math.isnan(value) else float(value)
