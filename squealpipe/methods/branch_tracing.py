"""Tracing a branch of symmetric orbits by pseudo-arclength, compiled.

The unknowns are z = (x0, y0, T/2), in scaled units of order one. Three unknowns allow closed
forms for tangent and corrector; :mod:`squealpipe.methods.continuation` is the general method.
Arrays are handled element by element: whole-array expressions triple the time to compile.
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

REACHED, RETURNED, TONGUE_END, BRANCH_LOST, STEP_LIMIT, DIVERGED, GOES_ON = range(7)
"""Why a trace ended: y_peak reached; back on the linear mode; the orbit is another mode's, run
through several times (at twice, the branch would be retraced from here on); no step small enough
converged; too many points; or x0 grew without bound beside y (an internal resonance)."""

COLUMNS = ("x0", "y0", "half_period", "end_x", "end_y", "index", "residual", "switches")
"""Columns of a traced point."""

_TRACE_TOLERANCE = 1e-9
_SHORTEST_STEP = 1e-12
_EASY_ITERATIONS = 3


@compiled
def _norm(vector: Any) -> float:
    return float(np.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]))


@compiled
def _dot(left: Any, right: Any) -> float:
    return float(left[0] * right[0] + left[1] * right[1] + left[2] * right[2])


@compiled
def orbit_at(rows: Any, point: Any, out: Any, switches: Any) -> bool:
    """The orbit at the y0 of ``point``, by Newton from its x0 and T/2, polished to round-off.

    Fills ``point`` (3,), ``out`` (8,) with :data:`COLUMNS` and ``switches``; False if not found.
    """
    segments, final, tangent = np.empty((MAX_SEGMENTS, 9)), np.empty(4), np.empty(3)
    keep_peak = np.zeros(3)
    keep_peak[1] = 1.0
    count, _, residual = solve_constrained(
        rows, point, keep_peak, 0.0, segments, switches, final, tangent
    )
    if count == 0:
        return False
    out[0], out[1], out[2] = point[0], point[1], point[2]
    out[3], out[4] = final[0], final[1]
    out[5] = stability_index(rows, segments, count)
    out[6], out[7] = residual, count - 1
    return True


@compiled
def _change_end(rows: Any, here: Any, ahead: Any, final: Any, length: float) -> None:
    """Describe point and direction from the other instant of rest (by a short difference)."""
    small = 1e-6 * length
    segments, switches, moved = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS), np.empty(4)
    shoot(
        rows,
        here[0] + small * ahead[0],
        here[1] + small * ahead[1],
        here[2] + small * ahead[2],
        segments,
        switches,
        moved,
    )
    ahead[0], ahead[1], ahead[2] = moved[0] - final[0], moved[1] - final[1], small * ahead[2]
    here[0], here[1] = final[0], final[1]
    norm = _norm(ahead)
    for index in range(3):
        ahead[index] /= norm


@compiled
def _covers_shorter_orbit(rows: Any, here: Any, apart: Any, segments: Any, switches: Any) -> bool:
    """Whether the last step went through an orbit of a third or a fifth of the period.

    There the state after T/n is the initial one; ``apart`` (2, 4) holds their difference for
    n = 3, 5, which turns round when the branch passes through such an orbit.
    """
    passed = False
    state = np.empty(4)
    for index in range(2):
        shoot(rows, here[0], here[1], 2.0 * here[2] / (3 + 2 * index), segments, switches, state)
        state[0] -= here[0]
        state[1] -= here[1]
        product, size, size_before = 0.0, 0.0, 0.0
        for entry in range(4):
            product += state[entry] * apart[index, entry]
            size += state[entry] * state[entry]
            size_before += apart[index, entry] * apart[index, entry]
            apart[index, entry] = state[entry]
        passed = passed or product < -0.7 * np.sqrt(size * size_before)
    return passed


@compiled
def _step(
    rows: Any,
    here: Any,
    ahead: Any,
    control: Any,
    work: Any,
    segments: Any,
    switches: Any,
) -> tuple[float, int]:
    """One accepted step: ``here`` and ``ahead`` move on.

    Returns its length, or 0 if no step is accepted, and the orbit's number of segments.

    A step is accepted only if Newton's method converges close to the prediction and the branch
    has turned by little, so the branch is not left for another one. ``control`` holds the step
    (relative to 1 + |z|, adapted in place), the longest step and the least cosine of the turn;
    ``work`` (3, 4) receives the trial point, its tangent and the state after half a period.
    """
    trial, tangent, final = work[0], work[1], work[2]
    while control[0] >= _SHORTEST_STEP:
        length = control[0] * (1.0 + _norm(here))
        for index in range(3):
            trial[index] = here[index] + length * ahead[index]
        legs, iterations, _ = solve_constrained(
            rows, trial, ahead, _TRACE_TOLERANCE, segments, switches, final, tangent
        )
        if legs > 0:
            cosine = _dot(tangent, ahead)
            sign = 1.0 if cosine > 0.0 else -1.0
            off = 0.0
            for index in range(3):
                off += (trial[index] - here[index] - length * ahead[index]) ** 2
            if sign * cosine > control[2] and off < 0.09 * length * length:
                for index in range(3):
                    here[index], ahead[index] = trial[index], sign * tangent[index]
                if iterations <= _EASY_ITERATIONS:
                    control[0] = min(2.0 * control[0], control[1])
                return length, legs
        control[0] *= 0.5
    return 0.0, 0


@compiled
def trace(
    rows: Any,
    start: Any,
    direction: Any,
    y_stop: float,
    control: Any,
    record: bool,
    table: Any,
    switches: Any,
) -> tuple[int, int]:
    """Follow the branch from ``start`` along ``direction`` until y0 reaches ``y_stop``.

    Args:
        rows: state rows. start: (3,) a solution on the branch. direction: (3,) its tangent.
        control: (5,) step, longest step, least cosine of a turn, most steps, largest |x0|.
        record: whether every point is polished and kept, or the one at ``y_stop`` alone.
        table: (n, 8) filled with points (:data:`COLUMNS`).
        switches: (MAX_SEGMENTS,) filled with the switching times of the last point.

    Returns:
        (number of points kept, why it ended).
    """
    segments, apart = np.empty((MAX_SEGMENTS, 9)), np.zeros((2, 4))
    here, ahead, before, work = start.copy(), direction.copy(), start.copy(), np.empty((3, 4))
    final = work[2]
    count = 0
    for _ in range(int(control[3])):
        for index in range(3):
            before[index] = here[index]
        length, legs = _step(rows, here, ahead, control, work, segments, switches)
        if length == 0.0:
            return count, BRANCH_LOST
        if here[1] >= y_stop:
            found = _arrive(rows, before, here, y_stop, table[count], switches)
            return (count + 1, REACHED) if found else (count, BRANCH_LOST)
        if record:
            if not orbit_at(rows, here, table[count], switches):
                return count, BRANCH_LOST
            count += 1
        end = _end_met(rows, here, control, final, length, legs, apart, segments)
        if end != GOES_ON:
            return count, end
        if final[1] > here[1]:
            # the other instant of rest is the higher one from here on: count from there
            _change_end(rows, here, ahead, final, length)
            for index in range(4):
                apart[0, index] = apart[1, index] = 0.0
    return count, STEP_LIMIT


@compiled
def _arrive(rows: Any, before: Any, here: Any, y_stop: float, out: Any, switches: Any) -> bool:
    """The orbit at y_stop, from the points on both sides of it."""
    weight = (y_stop - before[1]) / (here[1] - before[1])
    for index in range(3):
        before[index] += weight * (here[index] - before[index])
    before[1] = y_stop
    return orbit_at(rows, before, out, switches)


@compiled
def _end_met(
    rows: Any,
    here: Any,
    control: Any,
    final: Any,
    length: float,
    legs: int,
    apart: Any,
    segments: Any,
) -> int:
    """Why the branch ends at this point, or ``GOES_ON``."""
    if here[1] <= rows[0, 11] and legs == 1:
        return RETURNED
    if abs(here[0]) > control[4]:
        return DIVERGED
    if _covers_shorter_orbit(rows, here, apart, segments, np.empty(MAX_SEGMENTS)):
        return TONGUE_END
    if final[1] > here[1] and abs(final[0] - here[0]) < 3.0 * length:
        return TONGUE_END
    return GOES_ON
