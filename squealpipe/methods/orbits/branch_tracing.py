"""Tracing a branch of symmetric orbits by pseudo-arclength up to a given peak, compiled."""

from typing import Any

import numpy as np

from squealpipe.methods.compiled import compiled
from squealpipe.methods.orbits import branch_steps as steps
from squealpipe.methods.orbits import shooting

COLUMNS = ("x0", "y0", "half_period", "end_x", "end_y", "index", "residual", "switches")
"""Columns of a traced point; (x0, y0) is the instant of rest with the larger y."""

_MOST_WORK = 1e7
_WORK_PER_CALL = 1e5
_MOST_SECANTS = 60
_PEAK_TOLERANCE = 1e-9
_NEAR = 1e-3
"""How far, over 1 + |z|, an orbit moves when its peak is set right; at a fold like a root."""


@compiled
def trace(
    rows: Any,
    motion: Any,
    pace: Any,
    control: Any,
    y_stop: float,
    spacing: float,
    table: Any,
    switches: Any,
) -> tuple[int, int]:
    """Follow a branch until the larger y of its instants of rest reaches ``y_stop``.

    A call does a bounded amount of work and is repeated while it returns ``GOES_ON``, so that
    the caller can be interrupted. The steps do not depend on ``y_stop`` or ``spacing``.

    Args:
        motion: (2, 3) a point of the branch and its direction, moved on in place.
        pace: (6,) :data:`STEP` to :data:`EXTENT`, kept between calls.
        control: (7,) :data:`LONGEST_STEP` to :data:`LINEAR_SLOPE`.
        table: (n, 8) filled with points (:data:`COLUMNS`); rows left over bound the call too.

    Returns:
        (number of points kept, why it ended).
    """
    pieces = (
        1 if spacing == 0.0 else int(np.ceil(control[steps.LONGEST_STEP] / spacing))
    )
    count, work_before = 0, pace[steps.WORK]
    if pace[steps.EXTENT] == 0.0:
        steps.measure(rows, motion[0], pace)
    while count + pieces < len(table) or count == 0:
        if (
            pace[steps.POINTS] >= control[steps.MOST_POINTS]
            or pace[steps.WORK] > _MOST_WORK
        ):
            return count, steps.STEP_LIMIT
        if not shooting.fastest(rows) * motion[0, 2] < shooting.LONGEST_PHASE:
            return count, steps.STEP_LIMIT
        if pace[steps.WORK] > work_before + _WORK_PER_CALL:
            return count, steps.GOES_ON
        kept, end = _stretch(
            rows, motion, pace, control, y_stop, spacing, table[count:], switches
        )
        count += kept
        if end != steps.GOES_ON:
            return count, end
    return count, steps.GOES_ON


@compiled
def _stretch(
    rows: Any,
    motion: Any,
    pace: Any,
    control: Any,
    y_stop: float,
    spacing: float,
    table: Any,
    switches: Any,
) -> tuple[int, int]:
    """One step of a trace with its recorded points: (points kept, why it ended)."""
    segments, work = np.empty((shooting.MAX_SEGMENTS, 9)), np.empty((3, 4))
    before, here, final, kept = motion.copy(), motion[0], work[2], 0
    length, legs, end = steps.take_step(
        rows, motion, pace, control, work, segments, switches
    )
    if end != steps.GOES_ON:
        return 0, end
    pace[steps.POINTS] += 1
    reach = _way_to_peak(rows, before, motion, length, max(here[1], final[1]), y_stop)
    if reach >= 0.0:
        reach = _locate(rows, before, reach, y_stop, work[0])
        if spacing > 0.0:
            kept = _record(rows, before, reach, spacing, table, switches, 1)
        found = reach > 0.0 and _settle(rows, work[0], y_stop, table[kept], switches)
        return (kept + 1, steps.REACHED) if found else (kept, steps.BRANCH_LOST)
    if spacing > 0.0:
        kept = _record(rows, before, length, spacing, table, switches, 0)
    if here[1] <= rows[0, 11] and legs == 1:
        return kept, steps.RETURNED
    if _diverges(here, control):
        return kept, steps.DIVERGED
    if final[1] > here[1]:
        # the other instant of rest is the higher one from here on: count from there
        steps.change_end(rows, motion, pace, work, segments, legs)
    return kept, steps.GOES_ON


@compiled
def _diverges(here: Any, control: Any) -> bool:
    """Whether x0 is many times as large as y0 and as x0 of the linear mode."""
    peak = max(here[1], 1.0)
    linear = control[steps.LINEAR_X] + control[steps.LINEAR_SLOPE] * (peak - 1.0)
    return bool(abs(here[0]) > control[steps.LARGEST_X] * (peak + linear))


@compiled
def _record(
    rows: Any,
    before: Any,
    length: float,
    spacing: float,
    table: Any,
    switches: Any,
    leave: int,
) -> int:
    """Keep polished points of a step at even distances, its end included unless ``leave`` is 1.

    Returns their number.
    """
    point, kept = np.empty(3), 0
    pieces = max(1, int(np.ceil(length / (spacing * (1.0 + shooting.norm(before[0]))))))
    for piece in range(1, pieces + 1 - leave):
        for index in range(3):
            point[index] = before[0, index] + length * piece / pieces * before[1, index]
        if _orbit_across(rows, point, before[1], table[kept], switches):
            row = table[kept]
            if row[4] > row[1]:  # from the higher end
                row[0], row[1], row[3], row[4] = row[3], row[4], row[0], row[1]
            kept += 1
    return kept


@compiled
def _way_to_peak(
    rows: Any, before: Any, motion: Any, length: float, peak: float, y_stop: float
) -> float:
    """Distance along a step at which the peak is at least ``y_stop``, or −1.

    Where y0 has a maximum within the step that may exceed ``y_stop``, it is looked for.
    """
    if peak >= y_stop:
        return length
    rises, falls = before[1, 1] > 0.0, motion[1, 1] < 0.0
    if not (rises and falls and before[0, 1] + 1.5 * length * before[1, 1] >= y_stop):
        return -1.0
    left, right = 0.0, length
    point, final, tangent = np.empty(3), np.empty(4), np.empty(3)
    for _ in range(_MOST_SECANTS):
        middle = 0.5 * (left + right)
        if _on_step(rows, before, middle, point, final, tangent) == 0:
            return -1.0
        if max(point[1], final[1]) >= y_stop:
            return middle
        if shooting.dot(tangent, before[1]) * tangent[1] > 0.0:
            left = middle
        else:
            right = middle
    return -1.0


@compiled
def _on_step(
    rows: Any, before: Any, distance: float, point: Any, final: Any, tangent: Any
) -> int:
    """The branch's point on the plane across a step at a distance; 0 where none is found."""
    for index in range(3):
        point[index] = before[0, index] + distance * before[1, index]
    segments = np.empty((shooting.MAX_SEGMENTS, 9))
    switches = np.empty(shooting.MAX_SEGMENTS)
    legs, _, _ = shooting.solve_constrained(
        rows,
        point,
        before[1],
        steps.TRACE_TOLERANCE,
        segments,
        switches,
        final,
        tangent,
    )
    return int(legs)


@compiled
def _locate(rows: Any, before: Any, reach: float, y_stop: float, point: Any) -> float:
    """Distance at which the peak passes ``y_stop`` within ``reach``, and the point; or −1."""
    final, tangent = np.empty(4), np.empty(3)
    if _on_step(rows, before, reach, point, final, tangent) == 0:
        return -1.0
    left, right, low = 0.0, reach, before[0, 1] - y_stop
    high = max(point[1], final[1]) - y_stop
    for turn in range(_MOST_SECANTS):
        if high <= _PEAK_TOLERANCE * y_stop:
            break
        middle = 0.5 * (left + right)
        if turn % 3 != 2:
            middle = right - high * (right - left) / (high - low)
        if not left < middle < right:
            break
        if _on_step(rows, before, middle, point, final, tangent) == 0:
            return -1.0
        value = max(point[1], final[1]) - y_stop
        if value >= 0.0:
            right, high = middle, value
        else:
            left, low = middle, value
    if _on_step(rows, before, right, point, final, tangent) == 0:
        return -1.0
    if final[1] > point[1]:
        point[0], point[1] = final[0], final[1]
    return right


@compiled
def _settle(rows: Any, point: Any, y_stop: float, out: Any, switches: Any) -> bool:
    """The orbit at ``y_stop`` next to a point of the branch whose peak is ``y_stop``."""
    x0, half_period = point[0], point[2]
    point[1] = y_stop
    if not orbit_at(rows, point, out, switches):
        return False
    moved = abs(point[0] - x0) + abs(point[2] - half_period)
    return bool(moved < _NEAR * (1.0 + shooting.norm(point)))


@compiled
def orbit_at(rows: Any, point: Any, out: Any, switches: Any) -> bool:
    """The orbit at the y0 of ``point``, by Newton from its x0 and T/2, polished to round-off.

    Fills ``point`` (3,), ``out`` (8,) with :data:`COLUMNS` and ``switches``; False if not found.
    """
    keep_peak = np.zeros(3)
    keep_peak[1] = 1.0
    return _orbit_across(rows, point, keep_peak, out, switches)


@compiled
def _orbit_across(rows: Any, point: Any, normal: Any, out: Any, switches: Any) -> bool:
    """As :func:`orbit_at`, on the plane through ``point`` across ``normal``."""
    segments = np.empty((shooting.MAX_SEGMENTS, 9))
    final = np.empty(4)
    tangent = np.empty(3)
    count, _, residual = shooting.solve_constrained(
        rows, point, normal, 0.0, segments, switches, final, tangent
    )
    if count == 0:
        return False
    out[0], out[1], out[2] = point[0], point[1], point[2]
    out[3], out[4] = final[0], final[1]
    out[5] = shooting.stability_index(rows, segments, count)
    out[6], out[7] = residual, count - 1
    return True
