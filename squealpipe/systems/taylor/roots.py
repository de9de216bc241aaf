"""The first root of a Taylor polynomial in its step, with a proof where there is none; compiled.

On an interval of width w a function with |p''| ≤ M lies within w² M/8 of the chord of its ends,
a monotone one has a root where its ends differ in sign, and one that is convex or concave has at
most one extremum. An interval where none of this decides is halved, down to where round-off
hides the function: such a band holds a root if the function leaves it on its other side.
"""

import math
from typing import Any, NamedTuple

from squealpipe.systems.compiled import part, polynomial


class RootSearch(NamedTuple):
    """Numbers of the search for the first root of a surface within a step.

    Attributes:
        no_root, undecided: stand for a root where there is none, and where nothing can be said.
        finest_interval: share of a step below which round-off hides what an undecided interval
            holds. Doubling it gives up one halving earlier.
        unsure: share of a step: a root that round-off hides by more on both sides is a multiple
            one. Doubling it tells roots apart that lie half as far from each other.
    """

    no_root: float = -1.0
    undecided: float = -2.0
    finest_interval: float = 2.0**-48
    unsure: float = 1e-6


root_search = RootSearch()


class End(NamedTuple):
    """A polynomial and its first two derivatives at an end of an interval."""

    time: float
    value: float
    slope: float
    bend: float


class Watch(NamedTuple):
    """Crossings of zero that count.

    Attributes:
        falls, rises: whether those from above, and those from below.
        fresh: whether the polynomial starts from zero.
        at_once: whether a start to the wrong side is a crossing.
        noise: size within which the value at a fresh start is zero.
        drift: growth of the noise with time.
    """

    falls: bool
    rises: bool
    fresh: bool
    at_once: bool
    noise: float
    drift: float


@polynomial
def evaluate(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """The Taylor polynomial of a variable, [variable, order, lane], so long after its start."""
    order = coefficients.shape[1] - 1
    value = coefficients[variable, order, lane]
    for k in range(order - 1, -1, -1):
        value = value * step + coefficients[variable, k, lane]
    return value


@polynomial
def evaluate_all(
    coefficients: Any, count: int, lane: int, step: float, values: Any
) -> None:
    """Write the polynomials of the first variables likewise, side by side: none waits for another.

    Args:
        values: (count) or more.
    """
    order = coefficients.shape[1] - 1
    for variable in range(count):
        values[variable] = coefficients[variable, order, lane]
    for k in range(order - 1, -1, -1):
        for variable in range(count):
            value = values[variable] * step + coefficients[variable, k, lane]
            values[variable] = value


@polynomial
def evaluate_twice(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """A polynomial and its first and second derivatives."""
    order = coefficients.shape[1] - 1
    if step == 0.0 and order > 1:
        value, slope = coefficients[variable, 0, lane], coefficients[variable, 1, lane]
        return value, slope, 2.0 * coefficients[variable, 2, lane]
    value, slope, bend = coefficients[variable, order, lane], 0.0, 0.0
    for k in range(order - 1, -1, -1):
        bend = bend * step + slope
        slope = slope * step + value
        value = value * step + coefficients[variable, k, lane]
    return value, slope, 2.0 * bend


@polynomial
def _halved(
    coefficients: Any, variable: int, lane: int, first: float, end: float, side: float
) -> Any:
    """Tell whether Newton's method leaves the bracket at a time and at three halfway on to its end.

    Returns the last of these times as well, which is then the other end of the bracket.
    """
    order = coefficients.shape[1] - 1
    second = 0.5 * (first + end)
    third = 0.5 * (second + end)
    last = 0.5 * (third + end)
    p = q = r = s = coefficients[variable, order, lane]
    dp = dq = dr = ds = 0.0
    for k in range(order - 1, -1, -1):
        lower = coefficients[variable, k, lane]
        dp, p = dp * first + p, p * first + lower
        dq, q = dq * second + q, q * second + lower
        dr, r = dr * third + r, r * third + lower
        ds, s = ds * last + s, s * last + lower
    before = side if first < end else -side
    passed = (
        _leaves(first, p, dp, end, before)
        & _leaves(second, q, dq, end, before)
        & _leaves(third, r, dr, end, before)
        & _leaves(last, s, ds, end, before)
    )
    return passed, last


@part
def _leaves(time: float, value: float, slope: float, end: float, side: float) -> bool:
    """Tell whether Newton's method leads from a time on a side past an end, or away from it."""
    following, middle = time - value / slope, 0.5 * (time + end)
    outside = (following <= min(time, end)) | (following >= max(time, end))
    goes_on = (abs(middle - time) > 2.0**-53 * abs(time)) & (middle != end)
    return outside & goes_on & (value * side > 0.0)


@part
def bounds_of(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """Bound of the third derivative over the step, and the size below which round-off hides it.

    Both in one loop, in which neither waits for the other.
    """
    bound = size = 0.0
    for k in range(coefficients.shape[1] - 1, 2, -1):
        term = abs(coefficients[variable, k, lane])
        bound = bound * step + k * (k - 1.0) * (k - 2.0) * term
        size = size * step + term
    for k in range(min(coefficients.shape[1] - 1, 2), -1, -1):
        size = size * step + abs(coefficients[variable, k, lane])
    # of a polynomial, over the sum of its terms
    round_off = 1e-15
    return bound, round_off * size


@part
def is_hidden(
    coefficients: Any, variable: int, lane: int, step: float, root: float, floor: float
) -> Any:
    """Tell whether round-off hides where a root is, as it hides that of (x − 1)⁵ multiplied out.

    What is below ``floor`` is round-off. Of two roots close together each is clear on one side.
    """
    off = root_search.unsure * step
    before = abs(evaluate(coefficients, variable, lane, root - off))
    after = abs(evaluate(coefficients, variable, lane, root + off))
    _, slope, _ = evaluate_twice(coefficients, variable, lane, root)
    if abs(slope) * off > floor:
        return before <= floor and after <= floor
    return before <= floor or after <= floor


@part
def first_root(
    coefficients: Any,
    variable: int,
    lane: int,
    step: float,
    start: float = 0.0,
    known: float = 0.0,
    third: float = 0.0,
    floor: float = 0.0,
) -> Any:
    """The first t in (start, step] where the polynomial changes its sign or touches zero.

    A root at the start itself is where the state comes from; it does not count. ``known`` is the
    sign just after it where round-off hides it; ``third`` and ``floor`` are the
    :func:`bounds_of`, if they are known.

    Returns:
        The root, ``no_root`` where there is none or ``undecided`` where nothing can be said, and
        the time up to which the search is complete: a step may end where its sign is hidden.
    """
    if floor == 0.0:
        third, floor = bounds_of(coefficients, variable, lane, step)
    left, right, band, band_side = start, step, start, 0.0
    p0, s0, b0 = evaluate_twice(coefficients, variable, lane, left)
    most_intervals = 20_000
    for _ in range(most_intervals):
        p1, s1, b1 = evaluate_twice(coefficients, variable, lane, right)
        ends = End(left, p0, s0, b0), End(right, p1, s1, b1)
        width = right - left
        side = p0 if p0 != 0.0 else (s0 if s0 != 0.0 else b0)
        if known != 0.0 and left == start:
            side = known
        if band_side != 0.0 and abs(p0) > floor:
            if band_side * side < 0.0:
                return 0.5 * (band + left), step
            band_side = 0.0
        before = side if band_side == 0.0 else band_side
        decided, root = _look(coefficients, variable, lane, ends, before, third)
        bend = max(abs(b0), abs(b1)) + 0.5 * third * width
        hidden = max(abs(p0), abs(p1)) + 0.125 * bend * width * width <= 2.0 * floor
        if not (decided or hidden or width < root_search.finest_interval * step):
            right = left + 0.5 * width
            continue
        if decided and root >= 0.0:
            return root, step
        if not decided and band_side == 0.0:
            band, band_side = left, math.copysign(1.0, side)
        if right >= step:
            return _at_the_end(step, p1, floor, band, band_side)
        left, right = right, min(step, right + 2.0 * width)
        p0, s0, b0 = p1, s1, b1
    return root_search.undecided, left


@part
def _at_the_end(
    step: float, value: float, floor: float, band: float, side: float
) -> Any:
    """Result of :func:`first_root` if round-off has hidden a root since ``band`` (side not 0)."""
    if side != 0.0 and abs(value) <= floor:
        return root_search.no_root, band
    return 0.5 * (band + step) if side * value < 0.0 else root_search.no_root, step


@part
def _agree(a: float, b: float) -> Any:
    """Tell whether both are positive, or both negative."""
    return (a > 0.0 and b > 0.0) or (a < 0.0 and b < 0.0)


@part
def _look(
    coefficients: Any, variable: int, lane: int, ends: Any, side: float, third: float
) -> Any:
    """Tell whether an interval between two ends is decided; its first root or ``no_root``."""
    left, p0, s0, b0 = ends[0]
    right, p1, s1, b1 = ends[1]
    width = right - left
    bend = max(abs(b0), abs(b1)) + 0.5 * third * width
    # signs, not products: those of small numbers may vanish
    monotone = _agree(s0, s1) and min(abs(s0), abs(s1)) > 0.5 * bend * width
    curved = _agree(b0, b1) and min(abs(b0), abs(b1)) > 0.5 * third * width
    if not _agree(side, p1):
        if monotone or curved:
            return True, _bracketed(coefficients, variable, lane, left, right, side)
        return False, root_search.no_root
    if monotone or min(abs(p0), abs(p1)) > 0.125 * bend * width * width:
        return True, root_search.no_root
    if not curved:
        return False, root_search.no_root
    if _agree(side, -b0) or not _agree(s0, -s1):
        # An arch is lowest at its ends; a bow without a turning point likewise.
        return True, root_search.no_root
    lowest = _bracketed(coefficients, variable, lane, left, right, s0, of_slope=True)
    value, _, _ = evaluate_twice(coefficients, variable, lane, lowest)
    if _agree(side, value):
        return True, root_search.no_root
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

    Where Newton's method comes to rest at an end of the bracket, one middle after the other
    follows, nearer to that end: four of them are looked at in the time that one takes.
    """
    low, high = left, right
    time, looked, most = 0.5 * (low + high), 0, 100
    while looked < most:
        looked += 1
        value, slope, bend = evaluate_twice(coefficients, variable, lane, time)
        if of_slope:
            value, slope = slope, bend
        if value == 0.0:
            return time
        if _agree(value, side):
            low = time
        else:
            high = time
        following = time - value / slope
        if not low < following < high:
            following, end = 0.5 * (low + high), time
            while not of_slope and looked + 4 <= most:
                passed, last = _halved(
                    coefficients, variable, lane, following, end, side
                )
                if not passed:
                    break
                low, high = (end, last) if end == low else (last, end)
                time, following = last, 0.5 * (low + high)
                looked += 4
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
    watch: Watch,
    third: float,
    floor: float,
) -> Any:
    """The first t in [0, step] where the polynomial falls, or rises, through zero as is asked.

    Returns it and the time up to which the search is complete, as :func:`first_root`. One that
    starts from zero (``fresh``) has the side that it first takes by more than its noise, which
    grows by ``drift`` with time; a side that is the wrong one is a crossing ``at_once``, at 0,
    unless the switch changes nothing. ``third`` and ``floor`` are the :func:`bounds_of`.
    """
    falls, rises, fresh, at_once, noise, drift = watch
    start, side = 0.0, coefficients[variable, 0, lane]
    hidden = side == 0.0
    if not fresh:  # a step may start where round-off hides the side
        # or leads past a root that the step before did not reach, where it would be beyond
        is_past = at_once and falls != rises and (side < 0.0) == falls
        hidden |= is_past and abs(side) <= max(noise, floor)
        noise, drift = max(noise, floor) if is_past else floor, 0.0
        hidden |= abs(side) <= noise and is_hidden(
            coefficients, variable, lane, step, 0.0, noise
        )
    if fresh or hidden:
        start, side = _leaves_zero(coefficients, variable, lane, step, noise, drift)
        if at_once and ((side < 0.0 and falls) or (side > 0.0 and rises)):
            return 0.0, step
    while side != 0.0:
        root, looked = first_root(
            coefficients, variable, lane, step, start, side, third, floor
        )
        if root < 0.0 or (side > 0.0 and falls) or (side < 0.0 and rises):
            return root, looked
        start, side = root, -side
    return root_search.no_root, step


@part
def _leaves_zero(
    coefficients: Any, variable: int, lane: int, step: float, noise: float, drift: float
) -> Any:
    """Time at which a polynomial that starts from zero first differs from it, and its value there.

    The value is 0, and the time the step's end, if it never does.
    """
    time = step * root_search.finest_interval
    while 0.0 < time <= step:
        value, _, _ = evaluate_twice(coefficients, variable, lane, time)
        if abs(value) > noise + drift * time:
            return time, value
        time *= 2.0
    return step, 0.0
