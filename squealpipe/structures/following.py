"""Modes that keep their number from one friction to the next, by their shapes."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from squealpipe.structures.sliding import NoSlidingError
from squealpipe.structures.spectrum import Spectrum


def agreement(first: Spectrum, second: Spectrum) -> Any:
    """MAC |vᴴMv′|²/(vᴴMv · v′ᴴMv′) of all modes of two spectra, (first, second)."""
    mass = first.pencil.mass
    one, other = first.shapes, second.shapes
    product = np.abs(one.conj().T @ (mass @ other)) ** 2
    sizes = [
        np.einsum("ij,ij->j", each.conj(), mass @ each).real for each in (one, other)
    ]
    return product / np.outer(*sizes)


def successors(first: Spectrum, second: Spectrum) -> tuple[np.ndarray, np.ndarray]:
    """Return the place in the second of each mode of the first, −1 without one; and their MAC."""
    mac = agreement(first, second)
    distance = np.abs(first.values[:, None] - second.values[None, :])
    # relative to the larger of both, so that each part of the spectrum counts alike
    scale = np.maximum(np.abs(first.values)[:, None], np.abs(second.values)[None, :])
    near = np.minimum(distance / np.where(scale > 0, scale, 1.0), 1.0)
    # weight of the distance of eigenvalues, next to that of shapes
    cost = 1.0 - mac + 0.2 * near
    places = np.full(len(first.values), -1)
    shared = np.zeros(len(first.values))
    rows, columns = linear_sum_assignment(cost)
    places[rows], shared[rows] = columns, mac[rows, columns]
    _order_merged(places, first, second)
    _keep_twins(places, shared, first, second)
    return places, shared


def _keep_twins(
    places: np.ndarray, shared: np.ndarray, first: Spectrum, second: Spectrum
) -> None:
    """Two modes that have merged stay together while another passes: all three shapes are alike.

    Or they have parted, and one has merged with the other mode: nothing is said to be shared, so
    that the step is halved.
    """
    for row, value in enumerate(first.values):
        twins = np.flatnonzero(first.values == -value.conjugate())
        if value.real <= 0 or value.imag == 0 or not twins.size:
            continue
        both = [row, int(twins[0])]
        # either of both may be the one whose shape is nearer to the other mode
        for place in places[both]:
            reached = second.values[place]
            other = np.flatnonzero(second.values == -reached.conjugate())
            if place >= 0 and reached.real != 0 and reached.imag != 0 and other.size:
                break
        else:
            # they have parted: shapes do not tell them apart
            if places[both].min() >= 0:
                places[both] = sorted(places[both])
            continue
        pair = sorted((place, other[0]), key=lambda k: -second.values[k].real)
        if {*places[both]} != {*pair}:
            shared[both] = 0.0
        for mode, place in zip(both, pair, strict=True):
            holder = np.flatnonzero(places == place)
            places[holder], places[mode] = places[mode], place


def _order_merged(places: np.ndarray, first: Spectrum, second: Spectrum) -> None:
    """Let the first of two modes that have merged, and so have one shape, be the one that grows."""
    was_still = first.values.real == 0
    of_place = {int(place): row for row, place in enumerate(places) if place >= 0}
    for place, value in enumerate(second.values):
        if value.real >= 0 or value.imag == 0:
            continue
        twins = np.flatnonzero(second.values == -value.conjugate())
        if not twins.size or place not in of_place or int(twins[0]) not in of_place:
            continue
        falling, growing = of_place[place], of_place[int(twins[0])]
        if falling < growing and was_still[falling] and was_still[growing]:
            places[falling], places[growing] = places[growing], places[falling]


def followed(
    at: Callable[[float], Spectrum],
    low: float,
    high: float,
    relevant: Callable[[Spectrum], np.ndarray],
    halvings: int = 4,
) -> list[tuple[float, np.ndarray]]:
    """Frictions after ``low`` up to ``high`` with the places there of the modes at ``low``.

    Steps are halved where shapes of relevant modes change so much that numbers are in doubt.
    """
    first, second = at(low), at(high)
    places, shared = successors(first, second)
    kept = (places >= 0) & relevant(first)
    # least agreement of shapes (MAC) of one mode at neighbouring frictions
    if halvings == 0 or not kept.any() or shared[kept].min() >= 0.6:
        return [(high, places)]
    middle = 0.5 * (low + high)
    try:
        at(middle)
    except NoSlidingError:
        return [(high, places)]
    steps = followed(at, low, middle, relevant, halvings - 1)
    before = steps[-1][1]
    for mu, further in followed(at, middle, high, relevant, halvings - 1):
        steps.append((mu, np.where(before >= 0, further[before], -1)))
    return steps
