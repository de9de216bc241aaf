"""Tracing a branch of symmetric orbits by pseudo-arclength, compiled.

The unknowns are z = (x0, y0, T/2), in scaled units of order one. Three unknowns allow closed
forms for tangent and corrector; :mod:`squealpipe.methods.continuation` is the general method.
Arrays are handled element by element: whole-array expressions triple the time to compile.

The tangent is the cross product of the two gradients, so along a regular branch it keeps its
sense: a step to a point where it runs the other way has left the branch across a bifurcation,
perfect or not, and is taken again at half its length.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from squealpipe.methods.compiled import compiled
from squealpipe.methods.orbits.modal_flow import advance, propagator
from squealpipe.methods.orbits.shooting import (
    LONGEST_PHASE,
    MAX_SEGMENTS,
    push,
    shoot,
    solve_constrained,
    stability_index,
)

REACHED, RETURNED, TONGUE_END, BRANCH_LOST, STEP_LIMIT, DIVERGED, GOES_ON = range(7)
"""Why a trace ended: y_peak reached; back on the linear mode; the orbit is another one, run
through several times, and the branch meets that one's; no step small enough stays on the branch;
too many points or too much work; x0 grew without bound beside y (an internal resonance); or it
has not ended: call again."""

COLUMNS = ("x0", "y0", "half_period", "end_x", "end_y", "index", "residual", "switches")
"""Columns of a traced point; (x0, y0) is the instant of rest with the larger y."""

STEP, SENSE, WORK, POINTS, FLIGHT, EXTENT = range(6)
"""Entries of ``pace``: step over 1 + |z|, sense of the tangent (0: not known yet), work done (in
look-aheads of the flow), accepted steps; of the last point, the time in flight and the distance
of both instants of rest (0: not known yet)."""
LONGEST_STEP, LEAST_COSINE, STRICT, MOST_POINTS, LARGEST_X, LINEAR_X, LINEAR_SLOPE = range(7)
"""Entries of ``control``: longest step, least cosine of a turn, whether the sense of the tangent
must be kept, most points, and the bound of |x0| over that of the linear mode at equal y0."""

_TRACE_TOLERANCE = 1e-13
"""Next to a bifurcation the error along the branch is many times that of the end velocities."""
_SHORTEST_STEP = 1e-12
_EASY_ITERATIONS = 4
_STRAIGHT = 0.9995
_LARGEST_TURN = 0.5
"""Phase of the fastest mode by which T/2 and the time in flight may change in one step, rad."""
_LARGEST_CHANGE = 0.2
"""Of (x0, y0) in one step over the distance of both instants of rest."""
_CLOSE = 1e-2
"""Step over the longest one below which a meeting with another branch is judged."""
_MOST_WORK = 1e7
_WORK_PER_CALL = 1e5
_WORK_PER_SHOT = 10.0
_MOST_SECANTS = 60
_PEAK_TOLERANCE = 1e-9
_NEAR = 1e-3
"""How far, over 1 + |z|, an orbit moves when its peak is set right; at a fold like a root."""
_MOST_COVERS = 7
_SAME_STATE, _NEARLY_SAME = 1e-8, 1e-3
"""Distance over 1 + |z| below which two states are one, or one next to where branches meet."""
_MAY_COVER = 0.5
"""Least stability index at which a step is checked for having met shorter orbits, which have 2
where branches meet."""


@compiled
def _norm(vector: Any) -> float:
    return float(np.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]))


@compiled
def _dot(left: Any, right: Any) -> float:
    return float(left[0] * right[0] + left[1] * right[1] + left[2] * right[2])


@compiled
def _fastest(rows: Any) -> float:
    return float(max(rows[0, 7], rows[1, 7]))


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
    segments, final, tangent = np.empty((MAX_SEGMENTS, 9)), np.empty(4), np.empty(3)
    count, _, residual = solve_constrained(
        rows, point, normal, 0.0, segments, switches, final, tangent
    )
    if count == 0:
        return False
    out[0], out[1], out[2] = point[0], point[1], point[2]
    out[3], out[4] = final[0], final[1]
    out[5] = stability_index(rows, segments, count)
    out[6], out[7] = residual, count - 1
    return True


@compiled
def _change_end(rows: Any, motion: Any, pace: Any, work: Any, segments: Any, legs: int) -> None:
    """Describe point and direction from the other instant of rest."""
    here, ahead, final, vector = motion[0], motion[1], work[2], np.zeros(4)
    vector[0], vector[1] = ahead[0], ahead[1]
    push(rows, segments, legs, vector)
    ahead[0], ahead[1] = vector[0], vector[1]
    here[0], here[1] = final[0], final[1]
    norm = _norm(ahead)
    for index in range(3):
        ahead[index] /= norm
    # the sense of the tangent depends on the description: take it anew
    trial, tangent, end = work[0], work[1], np.empty(4)
    for index in range(3):
        trial[index] = here[index]
    legs, _, _ = solve_constrained(
        rows, trial, ahead, _TRACE_TOLERANCE, segments, np.empty(MAX_SEGMENTS), end, tangent
    )
    pace[SENSE] = 0.0 if legs == 0 else (1.0 if _dot(tangent, ahead) > 0.0 else -1.0)


@compiled
def _apart_after(
    rows: Any, point: Any, segments: Any, switches: Any, legs: int, covers: int, apart: Any
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
    near *= 1.0 + _norm(point)
    for covers in range(2, _MOST_COVERS + 1):
        if _apart_after(rows, point, segments, switches, legs, covers, apart) < near:
            return covers
    return 1


@compiled
def _about_to_meet(rows: Any, point: Any, segments: Any, switches: Any, legs: int) -> bool:
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
    segments, switches, final = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS), np.empty(4)
    legs = shoot(rows, point[0], point[1], point[2], segments, switches, final)
    return 0 if legs == 0 else shorter_orbit(rows, point, segments, switches, legs, _SAME_STATE)


@compiled
def _shorter_orbit_between(
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
    legs_here = shoot(rows, here[0], here[1], here[2], segments_here, switches_here, final)
    for covers in range(2, _MOST_COVERS + 1):
        size = _apart_after(rows, trial, segments, switches, legs, covers, after)
        size *= _apart_after(rows, here, segments_here, switches_here, legs_here, covers, before)
        product = 0.0
        for index in range(4):
            product += before[index] * after[index]
        if product < -0.2 * size:
            return True
    return False


@compiled
def _step(
    rows: Any, motion: Any, pace: Any, control: Any, work: Any, segments: Any, switches: Any
) -> tuple[float, int, int]:
    """One accepted step: ``motion`` (point and direction) moves on.

    Returns its length, the orbit's number of segments, and why the branch ends or ``GOES_ON``.

    A step is accepted only if Newton's method converges close to the prediction, the branch has
    turned by little and keeps its sense. ``work`` (3, 4) receives the trial point, its tangent
    and the state after half a period.
    """
    here, ahead = motion[0], motion[1]
    trial, tangent, final = work[0], work[1], work[2]
    while pace[STEP] >= _SHORTEST_STEP:
        length = _length(rows, motion, pace, control)
        for index in range(3):
            trial[index] = here[index] + length * ahead[index]
        legs, iterations, _ = solve_constrained(
            rows,
            trial,
            ahead,
            _TRACE_TOLERANCE,
            segments,
            switches,
            final,
            tangent,
        )
        pace[WORK] += (iterations + 1) * (_WORK_PER_SHOT + _fastest(rows) * here[2])
        flight = _time_in_flight(trial, segments, switches, legs)
        if legs > 0 and _close_by(rows, motion, pace, control, work, length, flight):
            cosine = _dot(tangent, ahead)
            sense = 1.0 if cosine > 0.0 else -1.0
            meets = control[STRICT] != 0.0 and (
                sense * pace[SENSE] < 0.0 or _about_to_meet(rows, trial, segments, switches, legs)
            )
            if not meets:
                pace[SENSE], pace[FLIGHT] = sense, flight
                pace[EXTENT] = np.sqrt((final[0] - trial[0]) ** 2 + (final[1] - trial[1]) ** 2)
                for index in range(3):
                    here[index], ahead[index] = trial[index], sense * tangent[index]
                if iterations <= _EASY_ITERATIONS:
                    growth = 4.0 if sense * cosine > _STRAIGHT else 2.0
                    pace[STEP] = min(growth * pace[STEP], control[LONGEST_STEP])
                return length, legs, GOES_ON
            if pace[STEP] < _CLOSE * control[LONGEST_STEP] and _shorter_orbit_between(
                rows, here, trial, segments, switches, legs
            ):
                return 0.0, 0, TONGUE_END
        pace[STEP] *= 0.5
    return 0.0, 0, BRANCH_LOST


@compiled
def _length(rows: Any, motion: Any, pace: Any, control: Any) -> float:
    """Arclength of the next step: neither the period nor the extent changes by much."""
    here, ahead = motion[0], motion[1]
    length = pace[STEP] * (1.0 + _norm(here))
    if control[STRICT] == 0.0:
        return float(length)
    turn = _fastest(rows) * abs(ahead[2]) * length
    if turn > _LARGEST_TURN:
        length *= _LARGEST_TURN / turn
    change = length * np.sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1])
    if pace[EXTENT] > 0.0 and change > _LARGEST_CHANGE * pace[EXTENT]:
        length *= _LARGEST_CHANGE * pace[EXTENT] / change
    return float(length)


@compiled
def _time_in_flight(point: Any, segments: Any, switches: Any, legs: int) -> float:
    """Time above the threshold within half a period."""
    flight, begin = 0.0, 0.0
    for leg in range(legs):
        end = switches[leg] if leg < legs - 1 else point[2]
        flight += segments[leg, 8] * (end - begin)
        begin = end
    return flight


@compiled
def _measure(rows: Any, point: Any, pace: Any) -> None:
    """Note time in flight and extent of the orbit at the start of a trace."""
    segments, switches, final = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS), np.empty(4)
    legs = shoot(rows, point[0], point[1], point[2], segments, switches, final)
    pace[FLIGHT] = _time_in_flight(point, segments, switches, legs)
    pace[EXTENT] = np.sqrt((final[0] - point[0]) ** 2 + (final[1] - point[1]) ** 2)


@compiled
def _close_by(
    rows: Any, motion: Any, pace: Any, control: Any, work: Any, length: float, flight: float
) -> bool:
    """Whether a trial point is near its prediction and the branch has turned by little."""
    here, ahead, trial, tangent = motion[0], motion[1], work[0], work[1]
    off = 0.0
    for index in range(3):
        off += (trial[index] - here[index] - length * ahead[index]) ** 2
    if not (abs(_dot(tangent, ahead)) > control[LEAST_COSINE] and off < 0.09 * length * length):
        return False
    change = _fastest(rows) * abs(flight - pace[FLIGHT])
    return control[STRICT] == 0.0 or bool(change < _LARGEST_TURN)


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
        rows: state rows.
        motion: (2, 3) a point of the branch and its direction, moved on in place.
        pace: (6,) :data:`STEP` to :data:`EXTENT`, kept between calls.
        control: (7,) :data:`LONGEST_STEP` to :data:`LINEAR_SLOPE`.
        spacing: largest distance of recorded points, over 1 + |z|; 0 records the last alone.
        table: (n, 8) filled with points (:data:`COLUMNS`); rows left over bound the call too.
        switches: (MAX_SEGMENTS,) filled with the switching times of the last point.

    Returns:
        (number of points kept, why it ended).
    """
    pieces = 1 if spacing == 0.0 else int(np.ceil(control[LONGEST_STEP] / spacing))
    count, work_before = 0, pace[WORK]
    if pace[EXTENT] == 0.0:
        _measure(rows, motion[0], pace)
    while count + pieces < len(table) or count == 0:
        if pace[POINTS] >= control[MOST_POINTS] or pace[WORK] > _MOST_WORK:
            return count, STEP_LIMIT
        if not _fastest(rows) * motion[0, 2] < LONGEST_PHASE:
            return count, STEP_LIMIT
        if pace[WORK] > work_before + _WORK_PER_CALL:
            return count, GOES_ON
        kept, end = _stretch(rows, motion, pace, control, y_stop, spacing, table[count:], switches)
        count += kept
        if end != GOES_ON:
            return count, end
    return count, GOES_ON


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
    segments, work = np.empty((MAX_SEGMENTS, 9)), np.empty((3, 4))
    before, here, final, kept = motion.copy(), motion[0], work[2], 0
    length, legs, end = _step(rows, motion, pace, control, work, segments, switches)
    if end != GOES_ON:
        return 0, end
    pace[POINTS] += 1
    reach = _way_to_peak(rows, before, motion, length, max(here[1], final[1]), y_stop)
    if reach >= 0.0:
        reach = _locate(rows, before, reach, y_stop, work[0])
        if spacing > 0.0:
            kept = _record(rows, before, reach, spacing, table, switches, 1)
        found = reach > 0.0 and _settle(rows, work[0], y_stop, table[kept], switches)
        return (kept + 1, REACHED) if found else (kept, BRANCH_LOST)
    if spacing > 0.0:
        kept = _record(rows, before, length, spacing, table, switches, 0)
    if here[1] <= rows[0, 11] and legs == 1:
        return kept, RETURNED
    if _diverges(here, control):
        return kept, DIVERGED
    if final[1] > here[1]:
        # the other instant of rest is the higher one from here on: count from there
        _change_end(rows, motion, pace, work, segments, legs)
    return kept, GOES_ON


@compiled
def _diverges(here: Any, control: Any) -> bool:
    """Whether x0 is many times as large as y0 and as x0 of the linear mode."""
    peak = max(here[1], 1.0)
    linear = control[LINEAR_X] + control[LINEAR_SLOPE] * (peak - 1.0)
    return bool(abs(here[0]) > control[LARGEST_X] * (peak + linear))


@compiled
def _record(
    rows: Any, before: Any, length: float, spacing: float, table: Any, switches: Any,
    leave: int,
) -> int:  # fmt: skip
    """Keep polished points of a step at even distances, its end included unless ``leave`` is 1.

    Returns their number.
    """
    point, kept = np.empty(3), 0
    pieces = max(1, int(np.ceil(length / (spacing * (1.0 + _norm(before[0]))))))
    for piece in range(1, pieces + 1 - leave):
        for index in range(3):
            point[index] = before[0, index] + length * piece / pieces * before[1, index]
        if _orbit_across(rows, point, before[1], table[kept], switches):
            _count_from_higher_end(table[kept])
            kept += 1
    return kept


@compiled
def _count_from_higher_end(row: Any) -> None:
    if row[4] > row[1]:
        row[0], row[1], row[3], row[4] = row[3], row[4], row[0], row[1]


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
        if _dot(tangent, before[1]) * tangent[1] > 0.0:
            left = middle
        else:
            right = middle
    return -1.0


@compiled
def _on_step(rows: Any, before: Any, distance: float, point: Any, final: Any, tangent: Any) -> int:
    """The branch's point on the plane across a step at a distance; 0 where none is found."""
    for index in range(3):
        point[index] = before[0, index] + distance * before[1, index]
    segments, switches = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS)
    legs, _, _ = solve_constrained(
        rows, point, before[1], _TRACE_TOLERANCE, segments, switches, final, tangent
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
    return bool(moved < _NEAR * (1.0 + _norm(point)))
