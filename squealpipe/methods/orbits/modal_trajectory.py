"""Any motion of a piecewise-linear system from rest, by closed-form flow from switch to switch."""

from __future__ import annotations

from typing import Any

import numpy as np

from squealpipe.methods.compiled import compiled
from squealpipe.methods.orbits.modal_flow import (
    GIVEN_UP,
    advance,
    copy_state,
    next_crossing,
    propagator,
)

MAX_SWITCHES = 100_000


@compiled
def trajectory_from_rest(rows: Any, times: Any, out: Any) -> int:
    """Fill ``out`` (n, 4) with (x, y, vx, vy) at ascending times of a motion from x = y = 0.

    Args:
        rows: (2, 12) state rows, below and above the threshold (which is above y = 0).
        times: ascending, from 0.
        out: filled.

    Returns:
        The number of switches until the last time, or −1 if one was not found or too many were.
    """
    start, scratch = np.zeros(4), np.empty(8)
    side, begin, index = 0, 0.0, 0
    last = times[len(times) - 1]
    for count in range(MAX_SWITCHES):
        row = rows[side]
        crossing = next_crossing(row, start, 2.0 * side - 1.0, last - begin)
        if crossing == GIVEN_UP:
            return -1
        end = last if crossing < 0.0 else begin + crossing
        while index < len(times) and times[index] <= end:
            propagator(row, times[index] - begin, scratch)
            copy_state(start, out[index])
            advance(row, scratch, out[index])
            index += 1
        if crossing < 0.0:
            return count
        propagator(row, crossing, scratch)
        advance(row, scratch, start)
        start[1] = row[11]
        begin, side = end, 1 - side
    return -1
