"""In how much of the inferred feasible set a statement holds."""

from __future__ import annotations

import numpy as np

from squealpipe.claims.evidence import Run

SAME_AS = {"F6b": ("F6c", "C2"), "F8c": ("E8",)}
"""Consequence of the inference → further statements that hold exactly where it does."""

OPPOSITE = {"F7_black": "E10"}
"""Consequence of the inference → statement that holds exactly where it does not."""

DECIDED = 0.1
"""Share of the feasible set, or of its rest, below which exceptions are at the set's margin."""


def undecided_by_paper(share: float) -> bool:
    """Whether a statement holds in one part of the feasible set and fails in another.

    The paper prints no parameters, so what it says then depends on those one takes.
    """
    return DECIDED < share < 1.0 - DECIDED


def feasible_shares(run: Run) -> dict[str, float]:
    """Id of a statement → share of the feasible parameter sets in which it holds.

    Statements that were constraints of the inference hold in all of them. Empty where the run
    has no inference or found no feasible set.
    """
    if "parameter_inference" not in run:
        return {}
    inference = run["parameter_inference"]
    run.forget()
    feasible = inference.feasible.values == 1
    if not feasible.any():
        return {}
    held = inference.holds.values[feasible].mean(axis=0)
    shares = dict(zip(map(str, inference.statement.values), map(float, held), strict=True))
    for name, share in zip(
        map(str, inference.consequence.values), inference.feasible_share.values, strict=True
    ):
        if not np.isnan(share):
            shares |= dict.fromkeys((name, *SAME_AS.get(name, ())), float(share))
            if name in OPPOSITE:
                shares[OPPOSITE[name]] = 1.0 - float(share)
    return shares
