"""One step along a branch of symmetric orbits, compiled.

The unknowns are z = (x0, y0, T/2), in scaled units of order one. Three unknowns allow closed
forms for tangent and corrector; :mod:`squealpipe.methods.continuation` is the general method.
Arrays are handled element by element: whole-array expressions triple the time to compile.

The tangent is the cross product of the two gradients, so along a regular branch it keeps its
sense: a step to a point where it runs the other way has left the branch across a bifurcation,
perfect or not, and is taken again at half its length.
"""

from typing import Any

import numpy as np

from squealpipe.methods.compiled import compiled
from squealpipe.methods.orbits import shooting
from squealpipe.methods.orbits.shorter_orbits import (
    about_to_meet,
    shorter_orbit_between,
)

REACHED, RETURNED, TONGUE_END, BRANCH_LOST, STEP_LIMIT, DIVERGED, GOES_ON = range(7)
"""Why a trace ended: y_peak reached; back on the linear mode; the orbit is another one, run
through several times, and the branch meets that one's; no step small enough stays on the branch;
too many points or too much work; x0 grew without bound beside y (an internal resonance); or it
has not ended: call again."""

STEP, SENSE, WORK, POINTS, FLIGHT, EXTENT = range(6)
"""Entries of ``pace``: step over 1 + |z|, sense of the tangent (0: not known yet), work done (in
look-aheads of the flow), accepted steps; of the last point, the time in flight and the distance
of both instants of rest (0: not known yet)."""
LONGEST_STEP, LEAST_COSINE, STRICT, MOST_POINTS, LARGEST_X, LINEAR_X, LINEAR_SLOPE = (
    range(7)
)
"""Entries of ``control``: longest step, least cosine of a turn, whether the sense of the tangent
must be kept, most points, and the bound of |x0| over that of the linear mode at equal y0."""

TRACE_TOLERANCE = 1e-13
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
_WORK_PER_SHOT = 10.0


@compiled
def take_step(
    rows: Any,
    motion: Any,
    pace: Any,
    control: Any,
    work: Any,
    segments: Any,
    switches: Any,
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
        legs, iterations, _ = shooting.solve_constrained(
            rows, trial, ahead, TRACE_TOLERANCE, segments, switches, final, tangent
        )
        pace[WORK] += (iterations + 1) * (
            _WORK_PER_SHOT + shooting.fastest(rows) * here[2]
        )
        flight = time_in_flight(trial, segments, switches, legs)
        if legs > 0 and _close_by(rows, motion, pace, control, work, length, flight):
            cosine = shooting.dot(tangent, ahead)
            sense = 1.0 if cosine > 0.0 else -1.0
            meets = control[STRICT] != 0.0 and (
                sense * pace[SENSE] < 0.0
                or about_to_meet(rows, trial, segments, switches, legs)
            )
            if not meets:
                pace[SENSE], pace[FLIGHT] = sense, flight
                pace[EXTENT] = np.sqrt(
                    (final[0] - trial[0]) ** 2 + (final[1] - trial[1]) ** 2
                )
                for index in range(3):
                    here[index], ahead[index] = trial[index], sense * tangent[index]
                if iterations <= _EASY_ITERATIONS:
                    growth = 4.0 if sense * cosine > _STRAIGHT else 2.0
                    pace[STEP] = min(growth * pace[STEP], control[LONGEST_STEP])
                return length, legs, GOES_ON
            if pace[STEP] < _CLOSE * control[LONGEST_STEP] and shorter_orbit_between(
                rows, here, trial, segments, switches, legs
            ):
                return 0.0, 0, TONGUE_END
        pace[STEP] *= 0.5
    return 0.0, 0, BRANCH_LOST


@compiled
def _length(rows: Any, motion: Any, pace: Any, control: Any) -> float:
    """Arclength of the next step: neither the period nor the extent changes by much."""
    here, ahead = motion[0], motion[1]
    length = pace[STEP] * (1.0 + shooting.norm(here))
    if control[STRICT] == 0.0:
        return float(length)
    turn = shooting.fastest(rows) * abs(ahead[2]) * length
    if turn > _LARGEST_TURN:
        length *= _LARGEST_TURN / turn
    change = length * np.sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1])
    if pace[EXTENT] > 0.0 and change > _LARGEST_CHANGE * pace[EXTENT]:
        length *= _LARGEST_CHANGE * pace[EXTENT] / change
    return float(length)


@compiled
def _close_by(
    rows: Any,
    motion: Any,
    pace: Any,
    control: Any,
    work: Any,
    length: float,
    flight: float,
) -> bool:
    """Whether a trial point is near its prediction and the branch has turned by little."""
    here, ahead, trial, tangent = motion[0], motion[1], work[0], work[1]
    off = 0.0
    for index in range(3):
        off += (trial[index] - here[index] - length * ahead[index]) ** 2
    if not (
        abs(shooting.dot(tangent, ahead)) > control[LEAST_COSINE]
        and off < 0.09 * length * length
    ):
        return False
    change = shooting.fastest(rows) * abs(flight - pace[FLIGHT])
    return control[STRICT] == 0.0 or bool(change < _LARGEST_TURN)


@compiled
def time_in_flight(point: Any, segments: Any, switches: Any, legs: int) -> float:
    """Time above the threshold within half a period."""
    flight, begin = 0.0, 0.0
    for leg in range(legs):
        end = switches[leg] if leg < legs - 1 else point[2]
        flight += segments[leg, 8] * (end - begin)
        begin = end
    return flight


@compiled
def measure(rows: Any, point: Any, pace: Any) -> None:
    """Note time in flight and extent of the orbit at the start of a trace."""
    segments = np.empty((shooting.MAX_SEGMENTS, 9))
    switches = np.empty(shooting.MAX_SEGMENTS)
    final = np.empty(4)
    legs = shooting.shoot(rows, point[0], point[1], point[2], segments, switches, final)
    pace[FLIGHT] = time_in_flight(point, segments, switches, legs)
    pace[EXTENT] = np.sqrt((final[0] - point[0]) ** 2 + (final[1] - point[1]) ** 2)


@compiled
def change_end(
    rows: Any, motion: Any, pace: Any, work: Any, segments: Any, legs: int
) -> None:
    """Describe point and direction from the other instant of rest."""
    here, ahead, final, vector = motion[0], motion[1], work[2], np.zeros(4)
    vector[0], vector[1] = ahead[0], ahead[1]
    shooting.push(rows, segments, legs, vector)
    ahead[0], ahead[1] = vector[0], vector[1]
    here[0], here[1] = final[0], final[1]
    size = shooting.norm(ahead)
    for index in range(3):
        ahead[index] /= size
    # the sense of the tangent depends on the description: take it anew
    trial, tangent, end = work[0], work[1], np.empty(4)
    for index in range(3):
        trial[index] = here[index]
    legs, _, _ = shooting.solve_constrained(
        rows,
        trial,
        ahead,
        TRACE_TOLERANCE,
        segments,
        np.empty(shooting.MAX_SEGMENTS),
        end,
        tangent,
    )
    pace[SENSE] = (
        0.0 if legs == 0 else (1.0 if shooting.dot(tangent, ahead) > 0.0 else -1.0)
    )
