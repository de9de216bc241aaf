"""What a branch of cycles consists of, and why it ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from squealpipe.methods.continuation import ContinuationState
from squealpipe.methods.cycles.cycles import Cycle
from squealpipe.methods.cycles.labels import Label

_SMALL = 1e-3
"""Size of a cycle, over the largest on its branch, below which one that shrinks comes to rest."""


class BranchEnd(IntEnum):
    """Why a branch ended."""

    arrived = 0
    """at the value that was asked for"""
    returned = 1
    """at the value that it started from, on another cycle"""
    lost = 2
    """no step is short enough"""
    point_limit = 3
    """as many points as were allowed"""
    at_rest = 4
    """the cycle has shrunk to a state of rest"""
    closed = 5
    """it has come back to its first part, in the same direction"""
    retraced = 6
    """it has come back to its first part, in the opposite direction"""
    shorter = 7
    """it has met a cycle of half the period or a third of it"""
    singular = 8
    """the cycle has come to where the field is not defined"""
    tangency = 9
    """a hold of the motion is just touched or ends at a tangent, beyond which the motion jumps"""


@dataclass(frozen=True)
class BranchPoint:
    """A cycle on a branch.

    Attributes:
        parameter: its value.
        cycle: the periodic motion.
        label: what is special about it.
        state: of the continuation.
    """

    parameter: float
    cycle: Cycle
    label: Label
    state: ContinuationState


def has_shrunk(points: Sequence[BranchPoint]) -> bool:
    """Whether the cycle, small by now, still shrinks: with events it is not followed to its end."""
    sizes = [float(np.diff(point.cycle.extent, axis=0).max()) for point in points]
    return len(sizes) > 1 and sizes[-1] < _SMALL * max(sizes) and sizes[-1] < sizes[-2]


@dataclass(frozen=True, kw_only=True)
class CycleBranchSettings:
    """How a branch is followed.

    Attributes:
        low, high: range of the parameter.
        max_points: points after which the branch ends.
        largest_change: of a multiplier between neighbouring points with the same events.
    """

    low: float
    high: float
    max_points: int
    largest_change: float = 1.0
