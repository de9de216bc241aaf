"""One system for all its mirror images, so that what is computed of them is the same."""

import math
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np

from squealpipe.parameters import Parameters


@dataclass(frozen=True)
class NormalForm:
    """A system among its mirror images: belt speed not negative, the stiffer spring first.

    x → −x turns (α1, α2, V) into (α2, α1, −V) with the springs exchanged, and naming the springs
    the other way round turns (α1, α2) into (π − α2, π − α1). What is computed in this form is
    the same for a system and all its images, bit for bit.

    Attributes:
        swaps: whether the springs changed places.
        mirrored: whether x changed its sign.
    """

    params: Parameters
    swaps: bool
    mirrored: bool

    @classmethod
    def of(cls, params: Parameters) -> Self:
        """The normal form of a system."""
        first, second = (params.k1, params.length1), (params.k2, params.length2)
        mirrored = params.belt_speed < 0.0
        swaps = first < second or (mirrored and first == second)
        if swaps:
            params = exchanged(params)
        return cls(params.with_(belt_speed=abs(params.belt_speed)), swaps, mirrored)

    def angles(self, alpha1: Any, alpha2: Any) -> tuple[Any, Any]:
        """The angles of springs 1 and 2 of the normal form, rad."""
        first, second = (alpha2, alpha1) if self.swaps else (alpha1, alpha2)
        return (
            (math.pi - first, math.pi - second)
            if self.swaps != self.mirrored
            else (first, second)
        )

    @property
    def sign(self) -> int:
        """Sign of x, velocities along the belt and turns of the system in this form."""
        return -1 if self.mirrored else 1

    def back(self, values: np.ndarray) -> np.ndarray:
        """An array over both angles of the normal form, over those of the system."""
        return values.T if self.swaps else values


def exchanged(params: Parameters) -> Parameters:
    """Return the same parameters with the properties of springs 1 and 2 exchanged."""
    other = {"1": "2", "2": "1"}
    names = [item.name for item in fields(params) if item.name[-1] in other]
    return params.with_(**{n: getattr(params, n[:-1] + other[n[-1]]) for n in names})
