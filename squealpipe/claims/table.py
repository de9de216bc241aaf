"""The judged statements as plain rows, for the terminal, for machines and for the report."""

from __future__ import annotations

import math
import os
from typing import Any

import xarray as xr

from squealpipe.schema.claims import Verdict
from squealpipe.store import load

TEXT = ("statement", "section", "check", "relation", "evidence", "dataset", "figure")
VERDICTS = ("verdict", "verdict_here", "recorded")
NUMBERS = ("value", "threshold", "margin", "feasible_share")


def rows(claims: xr.Dataset) -> list[dict[str, Any]]:
    """One mapping a statement; numbers that do not exist are None.

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
                "as_recorded": verdicts["verdict_here"] == verdicts["recorded"],
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


def _number(value: float) -> float | None:
    return None if math.isnan(value) else float(value)
