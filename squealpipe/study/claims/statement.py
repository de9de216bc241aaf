"""A statement of the paper as data: one row, beside the check that judges it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from squealpipe.schema.claims import Verdict
from squealpipe.study.claims.evidence import Finding, Run

Check = Callable[[Run], Finding]
"""Reads datasets only."""


@dataclass(frozen=True)
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
        consequence: what the inference judges at each feasible parameter set and what decides
            about this statement there; empty where it judges nothing of the kind.
    """

    id: str
    section: str
    text: str
    measure: str
    figure: str
    recorded: Verdict
    check: Check
    consequence: str = ""


class Rows(list[Statement]):
    """The statements of one module, in the paper's order: each is added where its check stands."""

    def add(
        self,
        name: str,
        section: str,
        text: str,
        measure: str,
        figure: str,
        recorded: Verdict,
        *,
        consequence: str = "",
    ) -> Callable[[Check], Check]:
        """Decorator of a check; the arguments are those of :class:`Statement`."""

        def keep(check: Check) -> Check:
            self.append(
                Statement(name, section, text, measure, figure, recorded, check, consequence)
            )
            return check

        return keep
