"""Which of the paper's statements changed their verdict or their value between two runs."""

import math
from dataclasses import dataclass

import xarray as xr

from squealpipe.schema.claims import CLAIMS, Verdict
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
        """Whether more than the measured value changed."""
        return self.verdicts[0] != self.verdicts[1]


def changed_statements(a: xr.Dataset, b: xr.Dataset) -> list[StatementChange]:
    """Statements whose verdict or value differs; changed verdicts first."""
    rows = [_rows(dataset) for dataset in (a, b)]
    found = []
    for claim in dict.fromkeys([*rows[0], *rows[1]]):
        first, second = (side.get(claim) for side in rows)
        verdicts = _verdict(first), _verdict(second)
        if verdicts[0] == verdicts[1] and not _value_changed(first, second):
            continue
        shown = {**rows[1], **rows[0]}[claim]
        found.append(
            StatementChange(
                claim=claim,
                statement=str(shown["statement"].item()),
                verdicts=verdicts,
                values=(_value(first), _value(second)),
            )
        )
    return sorted(found, key=lambda change: not change.verdict_changed)


def _rows(dataset: xr.Dataset) -> dict[str, xr.Dataset]:
    return {str(name): dataset.isel(claim=i) for i, name in enumerate(dataset.claim.values)}


def _verdict(row: xr.Dataset | None) -> str:
    return "" if row is None else Verdict(int(row["verdict"])).words


def _value(row: xr.Dataset | None) -> float | None:
    value = math.nan if row is None else float(row["value"])
    return value if math.isfinite(value) else None


def _value_changed(first: xr.Dataset | None, second: xr.Dataset | None) -> bool:
    if first is None or second is None:
        return True
    entry = CLAIMS.variables["value"]
    return bool(outside_tolerance(first["value"].values, second["value"].values, entry))
