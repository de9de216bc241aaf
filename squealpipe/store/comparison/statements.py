"""Statements of the paper whose verdict or value changed between two runs."""

import math
from dataclasses import dataclass

import xarray as xr

from squealpipe.schema import find, meanings
from squealpipe.store.comparison.differences import outside_tolerance


@dataclass(frozen=True, kw_only=True)
class StatementChange:
    """One statement in two runs.

    Attributes:
        verdicts: in the first and the second run; empty where it is not judged.
        values: what was measured; None where there is not a number.
    """

    claim: str
    statement: str
    verdicts: tuple[str, str]
    values: tuple[float | None, float | None]

    @property
    def verdict_changed(self) -> bool:
        """Return whether more than the measured value changed."""
        return self.verdicts[0] != self.verdicts[1]


def changed_statements(a: xr.Dataset, b: xr.Dataset) -> list[StatementChange]:
    """Statements whose verdict or value differs; changed verdicts first."""
    a, b = xr.align(a, b, join="outer", fill_value={"verdict": -1, "statement": ""})
    beyond = outside_tolerance(
        a.value.values, b.value.values, find("claims").variables["value"]
    )
    words_of = meanings(b.verdict) | {-1: ""}
    changed = []
    for i in range(a.sizes["claim"]):
        rows = a.isel(claim=i), b.isel(claim=i)
        codes = [int(row.verdict) for row in rows]
        if codes[0] != codes[1] or beyond[i]:
            words = [words_of[code].replace("_", " ") for code in codes]
            numbers = [
                value if math.isfinite(value := float(row.value)) else None
                for row in rows
            ]
            changed.append(
                StatementChange(
                    claim=str(rows[0].claim.values),
                    statement=str(rows[0].statement.values)
                    or str(rows[1].statement.values),
                    verdicts=(words[0], words[1]),
                    values=(numbers[0], numbers[1]),
                )
            )
    return sorted(changed, key=lambda change: not change.verdict_changed)
