"""The judged statements as plain rows, for the terminal, for machines and for the report."""

import os
from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr

from squealpipe.paper.claims.evidence import passes
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.schema import meanings
from squealpipe.store import load


def rows(claims: xr.Dataset) -> list[dict[str, Any]]:
    """Return for each statement its id and the variables of dataset ``claims``, flags in words.

    Numbers that do not exist are None. ``changes``: the sign of friction changes the verdict;
    ``as_recorded``: the verdict here is the recorded one; ``unmet``: the statement fails here
    though its deciding comparison is true.
    """
    records = []
    for name in claims.claim.values.tolist():
        row = {
            str(key): _plain(value)
            for key, value in claims.sel(claim=name).data_vars.items()
        }
        fails = row["verdict_here"] == "fails" and row["value"] is not None
        records.append(
            {
                "id": name,
                **row,
                "changes": row["corrected_verdict"] != row["verdict"],
                "as_recorded": row["verdict_here"] == row["recorded"],
                "unmet": fails
                and passes(row["value"], row["relation"], row["threshold"]),
            }
        )
    return records


def tally(statements: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Count the verdicts, those of fitted statements apart from those of tests."""
    words = {"predicted": "tests", "fitted": "fitted", "unknown": "not told apart"}
    tallies = []
    for basis, name in words.items():
        verdicts = [row["verdict"] for row in statements if row["basis"] == basis]
        if verdicts:
            counts = [verdicts.count(verdict.words) for verdict in ClaimVerdict]
            tallies.append({"basis": name, "number": len(verdicts), "counts": counts})
    return tallies


def table(path: str | os.PathLike[str]) -> tuple[list[dict[str, Any]], int]:
    """Return the judged statements of a run and the exit code for a command line.

    Returns:
        The rows, and 1 if a verdict differs from the one recorded for the shipped baseline,
        else 0. A run with other parameters only reports: its code is 0.
    """
    claims = load(path, schema="claims")
    table_rows = rows(claims)
    shipped = bool(claims.attrs["shipped"])
    return table_rows, int(
        shipped and not all(row["as_recorded"] for row in table_rows)
    )


def _plain(variable: xr.DataArray) -> Any:
    value, words = variable.item(), meanings(variable)
    if words:
        return words[value].replace("_", " ")
    return value if value == value else None
