"""How two datasets of one schema are held against each other where numbers alone do not do."""

from dataclasses import dataclass
from enum import Enum


class ComparedAs(Enum):
    """What of a variable can be the same on two machines."""

    magnitude = "order of magnitude"
    sample = "distribution of the sample"
    grown = "the digits that the growth of errors leaves"
    beyond_horizon = "distribution of the cells beyond the predictability horizon"
    most = "all values but a few"
    unjudged = "nothing"


@dataclass(frozen=True, kw_only=True)
class RoundOff:
    """A variable whose digits round-off decides, and what is compared instead.

    Attributes:
        factor: magnitudes that differ by no more than this agree.
        floor: magnitudes below this are all the same.
        sample: the dimension along which the values are a sample.
        by: the variable that holds the growth of errors, or the outcome of a cell.
        share: of the values that may differ.
    """

    compared: ComparedAs
    reason: str
    factor: float = 10.0
    floor: float = 0.0
    sample: str = ""
    by: str = ""
    share: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Listing:
    """A dimension that lists what was found, so its length follows from the result.

    Attributes:
        kinds: variables that say what an entry is; only entries of one kind are matched.
        position: variable along which an entry is matched with the nearest one; without it the
            n-th entry of a kind is matched with the n-th.
        filler: entries whose first kind is this lie where a method's steps happened to end. Only
            those at the same position are matched, and their number is not a result.
    """

    kinds: tuple[str, ...] = ()
    position: str = ""
    filler: int | None = None


def magnitude(reason: str, *, floor: float = 0.0, factor: float = 10.0) -> RoundOff:
    """Compared as an order of magnitude, or within another factor."""
    return RoundOff(compared=ComparedAs.magnitude, reason=reason, floor=floor, factor=factor)


def sampled(dim: str, reason: str) -> RoundOff:
    """Compared as a sample along a dimension."""
    return RoundOff(compared=ComparedAs.sample, reason=reason, sample=dim)


def grown(by: str, reason: str) -> RoundOff:
    """Compared to the digits that are left when round-off has grown by the factor in ``by``."""
    return RoundOff(compared=ComparedAs.grown, reason=reason, by=by)


def beyond_horizon(reason: str, by: str = "outcome") -> RoundOff:
    """Compared as numbers up to the predictability horizon, and as one sample beyond it."""
    return RoundOff(compared=ComparedAs.beyond_horizon, reason=reason, by=by)


def most(reason: str, share: float) -> RoundOff:
    """Compared as values, of which a share may differ."""
    return RoundOff(compared=ComparedAs.most, reason=reason, share=share)


def unjudged(reason: str) -> RoundOff:
    """Compared, but no difference counts."""
    return RoundOff(compared=ComparedAs.unjudged, reason=reason)
