"""Rules by which two datasets of one schema are compared where numbers alone do not suffice."""

from dataclasses import KW_ONLY, dataclass
from enum import Enum


class ComparedAs(Enum):
    """Part of a variable that can be the same on two machines."""

    magnitude = "order of magnitude"
    sample = "distribution of the sample"
    grown = "the digits that the growth of errors leaves"
    beyond_horizon = "distribution of the cells beyond the predictability horizon"
    most = "all values but a few"
    judged = "the values that both sides have judged"
    unjudged = "nothing"


@dataclass(frozen=True)
class RoundOff:
    """A variable whose digits round-off decides, and what is compared instead.

    Attributes:
        factor: magnitudes that differ by no more than this agree.
        floor: magnitudes below this are all the same.
        sample: the dimension along which the values are a sample.
        by: the variable that holds the growth of errors, or the outcome of a cell.
        share: of the values that may differ.
        none: flag of a value that was not judged.
    """

    compared: ComparedAs
    reason: str
    _: KW_ONLY
    factor: float = 10.0
    floor: float = 0.0
    sample: str = ""
    by: str = ""
    share: float = 0.0
    none: int = -1


@dataclass(frozen=True, kw_only=True)
class Listing:
    """A dimension that lists what was found, so its length follows from the result.

    Attributes:
        kinds: variables that say what an entry is; only entries of one kind are matched.
        position: variable along which an entry is matched with the nearest one, or the text whose
            first value names it; without it the n-th entry of a kind is matched with the n-th.
        fillers: entries whose first kind is one of these lie where a method's steps happened to
            end. Those at the same position are matched; another one must lie on the curve through
            the points of the other side. Their number is not a result.
    """

    kinds: tuple[str, ...] = ()
    position: str = ""
    fillers: tuple[int, ...] = ()


RAGGED = ("event", "point", "switch", "sample", "harmonic", "interval")
"""Dimensions whose length may differ from run to run of a sweep."""
