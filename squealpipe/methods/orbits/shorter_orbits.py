"""Where a branch of symmetric orbits meets shorter ones, of half the period down to a seventh."""

from typing import Any

import numpy as np

from squealpipe.methods.compiled import compiled
from squealpipe.methods.orbits.modal_flow import advance, propagator
from squealpipe.methods.orbits.shooting import (
    MAX_SEGMENTS,
    norm,
    shoot,
    stability_index,
)

_MOST_COVERS = 7
_SAME_STATE, _NEARLY_SAME = 1e-8, 1e-3
"""Distance over 1 + |z| below which two states are one, or one next to where branches meet."""
_MAY_COVER = 0.5
"""Least stability index at which a step is checked for having met shorter orbits, which have 2
where branches meet."""


@compiled
def _apart_after(
    rows: Any,
    point: Any,
    segments: Any,
    switches: Any,
    legs: int,
    covers: int,
    apart: Any,
) -> float:
    """How far the state after T/n is from the initial one; fills ``apart`` (4,)."""
    time, begin, leg, scratch = 2.0 * point[2] / covers, 0.0, 0, np.empty(8)
    apart[0], apart[1], apart[2], apart[3] = point[0], point[1], 0.0, 0.0
    while leg < legs - 1 and switches[leg] < time:
        advance(rows[int(segments[leg, 8])], segments[leg], apart)
        begin = switches[leg]
        leg += 1
    row = rows[int(segments[leg, 8])]
    propagator(row, time - begin, scratch)
    advance(row, scratch, apart)
    apart[0] -= point[0]
    apart[1] -= point[1]
    return float(abs(apart[0]) + abs(apart[1]) + abs(apart[2]) + abs(apart[3]))


@compiled
def shorter_orbit(
    rows: Any, point: Any, segments: Any, switches: Any, legs: int, near: float
) -> int:
    """How often an orbit runs through a shorter one, up to 7 times; 1 if it is none.

    ``near`` is the distance over 1 + |z| below which two states count as one.
    """
    apart = np.empty(4)
    near *= 1.0 + norm(point)
    for covers in range(2, _MOST_COVERS + 1):
        if _apart_after(rows, point, segments, switches, legs, covers, apart) < near:
            return covers
    return 1


@compiled
def about_to_meet(
    rows: Any, point: Any, segments: Any, switches: Any, legs: int
) -> bool:
    """Whether an orbit is a shorter one run through several times, or nearly and next to it.

    Where its branch meets that one's the stability index is 2.
    """
    index = stability_index(rows, segments, legs)
    if not index > _MAY_COVER:
        return False
    near = _NEARLY_SAME if abs(index - 2.0) < _NEARLY_SAME else _SAME_STATE
    return shorter_orbit(rows, point, segments, switches, legs, near) > 1


@compiled
def times_run_through(rows: Any, point: Any) -> int:
    """As :func:`shorter_orbit`, for a point alone; 0 where the shot fails."""
    segments = np.empty((MAX_SEGMENTS, 9))
    switches = np.empty(MAX_SEGMENTS)
    final = np.empty(4)
    legs = shoot(rows, point[0], point[1], point[2], segments, switches, final)
    return (
        0
        if legs == 0
        else shorter_orbit(rows, point, segments, switches, legs, _SAME_STATE)
    )


@compiled
def shorter_orbit_between(
    rows: Any, here: Any, trial: Any, segments: Any, switches: Any, legs: int
) -> bool:
    """Whether a branch of shorter orbits lies between two points or holds the second.

    At a shorter orbit the state after T/n is the initial one; its distance turns round there.
    The shot belongs to ``trial``.
    """
    if shorter_orbit(rows, trial, segments, switches, legs, _NEARLY_SAME) > 1:
        return True
    before, after, final = np.empty(4), np.empty(4), np.empty(4)
    segments_here, switches_here = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS)
    legs_here = shoot(
        rows, here[0], here[1], here[2], segments_here, switches_here, final
    )
    for covers in range(2, _MOST_COVERS + 1):
        size = _apart_after(rows, trial, segments, switches, legs, covers, after)
        size *= _apart_after(
            rows, here, segments_here, switches_here, legs_here, covers, before
        )
        product = 0.0
        for index in range(4):
            product += before[index] * after[index]
        if product < -0.2 * size:
            return True
    return False
