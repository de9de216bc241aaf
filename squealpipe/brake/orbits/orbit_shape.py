"""Compute the shape of a symmetric orbit: its waveform, its extremes and its largest speed.

Idea: within a segment the flow has a closed form, so the waveform is evaluated, not integrated. An
extreme is bracketed between samples of a segment and located as a zero of the slope by Newton's
method, which falls back to halving the bracket. Cost: a dozen evaluations for each period of the
faster mode in a segment.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.orbits.modal_flow import (
    Rows,
    acceleration,
    advance,
    copy_state,
    kernel,
    propagator,
)
from squealpipe.brake.orbits.shooting import (
    segments_room,
    shoot,
    state_room,
    switches_room,
)
from squealpipe.systems.compiled import part
from squealpipe.systems.taylor.kernels import Matrix, Vector
from squealpipe.systems.taylor.memory import room

_coefficients_room = room(8)


@kernel
def waveform(rows: Rows, point: Vector, phases: Vector, out: Matrix) -> None:
    """Fill ``out`` (n, 4) with (x, y, vx, vy) at ascending phases θ = 2π t/T in [0, π]."""
    segments, switches = segments_room(), switches_room()
    final, start, scratch = state_room(), state_room(), _coefficients_room()
    count = shoot(rows, point[0], point[1], point[2], segments, switches, final)
    start[0], start[1], start[2], start[3] = point[0], point[1], 0.0, 0.0
    begin, leg = 0.0, 0
    for index in range(len(phases)):
        time = phases[index] / np.pi * point[2]
        while leg < count - 1 and time > switches[leg]:
            row = rows[int(segments[leg, 8])]
            advance(row, segments[leg], start)
            begin = switches[leg]
            leg += 1
        row = rows[int(segments[leg, 8])]
        propagator(row, time - begin, scratch)
        copy_state(start, out[index])
        advance(row, scratch, out[index])


@part
def _rates(row: Any, state: Any, kind: int) -> tuple[float, float, float]:
    """A quantity with its first two derivatives: x (0), y (1) or vx (2)."""
    ax, ay = acceleration(row, state[0], state[1])
    if kind == 0:
        return state[0], state[2], ax
    if kind == 1:
        return state[1], state[3], ay
    jerk = -((row.mean + row.half_difference) * state[2] + row.a12 * state[3])
    return state[2], ax, jerk


@kernel
def extremes(rows: Rows, point: Vector, out: Vector) -> None:
    """Fill ``out`` (6,) with the least and largest x, y and vx over half a period."""
    segments, switches = segments_room(), switches_room()
    final, start, scratch = state_room(), state_room(), _coefficients_room()
    state = state_room()
    count = shoot(rows, point[0], point[1], point[2], segments, switches, final)
    start[0], start[1], start[2], start[3] = point[0], point[1], 0.0, 0.0
    begin = 0.0
    for kind in range(3):
        out[2 * kind], out[2 * kind + 1] = np.inf, -np.inf
    # Samples between which an extreme is looked for, in a segment or, if shorter, a fast period
    samples_per_piece = 12
    for leg in range(count):
        row = rows[int(segments[leg, 8])]
        end = switches[leg] if leg < count - 1 else point[2]
        looks = samples_per_piece * max(
            1, int(np.ceil(row.omega2 * (end - begin) / (2.0 * np.pi)))
        )
        for kind in range(3):
            slope_before = 0.0
            for look in range(looks + 1):
                time = (end - begin) * look / looks
                propagator(row, time, scratch)
                copy_state(start, state)
                advance(row, scratch, state)
                value, slope, bend = _rates(row, state, kind)
                # at both instants of rest round-off alone is left of a velocity: its sign just
                # after the first and just before the second is that of the acceleration
                if kind < 2 and leg == 0 and look == 0:
                    slope = bend
                elif kind < 2 and leg == count - 1 and look == looks:
                    slope = -bend
                out[2 * kind] = min(out[2 * kind], value)
                out[2 * kind + 1] = max(out[2 * kind + 1], value)
                if look > 0 and slope * slope_before < 0.0:
                    before = time - (end - begin) / looks
                    value = _turn(row, start, kind, before, time, slope_before, scratch)
                    out[2 * kind] = min(out[2 * kind], value)
                    out[2 * kind + 1] = max(out[2 * kind + 1], value)
                slope_before = slope
        advance(row, segments[leg], start)
        begin = end


@part
def _turn(
    row: Any,
    start: Any,
    kind: int,
    before: float,
    after: float,
    first: float,
    scratch: Any,
) -> float:
    """Value at the turning point in (before, after), by safeguarded Newton on the slope.

    ``first`` has the sign of the slope just after ``before``.
    """
    state = state_room()
    value = 0.0
    time = 0.5 * (before + after)
    # enough to halve the way out of the rest at an interval's end
    most_iterations = 24
    for _ in range(most_iterations):
        propagator(row, time, scratch)
        copy_state(start, state)
        advance(row, scratch, state)
        value, slope, curvature = _rates(row, state, kind)
        if slope * first > 0.0:
            before = time
        else:
            after = time
        newton = time - slope / curvature if curvature != 0.0 else before
        time = newton if before < newton < after else 0.5 * (before + after)
    return value


def sample(
    rows: NDArray[np.void], point: NDArray[np.float64], phases: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(n, 4) states at ascending phases in [0, π]; see :func:`waveform`."""
    out = np.empty((len(phases), 4))
    waveform(rows, np.ascontiguousarray(point[:3]), phases, out)
    return out
