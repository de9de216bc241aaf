"""Jumps of steady sliding of a quiet brake to another equilibrium, which may be equally quiet.

Steady sliding may end in a fold: there the mass jumps to another balance, far away. Where that
one is quiet too, no verdict changes, and yet the pad has moved by millimetres. Along each cure the
place of steady sliding is followed over a few values; between two of them it either moves the
less the closer they are, or it snaps.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.vibration.boundaries import Cure


class SnapThrough(NamedTuple):
    """The nearest snap of one cure; NaN: none in the range.

    Attributes:
        value: of the cure, at which the place has snapped.
        distance: between both places, m.
    """

    value: float = math.nan
    distance: float = math.nan


def snap_throughs(
    cures: Mapping[str, Cure], limits: Mapping[str, float]
) -> dict[str, SnapThrough]:
    """Return the nearest snap-through of steady sliding along each cure.

    Args:
        limits: value of each beyond which the brake is no longer quiet; NaN or none: its range.
    """
    by_angle = {}
    for name, cure in cures.items():
        limit = limits.get(name, math.nan)
        reach = math.inf if math.isnan(limit) else abs(limit - cure.value)
        nearest = SnapThrough()
        for side in (cure.below, cure.above):
            values = side[np.abs(side - cure.value) <= reach]
            snap = _first_snap(cure, values)
            if not abs(nearest.value - cure.value) <= abs(snap.value - cure.value):
                nearest = snap
        by_angle[name] = nearest
    return by_angle


def _first_snap(cure: Cure, values: np.ndarray) -> SnapThrough:
    """The first along the values of a side, outward."""
    # values of each side at which the equilibrium is looked up; a jump and its return between two
    # of them are missed
    places = np.unique(np.linspace(0, values.size - 1, 12).astype(int))
    inner, before = cure.value, _place(cure.apply(cure.value))
    for value in values[places] if values.size else ():
        after = _place(cure.apply(float(value)))
        if before is None or after is None:
            break  # without steady sliding the brake is not quiet
        if snap := _snap(cure, (inner, float(value)), (before, after)):
            return snap
        inner, before = float(value), after
    return SnapThrough()


def _snap(
    cure: Cure, ends: tuple[float, float], places: tuple[np.ndarray, np.ndarray]
) -> SnapThrough | None:
    """The snap between two values, if the way between their places does not shrink with theirs."""
    (inner, outer), (before, after) = ends, places
    whole = math.dist(before, after)
    if whole < 0.1 * cure.apply(cure.value).params.preload:
        return None  # less is no snap that anybody would notice
    # after twenty halvings the equilibrium still jumps: it does so between them
    for number in range(20):
        middle = 0.5 * (inner + outer)
        place = _place(cure.apply(middle))
        if place is None:
            return None
        if math.dist(before, place) >= math.dist(place, after):
            outer, after = middle, place
        else:
            inner, before = middle, place
        # a path halves with each halving, one that ends in a fold at least by its root
        if math.dist(before, after) < 0.5 * whole and number > 5:
            return None
    return SnapThrough(outer, math.dist(before, after))


def _place(design: Design) -> np.ndarray | None:
    sliding = Sliding.of(design)
    return None if sliding is None else sliding.state[:2]
