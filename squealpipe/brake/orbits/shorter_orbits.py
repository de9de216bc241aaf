"""Meetings of a branch of symmetric orbits with shorter ones, of half the period to a seventh."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.orbits.orbit_shape import sample
from squealpipe.brake.orbits.orbits import Orbit
from squealpipe.brake.orbits.piecewise_linear import PiecewiseLinearSystem
from squealpipe.systems.continuation import length_of


@dataclass(frozen=True)
class SameOrbit:
    """Distances by which an orbit is told to be another one run through several times."""

    same_state: float = 1e-8
    """Distance over 1 + |z| below which two states are one, or one next to where branches meet."""
    nearly_same: float = 1e-3
    """Distance over 1 + |z| below which two states are one, or one next to where branches meet."""


def _apart(system: PiecewiseLinearSystem, orbit: Orbit) -> NDArray[np.float64]:
    """States after T/n less the first one, (6, 4)."""
    states = sample(system.rows, orbit.point, 2.0 * math.pi / np.arange(7, 1, -1))
    return np.asarray(states - [*orbit.point[:2], 0.0, 0.0])


def is_primitive(
    system: PiecewiseLinearSystem, orbit: Orbit, near: float = SameOrbit.same_state
) -> bool:
    """Return whether an orbit is not a shorter one that is run through several times.

    ``near`` is the distance over 1 + |z| below which two states count as one.
    """
    apart = np.abs(_apart(system, orbit)).sum(axis=1)
    return bool(apart.min() >= near * (1.0 + length_of(orbit.point)))


def about_to_meet(system: PiecewiseLinearSystem, orbit: Orbit) -> bool:
    """Return whether an orbit is a shorter one run through several times, or nearly and next to it.

    Where its branch meets that one's the stability index is 2.
    """
    # a step meets shorter orbits only where the stability index is near 2: below ½ none is
    # checked for
    if not orbit.stability_index > 0.5:
        return False
    next_to_it = abs(orbit.stability_index - 2.0) < SameOrbit.nearly_same
    near = SameOrbit.nearly_same if next_to_it else SameOrbit.same_state
    return not is_primitive(system, orbit, near)


def shorter_orbit_between(
    system: PiecewiseLinearSystem, first: Orbit, last: Orbit
) -> bool:
    """Return whether a branch of shorter orbits lies between two orbits or holds the second.

    At a shorter orbit the state after T/n is the initial one; its distance turns round there.
    """
    if not is_primitive(system, last, SameOrbit.nearly_same):
        return True
    before, after = _apart(system, first), _apart(system, last)
    size = np.abs(before).sum(axis=1) * np.abs(after).sum(axis=1)
    return bool(((before * after).sum(axis=1) < -0.2 * size).any())
