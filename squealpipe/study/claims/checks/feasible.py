"""In how much of the inferred feasible set a statement that was not fitted holds."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

from squealpipe.schema.claims import Basis
from squealpipe.schema.inference import of_study, wilson_interval
from squealpipe.study.claims.evidence import Run
from squealpipe.study.claims.statement import Statement

DECIDED = 0.1
"""Share of the feasible set, or of its rest, below which exceptions are at the set's margin."""


@dataclass(frozen=True, kw_only=True)
class Standing:
    """How a statement stands to the inference.

    Attributes:
        basis: whether it was fitted or is predicted.
        share: of the feasible parameter sets in which it holds; NaN where it was fitted, where
            the inference does not judge it, and without feasible sets.
        count: number of those sets; 0 where there is no share.
        low, high: Wilson's interval of the share.
    """

    basis: Basis
    share: float = nan
    count: int = 0
    low: float = nan
    high: float = nan

    @property
    def divides(self) -> bool:
        """Whether the statement holds in one part of the feasible set and fails in another.

        The paper prints no parameters, so what it says then depends on those one takes.
        """
        return DECIDED < self.share < 1.0 - DECIDED


def standing(statement: Statement, run: Run) -> Standing:
    """How a statement stands to the inference of a run; ``unknown`` where the run has none."""
    if "parameter_inference" not in run:
        return Standing(basis=Basis.unknown)
    inference = of_study(run["parameter_inference"])
    if {statement.id, statement.consequence} & set(inference.statement.values.tolist()):
        return Standing(basis=Basis.fitted)
    count = int(inference.feasible_count)
    if not count or statement.consequence not in inference.consequence.values:
        return Standing(basis=Basis.predicted)
    share = float(inference.feasible_share.sel(consequence=statement.consequence))
    low, high = wilson_interval(round(share * count), count)
    return Standing(basis=Basis.predicted, share=share, count=count, low=low, high=high)
