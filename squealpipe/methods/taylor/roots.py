"""The first root of a Taylor polynomial in its step, with a proof where there is none; compiled.

On an interval of width w a function with |p''| ≤ M lies within w² M/8 of the chord of its ends,
a monotone one has a root where its ends differ in sign, and one that is convex or concave has at
most one extremum. An interval where none of this decides is halved, down to where round-off
decides: near a root of high multiplicity, which a shorter step from nearby resolves.
"""

from typing import Any

from squealpipe.methods.compiled import part, polynomial

NO_ROOT = -1.0
FINEST = 2.0**-48
"""Share of a step below which round-off decides about an interval."""
MOST_PIECES = 256
"""Intervals that are looked at."""
MOST_ROOTS = 256
"""Changes of sign in one step after which they are round-off's."""
FLAT = 1e-3
"""Slope of a root, over its distance and size, below which round-off moves it."""


@polynomial
def evaluate(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """The Taylor polynomial of a variable, [variable, order, lane], so long after its start."""
    order = coefficients.shape[1] - 1
    value = coefficients[variable, order, lane]
    for k in range(order - 1, -1, -1):
        value = value * step + coefficients[variable, k, lane]
    return value


@polynomial
def evaluate_twice(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """A polynomial and its first and second derivatives."""
    order = coefficients.shape[1] - 1
    value, slope, bend = coefficients[variable, order, lane], 0.0, 0.0
    for k in range(order - 1, -1, -1):
        bend = bend * step + slope
        slope = slope * step + value
        value = value * step + coefficients[variable, k, lane]
    return value, slope, 2.0 * bend


@part
def largest_third(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """A bound of the third derivative over the step."""
    bound = 0.0
    for k in range(coefficients.shape[1] - 1, 2, -1):
        bound = bound * step + k * (k - 1.0) * (k - 2.0) * abs(
            coefficients[variable, k, lane]
        )
    return bound


@part
def largest_term(coefficients: Any, variable: int, lane: int, time: float) -> Any:
    """Of those that add up to the polynomial so long after its start."""
    most, power = 0.0, 1.0
    for k in range(coefficients.shape[1]):
        most = max(most, abs(coefficients[variable, k, lane]) * power)
        power *= time
    return most


@part
def first_root(
    coefficients: Any,
    variable: int,
    lane: int,
    step: float,
    start: float = 0.0,
    known: float = 0.0,
) -> Any:
    """The first t in (start, step] where the polynomial changes its sign or touches zero.

    A root at the start itself is where the state comes from; it does not count. ``known`` is the
    sign just after it where round-off hides it.

    Returns:
        The root, or ``NO_ROOT``; and whether that is sure: else round-off decides from then on.
    """
    left, right = start, step
    p0, s0, b0 = evaluate_twice(coefficients, variable, lane, left)
    for _ in range(MOST_PIECES):
        p1, s1, b1 = evaluate_twice(coefficients, variable, lane, right)
        third = largest_third(coefficients, variable, lane, right)
        width = right - left
        side = p0 if p0 != 0.0 else (s0 if s0 != 0.0 else b0)
        if known != 0.0 and left == start:
            side = known
        decided, root = _look(
            coefficients,
            variable,
            lane,
            left,
            right,
            side,
            third,
            (p0, s0, b0),
            (p1, s1, b1),
        )
        if decided and root >= 0.0:
            return root, True
        if decided and right >= step:
            return NO_ROOT, True
        if decided:
            left, right = right, step
            p0, s0, b0 = p1, s1, b1
        elif width > FINEST * step:
            right = left + 0.5 * width
        else:
            break
    return left, False


@part
def _look(
    coefficients: Any,
    variable: int,
    lane: int,
    left: float,
    right: float,
    side: float,
    third: float,
    start: Any,
    end: Any,
) -> Any:
    """Whether an interval is decided, and its first root or ``NO_ROOT``."""
    p0, s0, b0 = start
    p1, s1, b1 = end
    width = right - left
    bend = max(abs(b0), abs(b1)) + 0.5 * third * width
    monotone = s0 * s1 > 0.0 and min(abs(s0), abs(s1)) > 0.5 * bend * width
    curved = b0 * b1 > 0.0 and min(abs(b0), abs(b1)) > 0.5 * third * width
    if side * p1 <= 0.0:
        if monotone or curved:
            return True, _bracketed(coefficients, variable, lane, left, right, side)
        return False, NO_ROOT
    if monotone or min(abs(p0), abs(p1)) > 0.125 * bend * width * width:
        return True, NO_ROOT
    if not curved:
        return False, NO_ROOT
    if side * b0 < 0.0 or s0 * s1 >= 0.0:
        # An arch is lowest at its ends; a bow without a turning point likewise.
        return True, NO_ROOT
    lowest = _bracketed(coefficients, variable, lane, left, right, s0, of_slope=True)
    value, _, _ = evaluate_twice(coefficients, variable, lane, lowest)
    if side * value > 0.0:
        return True, NO_ROOT
    return True, _bracketed(coefficients, variable, lane, left, lowest, side)


@part
def _bracketed(
    coefficients: Any,
    variable: int,
    lane: int,
    left: float,
    right: float,
    side: float,
    of_slope: bool = False,
) -> Any:
    """The only root between a point on ``side`` of zero and one that is not, by Newton's method.

    A step out of the bracket, which shrinks each time, is replaced by its middle. Of the slope
    instead of the polynomial if asked.
    """
    low, high = left, right
    time = 0.5 * (low + high)
    for _ in range(100):
        value, slope, bend = evaluate_twice(coefficients, variable, lane, time)
        if of_slope:
            value, slope = slope, bend
        if value == 0.0:
            return time
        if value * side > 0.0:
            low = time
        else:
            high = time
        following = time - value / slope
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - time) <= 2.0**-53 * abs(time) or following in (low, high):
            return following
        time = following
    return time


@part
def first_crossing(
    coefficients: Any,
    variable: int,
    lane: int,
    step: float,
    falls: bool,
    rises: bool,
    fresh: bool,
    noise: float,
    drift: float = 0.0,
    resolution: float = 0.0,
    passed: bool = False,
) -> Any:
    """The first t in [0, step] where the polynomial falls, or rises, through zero as is asked.

    One that starts from zero (``fresh``) has the side that it first takes by more than its noise,
    which grows by ``drift`` with time; a side that is the wrong one is a crossing at 0, unless that
    has been ``passed``.

    Returns:
        The time, or ``NO_ROOT``; and whether that is sure. If not, round-off decides about the
        sign from this time on, which is beyond ``resolution``: a shorter step has to come closer.
    """
    start, side = 0.0, coefficients[variable, 0, lane]
    if fresh:
        start, side = _leaves_zero(
            coefficients, variable, lane, 0.0, step, noise, drift
        )
        if not passed and ((side < 0.0 and falls) or (side > 0.0 and rises)):
            return 0.0, True
    for _ in range(MOST_ROOTS):
        if side == 0.0:
            return NO_ROOT, True
        wanted = (side > 0.0 and falls) or (side < 0.0 and rises)
        root, sure = first_root(coefficients, variable, lane, step, start, side)
        if root < 0.0:
            return NO_ROOT, True
        size = largest_term(coefficients, variable, lane, root)
        if sure:
            _, slope, _ = evaluate_twice(coefficients, variable, lane, root)
            sure = abs(slope) * root >= FLAT * size
        if not sure and root > resolution:
            return root, False
        after, later = root, -side
        if not sure:
            after, later = _leaves_zero(
                coefficients, variable, lane, root, step, 2.0**-48 * size, 0.0
            )
        if wanted and side * later < 0.0:
            return root, True
        start, side = after, later
    return (start, False) if start > resolution else (NO_ROOT, True)


@part
def _leaves_zero(
    coefficients: Any,
    variable: int,
    lane: int,
    begin: float,
    step: float,
    noise: float,
    drift: float,
) -> Any:
    """When a polynomial that is zero at a time first differs from it, and by what; 0 if never."""
    time = step * FINEST
    while 0.0 < time <= step - begin:
        value, _, _ = evaluate_twice(coefficients, variable, lane, begin + time)
        if abs(value) > noise + drift * time:
            return begin + time, value
        time *= 2.0
    return step, 0.0
