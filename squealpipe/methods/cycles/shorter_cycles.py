"""Where a branch of cycles meets shorter ones, of half the period or a third of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from squealpipe.methods.continuation import ContinuationState
from squealpipe.methods.cycles.cycles import Cycle, common_scale
from squealpipe.methods.cycles.event_flow import Vector, sample_path

_PHASES = 12
"""Instants at which a cycle is compared with itself a part of the period later."""
_LEVEL = 0.2
"""Change of the parameter at such a crossing, over that before, which is none."""


def after_part(cycle: Cycle, parts: int) -> Vector:
    """How far states after a part of the period are from those before, over its extent, (48,)."""
    times = np.arange(_PHASES) / _PHASES * cycle.period
    path = sample_path(cycle.segments, times)
    path /= common_scale(path)
    return np.asarray(np.roll(path, _PHASES // parts, axis=0) - path).ravel()


def is_shorter(cycle: Cycle, parts: int, near: float, close: float) -> bool:
    """Whether a cycle is a shorter one run through several times, where branches meet.

    There a second multiplier is 1; a shorter one with another multiplier is only passed nearby.
    """
    second = float(np.abs(cycle.multipliers[1:] - 1.0).min())
    return bool(np.linalg.norm(after_part(cycle, parts)) < near and second < close)


def at_crossing(before: ContinuationState, met: ContinuationState) -> ContinuationState:
    """A point where two branches cross, with the tangent of the one that led to it.

    At a cycle of half the period the parameter turns back by symmetry, which is not a fold.
    """
    chord = met.point - before.point
    tangent = 2.0 * chord / np.linalg.norm(chord) - before.tangent
    if abs(tangent[5]) < _LEVEL * abs(before.tangent[5]):
        tangent[5] = 0.0
    return replace(met, tangent=tangent / np.linalg.norm(tangent))
