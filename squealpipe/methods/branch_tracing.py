"""Tracing a branch of symmetric orbits by pseudo-arclength, compiled.

The unknowns are z = (x0, y0, T/2), in scaled units of order one. Three unknowns allow closed
forms for tangent and corrector; :mod:`squealpipe.methods.continuation` is the general method.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from squealpipe.methods.compiled import compiled
from squealpipe.methods.shooting import (
    MAX_SEGMENTS,
    shoot,
    solve_constrained,
    stability_index,
)

REACHED, RETURNED, TONGUE_END, BRANCH_LOST, STEP_LIMIT = range(5)
"""Why a trace ended: y_peak reached, back at the threshold, the orbit's period halved and the
branch would be retraced, no step small enough converged, or too many points."""

COLUMNS = ("x0", "y0", "half_period", "end_x", "end_y", "index", "residual", "switches")
"""Columns of a traced point."""


@compiled
def record(
    rows: Any, point: Any, segments: Any, count: int, final: Any, residual: float, out: Any
) -> None:
    """Fill one row of the table of points."""
    out[0], out[1], out[2] = point[0], point[1], point[2]
    out[3], out[4] = final[0], final[1]
    out[5] = stability_index(rows, segments, count)
    out[6], out[7] = residual, count - 1


@compiled
def orbit_at(rows: Any, start: Any, out: Any, switches: Any) -> bool:
    """The orbit at the y0 of ``start``, by Newton from its x0 and T/2; False if not found."""
    point = start.copy()
    segments, final, tangent = np.empty((MAX_SEGMENTS, 9)), np.empty(4), np.empty(3)
    keep_peak = np.zeros(3)
    keep_peak[1] = 1.0
    count, _, residual = solve_constrained(
        rows, point, keep_peak, segments, switches, final, tangent
    )
    if count == 0:
        return False
    record(rows, point, segments, count, final, residual, out)
    return True


@compiled
def trace(
    rows: Any,
    start: Any,
    direction: Any,
    y_stop: float,
    first_step: float,
    longest_step: float,
    least_cosine: float,
    table: Any,
) -> tuple[int, int]:
    """Follow the branch from ``start`` along ``direction`` until y0 reaches ``y_stop``.

    A step is accepted only if Newton's method converges fast, close to the prediction, and the
    branch has turned by little (``least_cosine``), so the branch is not left for another one.

    Args:
        rows: state rows. start: (3,) a solution on the branch. direction: (3,) its tangent.
        first_step, longest_step: arclength, relative to 1 + |z|.
        table: (n, 8) filled with points (:data:`COLUMNS`); its length bounds the trace.

    Returns:
        (number of points, why it ended).
    """
    threshold = rows[0, 11]
    segments, switches, final = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS), np.empty(4)
    here, ahead, trial, tangent = start.copy(), direction.copy(), np.empty(3), np.empty(3)
    step = first_step
    count = 0
    while count < table.shape[0]:
        scale = 1.0 + np.sqrt(here[0] ** 2 + here[1] ** 2 + here[2] ** 2)
        length = step * scale
        trial[:] = here + length * ahead
        legs, iterations, residual = solve_constrained(
            rows, trial, ahead, segments, switches, final, tangent
        )
        accepted = legs > 0
        if accepted:
            cosine = tangent[0] * ahead[0] + tangent[1] * ahead[1] + tangent[2] * ahead[2]
            if cosine < 0.0:
                tangent *= -1.0
                cosine = -cosine
            off = np.sqrt(np.sum((trial - here - length * ahead) ** 2))
            accepted = cosine > least_cosine and off < 0.3 * length
        if not accepted:
            step *= 0.5
            if step < 1e-9:
                return count, BRANCH_LOST
            continue
        if trial[1] >= y_stop:
            return _stop_at(rows, here, trial, y_stop, table, count)
        record(rows, trial, segments, legs, final, residual, table[count])
        count += 1
        if trial[1] <= threshold:
            return count, RETURNED
        if final[1] > trial[1]:
            if abs(final[0] - trial[0]) < 3.0 * length:
                return count, TONGUE_END
            # the other instant of rest is the higher one from here on: count from there
            here[0], here[1], here[2] = trial[0], trial[1], trial[2]
            _change_end(rows, here, tangent, final, length)
        else:
            here[:] = trial
        ahead[:] = tangent
        if iterations <= 5:
            step = min(1.6 * step, longest_step)
    return count, STEP_LIMIT


@compiled
def _stop_at(
    rows: Any, here: Any, trial: Any, y_stop: float, table: Any, count: int
) -> tuple[int, int]:
    """Interpolate between two accepted points to y_stop and solve there."""
    weight = (y_stop - here[1]) / (trial[1] - here[1])
    start = here + weight * (trial - here)
    start[1] = y_stop
    if not orbit_at(rows, start, table[count], np.empty(MAX_SEGMENTS)):
        return count, BRANCH_LOST
    return count + 1, REACHED


@compiled
def _change_end(rows: Any, here: Any, tangent: Any, final: Any, length: float) -> None:
    """Describe point and tangent from the other instant of rest (by a short difference)."""
    small = 1e-6 * length
    segments, switches, moved = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS), np.empty(4)
    near = here + small * tangent
    shoot(rows, near[0], near[1], near[2], segments, switches, moved)
    change = np.array([moved[0] - final[0], moved[1] - final[1], small * tangent[2]])
    here[0], here[1] = final[0], final[1]
    tangent[:] = change / np.sqrt(np.sum(change**2))
