"""A statement of the paper as data."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from squealpipe.claims.evidence import Finding, Run
from squealpipe.schema.claims import Verdict


@dataclass(frozen=True, kw_only=True)
class Statement:
    """One statement, how it is checked, and what came out at the shipped baseline.

    Attributes:
        id: row of the claims table.
        section: where the paper says it.
        text: the statement in our own words.
        measure: what the check measures, in words.
        figure: picture that shows it; empty where none does.
        recorded: what its check finds at the shipped baseline; anything else is a regression.
        check: reads datasets only.
    """

    id: str
    section: str
    text: str
    measure: str
    figure: str
    recorded: Verdict
    check: Callable[[Run], Finding]
