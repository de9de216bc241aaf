"""Decision that a run has settled on a cycle: by its further returns, not by one near return.

A chaotic motion and a torus come as near to themselves as one likes if one waits for it, and next
to a near return there is often a cycle, which the motion only passes. So the distance between the
run and the cycle is followed over four equal parts of a stretch of time: it has to vanish, or to
shrink from part to part towards a cycle that attracts.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.cycles.solution import Cycle


@dataclass(frozen=True)
class ApproachRules:
    """Rules by which a motion counts as one that approaches a cycle.

    Attributes:
        quarters: parts of the watched time whose distances from the cycle are compared.
        on_cycle: distance from a cycle, over its extent, of a motion that is on it. Doubling it
            takes motions for arrived that still approach.
    """

    quarters: int = 4
    on_cycle: float = 1e-6


class Approach(IntEnum):
    """Course of a run next to a cycle."""

    leaves = 0
    """it does not come nearer, or the cycle is unstable"""
    nears = 1
    """it comes nearer, but is too far away to tell"""
    settles = 2


def approach(cycle: Cycle, distances: Vector, periods: float) -> Approach:
    """Return the course of a run next to a cycle.

    Args:
        distances: over the cycle's extent in each quarter, (4,).
        periods: of the cycle in a quarter.
    """
    if distances[-1] <= ApproachRules.on_cycle:
        return Approach.settles
    # distance over the extent within which a shrinking motion has no other cycle to go to
    near = 0.05
    if cycle.is_family_member and distances.max() <= near:
        return Approach.settles  # nothing settles there: the motion is next to a member
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = np.log(distances[1:] / distances[:-1])
    if not (cycle.is_stable and (rates < 0.0).all()):
        return Approach.leaves
    own = periods * np.log(
        max(float(np.abs(cycle.nontrivial).max(initial=0.0)), 1e-300)
    )
    # the rate at which the motion shrinks may differ so much from the multipliers' own
    factor = 2.0
    alike = ((rates > factor * own) & (rates < own / factor)).all()
    return Approach.settles if alike or distances[-1] <= near else Approach.nears


def distances_in_step(cycle: Cycle, times: Vector, states: Vector) -> Vector:
    """Distance of each state of a forced run from the cycle's at the same instant.

    Args:
        times: of the forcing's clock, s.
    """
    there, _ = cycle.states_at((cycle.phase + times) % cycle.period)
    return np.asarray(np.abs((states - there) / cycle.extent).max(axis=1))


def distances_from_orbit(cycle: Cycle, states: Vector) -> Vector:
    """Distance of each state from the nearest one of the cycle."""
    times = cycle.instants
    path, _ = cycle.states_at((cycle.phase + times) % cycle.period)
    offsets = (states[:, None] - path) / cycle.extent
    nearest = np.argmin(np.abs(offsets).max(axis=2), axis=1)
    low, high = (times[np.clip(nearest + k, 0, len(times) - 1)] for k in (-1, 1))
    best = np.abs(offsets[np.arange(len(states)), nearest]).max(axis=1)
    at, small = times[nearest], 1e-6 * cycle.period
    # four refinements: each divides the spacing of the nearest samples
    for _ in range(4):
        # Gauss and Newton's step along the orbit; beside an event it may be a poor one
        ends = [
            cycle.states_at((cycle.phase + at + k * small) % cycle.period)[0]
            for k in (-0.5, 0.5)
        ]
        middle = (states - 0.5 * (ends[0] + ends[1])) / cycle.extent
        along = (ends[1] - ends[0]) / cycle.extent
        squared = np.maximum((along**2).sum(axis=1), 1e-300)
        at = np.clip(at + small * (middle * along).sum(axis=1) / squared, low, high)
        here, _ = cycle.states_at((cycle.phase + at) % cycle.period)
        best = np.fmin(best, np.abs((states - here) / cycle.extent).max(axis=1))
    return np.asarray(best)
