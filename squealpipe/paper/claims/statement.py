"""Statements of the paper: each is one row of the claims table, with the check that judges it.

A module of checks makes a :class:`StatementRows` and decorates each check with its ``add``, so that
the paper's sentence stands above the code that decides about it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from squealpipe.paper.claims.evidence import Finding
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.study.evidence import Evidence

Check = Callable[[Evidence], Finding]
"""Function from the datasets of a run to a verdict; it computes nothing from models."""


@dataclass(frozen=True)
class Statement:
    """One statement of the paper and the check that judges it.

    Attributes:
        id: short name, like ``"F6b"``.
        section, figure: place in the paper.
        text: the paper's sentence.
        recorded: verdict at the shipped baseline; a different one is a regression.
        check: judges the equations as they are printed.
        physics: judges the corrected equations (one sign of friction), if the question differs.
        consequence: criterion by which the inference judges this statement at each feasible
            parameter set; empty if it does not.
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
    """Statements of one module, in the paper's order.

    Args:
        section, figure, recorded: defaults of most statements of the module.
    """

    def __init__(
        self,
        section: str = "",
        figure: str = "",
        recorded: ClaimVerdict = ClaimVerdict.holds,
    ) -> None:
        """Keep the defaults."""
        super().__init__()
        self.common = {"section": section, "figure": figure, "recorded": recorded}

    def add(self, name: str, text: str, **more: Any) -> Callable[[Check], Check]:
        """Return a decorator that adds a check as the statement ``name``.

        Args:
            more: attributes of :class:`Statement` that differ from the module's defaults.
        """

        def add_check(check: Check) -> Check:
            self.append(
                Statement(id=name, text=text, check=check, **{**self.common, **more})
            )
            return check

        return add_check
