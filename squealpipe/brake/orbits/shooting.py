"""Symmetric periodic orbits of a piecewise-linear system, by shooting over half a period.

The system is autonomous and reversible, so an orbit that starts at rest at (x0, y0) and is at
rest again after T/2 closes after T. The flow between switches is exact, the field is continuous
across a switch, and the tangent map is therefore the plain product of the segments' maps.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from squealpipe.brake.orbits import modal_flow
from squealpipe.brake.orbits.modal_flow import Rows, kernel
from squealpipe.systems.compiled import part
from squealpipe.systems.taylor.kernels import Matrix, Vector
from squealpipe.systems.taylor.memory import room


class ShootingLimits(NamedTuple):
    """Sizes beyond which a shot over half a period is given up.

    Attributes:
        segments: in half a period. Doubling it follows motions that switch more often.
        phase: of the fastest mode within half a period, rad. Doubling it follows slower motions,
            of which round-off hides twice as much.
    """

    segments: int = 64
    phase: float = 1e4


shooting_limits = ShootingLimits()
# column of a segment, behind its eight coefficients, in which the side of the state stands
_side_column = 8
segments_room = room(shooting_limits.segments, 9)
switches_room = room(shooting_limits.segments)
state_room = room(4)
_pair_room, _pair_of_rows_room = room(2), room(2, 3)


@part
def norm(vector: Any) -> float:
    """Euclidean norm of three components."""
    return float(
        math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
    )


@part
def dot(left: Any, right: Any) -> float:
    """Inner product of three components."""
    return float(left[0] * right[0] + left[1] * right[1] + left[2] * right[2])


@kernel
def fastest(rows: Rows) -> float:
    """Frequency of the fastest mode of either state."""
    return float(max(rows[0].omega2, rows[1].omega2))


@kernel
def shoot(
    rows: Rows,
    x0: float,
    y0: float,
    half_period: float,
    segments: Matrix,
    switches: Vector,
    final: Vector,
) -> int:
    """Flow from rest at (x0, y0) over half a period.

    Args:
        segments: (``shooting_limits.segments``, 9) filled with the coefficients and the state of
            each segment.
        switches: (``shooting_limits.segments``,) filled with the times of the switches.

    Returns:
        The number of segments, or 0 if there were too many or the shot is too long.
    """
    if not fastest(rows) * half_period < shooting_limits.phase:
        return 0
    final[0], final[1], final[2], final[3] = x0, y0, 0.0, 0.0
    side = 1 if y0 > rows[0].threshold else 0
    time = 0.0
    for count in range(shooting_limits.segments):
        row = rows[side]
        crossing = modal_flow.next_crossing(
            row, final, 2.0 * side - 1.0, half_period - time
        )
        if crossing == modal_flow.GIVEN_UP:
            return 0
        duration = half_period - time if crossing < 0.0 else crossing
        modal_flow.propagator(row, duration, segments[count])
        segments[count, _side_column] = side
        modal_flow.advance(row, segments[count], final)
        time += duration
        if crossing < 0.0:
            return count + 1
        switches[count] = time
        final[1] = row.threshold
        side = 1 - side
    return 0


@kernel
def push(rows: Rows, segments: Matrix, count: int, vector: Vector) -> None:
    """Carry a tangent vector through the segments of a shot, in place."""
    for index in range(count):
        modal_flow.apply(
            rows[int(segments[index, _side_column])], segments[index], vector
        )


@kernel
def stability_index(rows: Rows, segments: Matrix, count: int) -> float:
    """trace M − 2 of the monodromy M = Φ1 … Φn Φn … Φ1 (reversibility gives the second half)."""
    trace = 0.0
    vector = state_room()
    for column in range(4):
        for index in range(4):
            vector[index] = 1.0 if index == column else 0.0
        push(rows, segments, count, vector)
        for index in range(count - 1, -1, -1):
            modal_flow.apply(
                rows[int(segments[index, _side_column])], segments[index], vector
            )
        trace += vector[column]
    return trace - 2.0


@kernel
def rest_conditions(
    rows: Rows,
    point: Vector,
    segments: Matrix,
    switches: Vector,
    residual: Vector,
    jacobian: Matrix,
    final: Vector,
) -> int:
    """End velocities of a shot and their derivatives by (x0, y0, T/2).

    Fills ``residual`` (2,), ``jacobian`` (2, 3) and ``final`` (4,); returns the segment count.
    """
    count = shoot(rows, point[0], point[1], point[2], segments, switches, final)
    if count == 0:
        return 0
    residual[0], residual[1] = final[2], final[3]
    vector = state_room()
    for column in range(2):
        for index in range(4):
            vector[index] = 1.0 if index == column else 0.0
        push(rows, segments, count, vector)
        jacobian[0, column], jacobian[1, column] = vector[2], vector[3]
    last = rows[int(segments[count - 1, _side_column])]
    jacobian[0, 2], jacobian[1, 2] = modal_flow.acceleration(last, final[0], final[1])
    return count


@kernel
def solve_constrained(
    rows: Rows,
    point: Vector,
    constraint: Vector,
    tolerance: float,
    segments: Matrix,
    switches: Vector,
    final: Vector,
    tangent: Vector,
    effort: Vector,
) -> int:
    """Newton's method for rest at both ends together with constraint · (z − z_start) = 0.

    Args:
        point: (3,) x0, y0, T/2; start values in, solution out.
        constraint: (3,) fixes the third unknown; (0, 1, 0) keeps y0.
        tolerance: of the end velocities; 0 goes on until round-off stops the progress.
        tangent: (3,) filled with the branch direction at the solution, unit length.
        effort: (2,) filled with the number of iterations and the residual, the largest end
            velocity.

    Returns:
        The number of segments, or 0 where it did not converge.
    """
    # Newton's method from a start that is close has long converged by then; others wander off
    most_newton_steps = 12
    effort[0], effort[1] = most_newton_steps, np.inf
    residual, jacobian = _pair_room(), _pair_of_rows_room()
    previous = np.inf
    best0, best1, best2 = point[0], point[1], point[2]
    for iteration in range(most_newton_steps):
        count = rest_conditions(
            rows, point, segments, switches, residual, jacobian, final
        )
        if count == 0:
            break
        error = max(abs(residual[0]), abs(residual[1]))
        scale = 1.0 + abs(point[0]) + abs(point[1])
        if not error < 1e6 * scale or (
            iteration > 3 and error > previous > 1e-12 * scale
        ):
            break
        # across both gradients
        tangent[0] = jacobian[0, 1] * jacobian[1, 2] - jacobian[0, 2] * jacobian[1, 1]
        tangent[1] = jacobian[0, 2] * jacobian[1, 0] - jacobian[0, 0] * jacobian[1, 2]
        tangent[2] = jacobian[0, 0] * jacobian[1, 1] - jacobian[0, 1] * jacobian[1, 0]
        stagnant = error <= 1e-12 * scale and (error >= 0.25 * previous or error == 0.0)
        if error < previous:
            best0, best1, best2 = point[0], point[1], point[2]
        if stagnant or error <= tolerance:
            size = norm(tangent)
            for index in range(3):
                tangent[index] /= size
            if error > previous:
                point[0], point[1], point[2] = best0, best1, best2
                count = shoot(rows, best0, best1, best2, segments, switches, final)
            effort[0], effort[1] = iteration, max(abs(final[2]), abs(final[3]))
            return count
        previous = error
        determinant = dot(constraint, tangent)
        if determinant == 0.0:
            break
        # Cramer's rule for [J; c] dz = −[r; 0]: dz = c × (r0 J1 − r1 J0) / (c · (J0 × J1))
        w0 = residual[0] * jacobian[1, 0] - residual[1] * jacobian[0, 0]
        w1 = residual[0] * jacobian[1, 1] - residual[1] * jacobian[0, 1]
        w2 = residual[0] * jacobian[1, 2] - residual[1] * jacobian[0, 2]
        point[0] += (constraint[1] * w2 - constraint[2] * w1) / determinant
        point[1] += (constraint[2] * w0 - constraint[0] * w2) / determinant
        point[2] += (constraint[0] * w1 - constraint[1] * w0) / determinant
        if not point[2] > 0.0:
            break
    return 0
