"""How two datasets of one schema are held against each other where numbers alone do not do."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class ComparedAs(Enum):
    """What of a variable can be the same on two machines."""

    magnitude = "order of magnitude"
    sample = "distribution of the sample"


@dataclass(frozen=True, kw_only=True)
class RoundOff:
    """A variable whose digits round-off decides, and what is compared instead.

    Attributes:
        compared: as an order of magnitude, or as a sample of one distribution.
        reason: why no digit can be expected to agree.
        factor: magnitudes that differ by no more than this agree.
        floor: magnitudes below this are all the same.
        sample: the dimension along which the values are a sample.
    """

    compared: ComparedAs
    reason: str
    factor: float = 10.0
    floor: float = 0.0
    sample: str = ""


@dataclass(frozen=True, kw_only=True)
class Listing:
    """A dimension that lists what was found, so its length follows from the result.

    Attributes:
        kinds: variables that tell what an entry is; only entries of one kind are matched.
        position: variable along which an entry is matched with the nearest one; without it the
            n-th entry of a kind is matched with the n-th.
    """

    kinds: tuple[str, ...] = ()
    position: str = ""


def magnitude(reason: str, *, floor: float = 0.0, factor: float = 10.0) -> RoundOff:
    """Compared as an order of magnitude, or within another factor."""
    return RoundOff(compared=ComparedAs.magnitude, reason=reason, floor=floor, factor=factor)


def sampled(dim: str, reason: str) -> RoundOff:
    """Compared as a sample along a dimension."""
    return RoundOff(compared=ComparedAs.sample, reason=reason, sample=dim)
