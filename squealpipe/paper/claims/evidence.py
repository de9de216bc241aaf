"""Findings of the checks: the deciding number, its comparison and the verdict."""

from operator import ge, gt, le, lt
from typing import NamedTuple

import numpy as np

from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.study.evidence import MissingDataError
from squealpipe.systems.inputs.words import as_people_write


class Finding(NamedTuple):
    """Result of one check.

    Attributes:
        value, relation, threshold: the deciding number and the comparison that it passes or not.
    """

    verdict: ClaimVerdict
    value: float
    relation: str
    threshold: float
    evidence: str


def passes(value: float, relation: str, threshold: float) -> bool:
    """Return whether the comparison is true; an equality includes its
    tolerance in the threshold.
    """
    return bool({"<": lt, "≤": le, ">": gt, "≥": ge}[relation](value, threshold))


def finding(
    compared: tuple[float, str, float],
    evidence: str,
    *,
    otherwise: ClaimVerdict = ClaimVerdict.fails,
    passed: ClaimVerdict = ClaimVerdict.holds,
    also: bool = True,
) -> Finding:
    """A finding from one comparison.

    Args:
        otherwise, passed: verdicts when the comparison is false and true.
        also: further conditions, all of which must be true as well.
    """
    value, relation, threshold = compared
    if np.isnan(value):
        raise MissingDataError(f"nothing to compare: {evidence}")
    verdict = passed if passes(*compared) and also else otherwise
    return Finding(
        verdict, float(value), relation, float(threshold), as_people_write(evidence)
    )
