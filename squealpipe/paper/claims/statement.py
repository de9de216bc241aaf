"""A statement of the paper as data: one row, beside the check that judges it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from squealpipe.paper.claims.evidence import Finding
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.study.evidence import Evidence

Check = Callable[[Evidence], Finding]
"""Reads datasets only."""


@dataclass(frozen=True)
class Statement:
    """One statement, how it is checked, and what came out at the shipped baseline.

    Attributes:
        recorded: what the judge finds at the shipped baseline; anything else is a regression.
        check: reads datasets only; of the equations as they are printed.
        physics: what is asked of the physics with one sign, where that is another question.
        consequence: what the inference judges at each feasible parameter set and what decides
            about this statement there; empty where it judges nothing of the kind.
    """

    id: str
    section: str
    text: str
    figure: str
    recorded: ClaimVerdict
    check: Check
    consequence: str = ""
    physics: Check | None = None

    @property
    def measure(self) -> str:
        """Return what the check measures in words: the first paragraph of its docstring."""
        words = " ".join(str(self.check.__doc__).partition("\n\n")[0].split())
        return words[0].lower() + words[1:].removesuffix(".")


class StatementRows(list[Statement]):
    """The statements of one module, in the paper's order: each is added where its check stands."""

    def __init__(
        self,
        section: str = "",
        figure: str = "",
        recorded: ClaimVerdict = ClaimVerdict.holds,
    ) -> None:
        """With what most of them have."""
        super().__init__()
        self.common = {"section": section, "figure": figure, "recorded": recorded}

    def add(self, name: str, text: str, **more: Any) -> Callable[[Check], Check]:
        """Decorator of a check; the arguments are those of :class:`Statement`."""

        def keep(check: Check) -> Check:
            self.append(
                Statement(id=name, text=text, check=check, **{**self.common, **more})
            )
            return check

        return keep
