"""The Taylor polynomials of one integration step: values and extrema inside it; compiled.

Coefficients are an array [variable, order, lane]; the first four variables are x, y, ẋ, ẏ.
"""

from __future__ import annotations

import math
from typing import Any

from squealpipe.methods.compiled import inline, part, polynomial
from squealpipe.methods.taylor.simd import larger, smaller

MOST_TURNS = 60
"""Newton iterations for an extremum; two do where the step is short beside the oscillation."""


@polynomial
def evaluate(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """A variable's Taylor polynomial at ``step`` from the start of the last step."""
    order = coefficients.shape[1] - 1
    value = coefficients[variable, order, lane]
    for k in range(order - 1, -1, -1):
        value = value * step + coefficients[variable, k, lane]
    return value


@polynomial
def evaluate_state(coefficients: Any, lane: int, step: float) -> Any:
    """The first four variables at ``step``; the four Horner chains run side by side."""
    order = coefficients.shape[1] - 1
    a, b = coefficients[0, order, lane], coefficients[1, order, lane]
    c, d = coefficients[2, order, lane], coefficients[3, order, lane]
    for k in range(order - 1, -1, -1):
        a = a * step + coefficients[0, k, lane]
        b = b * step + coefficients[1, k, lane]
        c = c * step + coefficients[2, k, lane]
        d = d * step + coefficients[3, k, lane]
    return a, b, c, d


@polynomial
def evaluate_motion(coefficients: Any, lane: int, step: float) -> Any:
    """Position, velocity and acceleration at ``step``."""
    order = coefficients.shape[1] - 1
    x, y = coefficients[0, order, lane], coefficients[1, order, lane]
    vx, vy = coefficients[2, order, lane], coefficients[3, order, lane]
    ax, ay = 0.0, 0.0
    for k in range(order - 1, -1, -1):
        x = x * step + coefficients[0, k, lane]
        y = y * step + coefficients[1, k, lane]
        ax = ax * step + vx
        ay = ay * step + vy
        vx = vx * step + coefficients[2, k, lane]
        vy = vy * step + coefficients[3, k, lane]
    return x, y, vx, vy, ax, ay


@polynomial
def evaluate_with_slope(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """A variable and its time derivative at ``step``."""
    order = coefficients.shape[1] - 1
    value, slope = coefficients[variable, order, lane], 0.0
    for k in range(order - 1, -1, -1):
        slope = slope * step + value
        value = value * step + coefficients[variable, k, lane]
    return value, slope


@inline
def above(start: Any, end: Any, first: Any, last: Any, step: Any) -> Any:
    """A bound of the maximum between two points, for rows of lanes.

    ``first`` > 0 > ``last`` are the slopes there. The function may have one inflection in between:
    on the side of the maximum that has none, the curve is below the tangent.
    """
    return larger(start + first * step, end - last * step)


@inline
def below(start: Any, end: Any, first: Any, last: Any, step: Any) -> Any:
    """Likewise of the minimum, where ``first`` < 0 < ``last``."""
    return smaller(start + first * step, end - last * step)


@part
def inside(time: float, step: float) -> float:
    """A time within the step; its middle for one that is not, or is not a number."""
    return time if 0.0 <= time <= step else 0.5 * step


@part
def first_guess(first: float, last: float, slope: float, step: float) -> Any:
    """The root in the step of the parabola from ``first`` with ``slope`` to ``last``.

    ``first`` and ``last`` must differ in sign.
    """
    curvature = (last - first) / step - slope
    discriminant = math.sqrt(slope * slope - 4.0 * first * curvature / step)
    return inside(-2.0 * first / (slope + math.copysign(discriminant, last - first)), step)


@part
def improved(time: float, rate: float, slope: float, first: float, low: float, high: float) -> Any:
    """A better root of a rate by Newton's method, or the middle of the bracket that it leaves.

    ``first`` is the rate at the lower end. Returns the narrowed bracket too.
    """
    if rate * first > 0.0:
        low = time
    else:
        high = time
    following = time - rate / slope
    return (following if low <= following <= high else 0.5 * (low + high)), low, high


@part
def settled(turn: int, change: float, step: float) -> bool:
    """Whether the time of an extremum is good enough: its error enters the value squared."""
    return turn > 0 and abs(change) < 1e-7 * step


@part
def extremum(
    coefficients: Any, variable: int, rate: int, lane: int, step: float, first: float, last: float
) -> Any:
    """A variable where its rate, ``first`` and ``last`` at the step's ends, changes sign."""
    time, low, high = first_guess(first, last, coefficients[rate, 1, lane], step), 0.0, step
    for turn in range(MOST_TURNS):
        value, slope = evaluate_with_slope(coefficients, rate, lane, time)
        before = time
        time, low, high = improved(time, value, slope, first, low, high)
        if settled(turn, time - before, step):
            break
    return evaluate(coefficients, variable, lane, time)
