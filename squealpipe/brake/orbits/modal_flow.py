"""Closed-form flow of an undamped linear system of two degrees of freedom, and its events.

Within one state ü = −A u + b with a constant 2×2 matrix A. With λm = tr A/2 and the trace-free
B = A − λm I, every function of A is α I + β B, where α is the mean and β the divided difference
of the function at the eigenvalues ω1², ω2². Written with ω2 ± ω1 these stay exact for repeated,
zero, negative and complex eigenvalues, where eigenvectors do not exist or lose digits.

A *state row* holds these numbers by name (:data:`state_row_type`): of A the mean λm of its
diagonal, half the difference B11 of both, the couplings B12 and B21 and the discriminant δ² = −det
B; ω1 and ω2, real and imaginary; the load b; and the threshold of y
(see :class:`squealpipe.brake.orbits.piecewise_linear.PiecewiseLinearSystem`).
"""

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from squealpipe.systems.compiled import part
from squealpipe.systems.taylor.kernels import Kernels, Vector

state_row_type = np.dtype(
    [
        (name, "f8")
        for name in (
            *("mean", "half_difference", "a12", "a21", "discriminant"),
            *("omega1", "omega1_imaginary", "omega2", "omega2_imaginary"),
            *("load_x", "load_y", "threshold"),
        )
    ]
)
"""One linear state as compiled code reads it."""
Row = Annotated[Any, state_row_type, 0]
Rows = Annotated[Any, state_row_type, 1]
kernel = Kernels(Path(__file__).parent)
GIVEN_UP = -2.0
"""Answer of :func:`next_crossing` after too many look-aheads."""


@part
def _over(sine: Any, frequency: Any, limit: Any) -> Any:
    """A sine over its frequency ω, at ω = 0 the limit."""
    return frequency + limit if frequency == 0.0 else sine / frequency


@part
def _cosine_of_double(sine: Any, cosine: Any) -> Any:
    """cos 2φ from sin φ and cos φ, by the smaller of them: their own round-off does not enter."""
    if abs(cosine) < abs(sine):
        return 2.0 * cosine * cosine - 1.0
    return 1.0 - 2.0 * sine * sine


@part
def modal_coefficients(omega1: Any, omega2: Any, time: Any) -> Any:
    """(α, β) of C = cos(√A t), S = sin(√A t)/√A and G = (1 − C)/A; real or complex ω.

    All from sine and cosine of ω1 t/2 and ω2 t/2, by sums and products that do not cancel.
    """
    mean, half = 0.5 * (omega1 + omega2), 0.5 * (omega2 - omega1)
    angle1, angle2 = 0.5 * time * omega1, 0.5 * time * omega2
    sin1 = np.sin(angle1)
    cos1 = np.cos(angle1)
    sin2 = np.sin(angle2)
    cos2 = np.cos(angle2)
    sine_mean = _over(sin1 * cos2 + cos1 * sin2, mean, time)
    sine1_half = _over(sin1, omega1, 0.5 * time)
    sine2_half = _over(sin2, omega2, 0.5 * time)
    sine1, sine2 = 2.0 * sine1_half * cos1, 2.0 * sine2_half * cos2
    rise1, rise2 = 2.0 * sine1_half * sine1_half, 2.0 * sine2_half * sine2_half

    if abs(half) < 0.5 * abs(mean):
        sine_half = _over(np.sin(half * time), half, time)
        cos_mean, cos_half = cos1 * cos2 - sin1 * sin2, cos1 * cos2 + sin1 * sin2
        sine_beta = (
            0.5 * (cos_mean * sine_half - sine_mean * cos_half) / (omega1 * omega2)
        )
    else:
        sine_half = _over(sin2 * cos1 - cos2 * sin1, half, time)
        sine_beta = 0.25 * (sine2 - sine1) / (mean * half)
    cosine_beta = -0.5 * sine_mean * sine_half
    rise_beta = -(cosine_beta + rise1) / (omega2 * omega2)
    return (
        0.5 * (_cosine_of_double(sin1, cos1) + _cosine_of_double(sin2, cos2)),
        cosine_beta,
        0.5 * (sine1 + sine2),
        sine_beta,
        0.5 * (rise1 + rise2),
        rise_beta,
    )


@part
def coefficients_at(row: Any, time: float) -> Any:
    """(α, β) of C, S, −A S and G of a state row over a time: eight numbers."""
    if row.omega1_imaginary == 0.0 and row.omega2_imaginary == 0.0:
        ca, cb, sa, sb, ga, gb = modal_coefficients(row.omega1, row.omega2, time)
    else:
        omega1, omega2 = (
            complex(row.omega1, row.omega1_imaginary),
            complex(row.omega2, row.omega2_imaginary),
        )
        c0, c1, s0, s1, g0, g1 = modal_coefficients(omega1, omega2, complex(time))
        ca, cb, sa, sb, ga, gb = c0.real, c1.real, s0.real, s1.real, g0.real, g1.real
    return (
        ca,
        cb,
        sa,
        sb,
        -(row.mean * sa + row.discriminant * sb),
        -(sa + row.mean * sb),
        ga,
        gb,
    )


@kernel
def propagator(row: Row, time: float, out: Vector) -> None:
    """Fill ``out`` with :func:`coefficients_at` a time."""
    out[0], out[1], out[2], out[3], out[4], out[5], out[6], out[7] = coefficients_at(
        row, time
    )


@part
def moved_tangent(
    row: Any, coefficients: Any, x: float, y: float, vx: float, vy: float
) -> Any:
    """A tangent vector (δx, δy, δvx, δvy) later."""
    bux, buy = (
        row.half_difference * x + row.a12 * y,
        row.a21 * x - row.half_difference * y,
    )
    bvx, bvy = (
        row.half_difference * vx + row.a12 * vy,
        row.a21 * vx - row.half_difference * vy,
    )
    ca, cb, sa, sb = coefficients[0], coefficients[1], coefficients[2], coefficients[3]
    da, db = coefficients[4], coefficients[5]
    return (
        ca * x + cb * bux + sa * vx + sb * bvx,
        ca * y + cb * buy + sa * vy + sb * bvy,
        da * x + db * bux + ca * vx + cb * bvx,
        da * y + db * buy + ca * vy + cb * bvy,
    )


@part
def moved_state(
    row: Any, coefficients: Any, x: float, y: float, vx: float, vy: float
) -> Any:
    """A state (x, y, vx, vy) later, load b included."""
    x, y, vx, vy = moved_tangent(row, coefficients, x, y, vx, vy)
    sa, sb, ga, gb = coefficients[2], coefficients[3], coefficients[6], coefficients[7]
    bx, by = row.load_x, row.load_y
    bbx, bby = (
        row.half_difference * bx + row.a12 * by,
        row.a21 * bx - row.half_difference * by,
    )
    return (
        x + (ga * bx + gb * bbx),
        y + (ga * by + gb * bby),
        vx + (sa * bx + sb * bbx),
        vy + (sa * by + sb * bby),
    )


@part
def apply(row: Any, coefficients: Any, state: Any) -> None:
    """Advance a tangent vector (δx, δy, δvx, δvy) in place."""
    state[0], state[1], state[2], state[3] = moved_tangent(
        row, coefficients, state[0], state[1], state[2], state[3]
    )


@kernel
def advance(row: Row, coefficients: Vector, state: Vector) -> None:
    """Advance a state (x, y, vx, vy) in place, load b included."""
    state[0], state[1], state[2], state[3] = moved_state(
        row, coefficients, state[0], state[1], state[2], state[3]
    )


@part
def copy_state(source: Any, target: Any) -> None:
    """Copy (x, y, vx, vy)."""
    for index in range(4):
        target[index] = source[index]


@part
def acceleration(row: Any, x: float, y: float) -> tuple[float, float]:
    """−A u + b."""
    return (
        row.load_x - (row.mean + row.half_difference) * x - row.a12 * y,
        row.load_y - row.a21 * x - (row.mean - row.half_difference) * y,
    )


@part
def _jerk_bound(
    row: Any, ax: float, ay: float, vx: float, vy: float, step: float
) -> float:
    """Bound on |d³y/dt³| over the next ``step`` from the state at its start."""
    norm_b = abs(row.half_difference) + max(abs(row.a12), abs(row.a21))
    growth = 1.0 + 0.5 * norm_b * step * step
    if row.omega1_imaginary != 0.0 or row.omega2_imaginary != 0.0:
        growth *= math.exp(
            max(abs(row.omega1_imaginary), abs(row.omega2_imaginary)) * step
        )
    jx = (row.mean + row.half_difference) * vx + row.a12 * vy
    jy = row.a21 * vx + (row.mean - row.half_difference) * vy
    later = (abs(row.mean) + norm_b) * step * math.sqrt(ax * ax + ay * ay)
    return float(growth * (math.sqrt(jx * jx + jy * jy) + later))


@part
def _stays(
    distance: float, slope: float, curvature: float, jerk: float, step: float
) -> bool:
    """Return whether Taylor's bound keeps the distance positive in (0, step]."""
    if slope >= 0.0 and 0.5 * curvature - jerk * step / 6.0 > 0.0:
        return True
    # the secant slope ė + ½ëτ − ⅙Jτ² is concave in τ, so its minimum is at an end
    least = min(slope, slope + 0.5 * curvature * step - jerk * step * step / 6.0)
    return least > 0.0 or distance + step * min(least, 0.0) > 0.0


@part
def _refine_crossing(
    row: Any, origin: Any, start: float, end: float, guess: float, sign: float
) -> float:
    """Time of the single zero of sign·(y − threshold) in (start, end), by safeguarded Newton.

    It ends with the step after which Newton's error, from the curvature, is below round-off.
    """
    x0, y0, vx0, vy0 = origin[0], origin[1], origin[2], origin[3]
    time = guess if start < guess < end else 0.5 * (start + end)
    for _ in range(100):
        x, y, _, vy = moved_state(row, coefficients_at(row, time), x0, y0, vx0, vy0)
        distance, slope = sign * (y - row.threshold), sign * vy
        if distance > 0.0:
            start = time
        else:
            end = time
        if slope < 0.0:
            newton = time - distance / slope
            move = abs(newton - time)
            _, ay = acceleration(row, x, y)
            error = move * min(1.0, abs(ay / slope) * move)
            if error <= 4e-16 * abs(newton) and start <= newton <= end:
                return float(newton)
        else:
            newton = start
        if not start < newton < end:
            newton = 0.5 * (start + end)
            if not start < newton < end:
                return newton
        time = newton
    return time


@kernel
def next_crossing(row: Row, origin: Vector, sign: float, horizon: float) -> float:
    """First time in (0, horizon] at which y leaves this state's side, −1, or ``GIVEN_UP``.

    ``sign`` is +1 above and −1 below the threshold. Each look-ahead is bounded by Taylor's
    theorem, so a pair of crossings at grazing is never stepped over; ``origin`` may lie on the
    threshold.
    """
    x0, y0, vx0, vy0 = origin[0], origin[1], origin[2], origin[3]
    x, y, vx, vy = x0, y0, vx0, vy0
    # rad of the fastest mode: up to this phase a bound on the curvature replaces trial and error
    longest_look_ahead = 1.0
    longest = longest_look_ahead / max(
        math.sqrt(
            row.omega2 * row.omega2 + row.omega2_imaginary * row.omega2_imaginary
        ),
        1e-300,
    )
    time = 0.0
    # a touch without crossing that is shorter than this part of the longest look-ahead is passed
    # over
    touch = 1e-9
    most_looks = 100_000
    for _ in range(most_looks):
        if not time < horizon:
            return -1.0
        distance = max(sign * (y - row.threshold), 0.0)
        slope = sign * vy
        ax, ay = acceleration(row, x, y)
        curvature = sign * ay
        step = min(longest, horizon - time)
        falls = False
        while step > touch * longest:
            jerk = _jerk_bound(row, ax, ay, vx, vy, step)
            if _stays(distance, slope, curvature, jerk, step):
                break
            falls = (
                max(slope, slope + curvature * step + 0.5 * jerk * step * step) < 0.0
            )
            if falls:
                break
            step *= 0.5
        ahead = time + step
        x, y, vx, vy = moved_state(row, coefficients_at(row, ahead), x0, y0, vx0, vy0)
        if falls and sign * (y - row.threshold) <= 0.0:
            root = math.sqrt(
                slope * slope - 2.0 * curvature * distance
            )  # NaN: no guess
            guess = time + 2.0 * distance / (root - slope)
            return float(_refine_crossing(row, origin, time, ahead, guess, sign))
        time = ahead
        if horizon - time <= 1e-15 * horizon:
            return -1.0
    return GIVEN_UP
