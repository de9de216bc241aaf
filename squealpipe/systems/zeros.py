"""Zeros of smooth functions, one in each of many brackets, all of them together."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


def bracketed(
    function: Callable[[Vector], tuple[Vector, Vector]],
    bracket: tuple[Vector, Vector],
    ends: tuple[Vector, Vector],
    last_step: float,
) -> Vector:
    """Safeguarded Newton from the secant's zero; a step out of its bracket becomes half of it.

    Args:
        bracket, ends: where each zero lies between, and the values there, of opposite signs.
        last_step: largest step after which the zeros are known.
    """
    (low, high), (first, last) = bracket, ends
    place = low + (high - low) * first / (first - last)
    for _ in range(60 if place.size else 0):
        value, slope = function(place)
        before = (value > 0.0) == (first > 0.0)
        low, high = np.where(before, place, low), np.where(before, high, place)
        with np.errstate(all="ignore"):
            newton = place - value / slope
        inside = (newton >= low) & (newton <= high)
        previous, place = place, np.where(inside, newton, 0.5 * (low + high))
        if np.abs(place - previous).max() <= last_step:
            break
    return np.asarray(place)
