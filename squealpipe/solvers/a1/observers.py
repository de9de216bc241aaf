"""What is seen of each Taylor step: times in regimes, extrema, samples, growth; compiled.

All lanes are looked at side by side, from the states at both ends of their steps. Only where an
extremum inside a step may set a record are the Taylor coefficients ``c[variable, order, lane]``
asked. Units are m = k1 = l_pre = 1; ``at`` is the address of ``records.LANE``, ``lanes`` itself.
"""

from __future__ import annotations

import math
from typing import Any

from squealpipe.methods.compiled import inline, part
from squealpipe.methods.taylor.roots import evaluate_twice
from squealpipe.methods.taylor.simd import (
    bits_below,
    choose_below,
    first_bit,
    larger,
    load,
    magnitude,
    smaller,
    splat,
    store,
)
from squealpipe.methods.taylor.taylor_polynomial import (
    MOST_TURNS,
    above,
    below,
    evaluate_motion,
    evaluate_state,
    extremum,
    first_guess,
    improved,
    settled,
)
from squealpipe.solvers.a1.records import AT, JUMP2, TANGENT_NORM


@inline
def observe(
    c: Any, lanes: Any, at: int, begin: Any, speeds: Any, rates: Any, half_jerk: Any
) -> None:
    """Times in each regime and the extrema over one step of all lanes.

    ``begin``, ``speeds`` and ``rates`` are x, y, ẋ, ẏ and ẍ, ÿ at its start, ``half_jerk`` is
    half of x's third derivative.
    """
    x0, y0 = begin
    vx0, vy0 = speeds
    ax0, ay0 = rates
    x1, y1, vx1, vy1 = load(at + AT.x), load(at + AT.y), load(at + AT.vx), load(at + AT.vy)
    step, zero = load(at + AT.step), splat(0.0)
    contact, stick = load(at + AT.contact), load(at + AT.stick)
    store(at + AT.separated_time, load(at + AT.separated_time) + (1.0 - contact) * step)
    store(at + AT.stick_time, load(at + AT.stick_time) + stick * step)
    touching = bits_below(zero, contact)

    lowest, highest = load(at + AT.lowest_y), load(at + AT.highest_y)
    least, most = below(y0, y1, vy0, vy1, step), above(y0, y1, vy0, vy1, step)
    dips = bits_below(vy0, zero) & bits_below(zero, vy1) & bits_below(least, lowest) & touching
    tops = bits_below(zero, vy0) & bits_below(vy1, zero) & bits_below(highest, most) & touching
    low, high = smaller(smaller(y0, y1), lowest), larger(larger(y0, y1), highest)
    store(at + AT.lowest_y, choose_below(zero, contact, low, lowest))
    store(at + AT.highest_y, choose_below(zero, contact, high, highest))

    clock, t_late = load(at + AT.clock), load(at + AT.t_late)
    early, late = load(at + AT.early_largest_x), load(at + AT.late_largest_x)
    large = larger(magnitude(x0), magnitude(x1))
    most = larger(magnitude(x0 + vx0 * step), magnitude(x1 - vx1 * step))
    swings = bits_below(vx0 * vx1, zero) & bits_below(
        choose_below(clock, t_late, early, late), most
    )
    store(at + AT.early_largest_x, choose_below(clock, t_late, larger(early, large), early))
    store(at + AT.late_largest_x, choose_below(clock, t_late, late, larger(late, large)))
    store(at + AT.largest_speed, larger(load(at + AT.largest_speed), vx1))

    ax1, fast = load(at + AT.ax), larger(magnitude(vx0), magnitude(vx1))
    early, late = load(at + AT.early_largest_vx), load(at + AT.late_largest_vx)
    fastest = choose_below(clock, t_late, early, late)
    most = larger(magnitude(vx0 + ax0 * step), magnitude(vx1 - ax1 * step))
    races = bits_below(ax0 * ax1, zero) & bits_below(fastest, most)
    store(at + AT.early_largest_vx, choose_below(clock, t_late, larger(early, fast), early))
    store(at + AT.late_largest_vx, choose_below(clock, t_late, late, larger(late, fast)))

    out0, out1 = x0 * vx0 + y0 * vy0, x1 * vx1 + y1 * vy1
    first, last, farthest = x0 * x0 + y0 * y0, x1 * x1 + y1 * y1, load(at + AT.largest_r2)
    most = above(first, last, 2.0 * out0, 2.0 * out1, step)
    turns = bits_below(zero, out0) & bits_below(out1, zero) & bits_below(farthest, most)
    store(at + AT.largest_r2, larger(last, farthest))
    bits = dips | tops | swings | turns | races
    reach_y, reach_x = magnitude(vy0) * step, magnitude(vx0) * step
    wiggles = _may_turn_twice(vy0, vy1, ay0, step) & touching
    wiggles &= bits_below(highest, larger(y0, y1) + reach_y) | bits_below(
        smaller(y0, y1) - reach_y, lowest
    )
    early, late = load(at + AT.early_largest_x), load(at + AT.late_largest_x)
    record = choose_below(clock, t_late, early, late)
    wiggles |= _may_turn_twice(vx0, vx1, ax0, step) & bits_below(record, large + reach_x)
    wiggles |= _may_turn_twice(ax0, ax1, half_jerk + half_jerk, step) & bits_below(
        fastest, fast + magnitude(ax0) * step
    )
    slope = vx0 * vx0 + vy0 * vy0 + x0 * ax0 + y0 * ay0
    most = larger(first, last) + 2.0 * magnitude(out0) * step
    wiggles |= _may_turn_twice(out0, out1, slope, step) & bits_below(farthest, most)
    bits |= wiggles
    while bits:
        lane = first_bit(bits)
        bit = 1 << lane
        bits ^= bit
        if wiggles & bit:
            _observe_wiggles(c, lanes, lane)
        if dips & bit:
            found = _extremum(c, lanes, 1, 3, lane)
            lanes.lowest_y[lane] = min(lanes.lowest_y[lane], found)
        if tops & bit:
            found = _extremum(c, lanes, 1, 3, lane)
            lanes.highest_y[lane] = max(lanes.highest_y[lane], found)
        if swings & bit:
            _note_x(lanes, lane, abs(_extremum(c, lanes, 0, 2, lane)))
        if races & bit:
            _note_vx(lanes, lane, _peak_speed(c, lanes, lane))
        if turns & bit:
            found = _turning_distance2(c, lanes, lane, 0.0, 0.0)
            lanes.largest_r2[lane] = max(lanes.largest_r2[lane], found)


@inline
def _may_turn_twice(first: Any, last: Any, slope: Any, step: Any) -> Any:
    """Lanes in which a rate that keeps its sign over the step may have lost it in between.

    The tangent at the start crosses zero: a rate that only dips below zero is convex before.
    """
    zero = splat(0.0)
    return bits_below(zero, first * last) & bits_below(first * (first + slope * step), zero)


@part
def _note_x(lanes: Any, lane: int, found: float) -> None:
    if lanes.clock[lane] < lanes.t_late[lane]:
        lanes.early_largest_x[lane] = max(lanes.early_largest_x[lane], found)
    else:
        lanes.late_largest_x[lane] = max(lanes.late_largest_x[lane], found)


@part
def _note_vx(lanes: Any, lane: int, found: float) -> None:
    if lanes.clock[lane] < lanes.t_late[lane]:
        lanes.early_largest_vx[lane] = max(lanes.early_largest_vx[lane], found)
    else:
        lanes.late_largest_vx[lane] = max(lanes.late_largest_vx[lane], found)


@part
def _peak_speed(c: Any, lanes: Any, lane: int) -> Any:
    """|ẋ| where ẍ changes its sign."""
    first, last, step = c[2, 1, lane], lanes.ax[lane], lanes.step[lane]
    time, low, high = first_guess(first, last, 2.0 * c[2, 2, lane], step), 0.0, step
    for turn in range(MOST_TURNS):
        _, slope, bend = evaluate_twice(c, 2, lane, time)
        before = time
        time, low, high = improved(time, slope, bend, first, low, high)
        if settled(turn, time - before, step):
            break
    speed, _, _ = evaluate_twice(c, 2, lane, time)
    return abs(speed)


@part
def _observe_wiggles(c: Any, lanes: Any, lane: int) -> None:
    """Records that lie between two extrema inside one step."""
    low, high = _two_extrema(c, lanes, lane, 1)
    if lanes.contact[lane] > 0.0:
        lanes.lowest_y[lane] = min(lanes.lowest_y[lane], low)
        lanes.highest_y[lane] = max(lanes.highest_y[lane], high)
    low, high = _two_extrema(c, lanes, lane, 0)
    _note_x(lanes, lane, max(high, -low))
    low, high = _two_extrema(c, lanes, lane, 3)
    _note_vx(lanes, lane, max(high, -low))
    low, high = _two_extrema(c, lanes, lane, 2)
    lanes.largest_r2[lane] = max(lanes.largest_r2[lane], high)


@part
def _two_extrema(c: Any, lanes: Any, lane: int, kind: int) -> Any:
    """Least and largest value where a quantity turns twice in a step; (∞, −∞) where it does not."""
    step = lanes.step[lane]
    _, first, slope = _quantity(c, lane, kind, 0.0)
    _, last, end_slope = _quantity(c, lane, kind, step)
    if first * last > 0.0 and slope * end_slope < 0.0:
        middle = _turn(c, lane, kind, 0.0, step, slope, True)
        _, between, _ = _quantity(c, lane, kind, middle)
        if first * between < 0.0:
            one, _, _ = _quantity(c, lane, kind, _turn(c, lane, kind, 0.0, middle, first, False))
            two, _, _ = _quantity(c, lane, kind, _turn(c, lane, kind, middle, step, between, False))
            return min(one, two), max(one, two)
    return math.inf, -math.inf


@part
def _quantity(c: Any, lane: int, kind: int, time: float) -> Any:
    """x, y, x² + y² or ẋ with its rate (of x² + y², half of it) and the slope of that."""
    if kind == 3:
        return evaluate_twice(c, 2, lane, time)
    x, y, vx, vy, ax, ay = evaluate_motion(c, lane, time)
    if kind == 0:
        return x, vx, ax
    if kind == 1:
        return y, vy, ay
    return x * x + y * y, x * vx + y * vy, vx * vx + vy * vy + x * ax + y * ay


@part
def _turn(
    c: Any, lane: int, kind: int, left: float, right: float, side: float, of_slope: bool
) -> Any:
    """Where the rate, or its slope, leaves the sign of ``side``, by bisection."""
    while True:
        middle = left + 0.5 * (right - left)
        if not left < middle < right:
            return middle
        _, rate, slope = _quantity(c, lane, kind, middle)
        if (slope if of_slope else rate) * side > 0.0:
            left = middle
        else:
            right = middle


@inline
def observe_pivot(
    c: Any, lanes: Any, at: int, begin: Any, speeds: Any, half_turns: Any,
    at_x: int, at_y: int, at_scale: int,
) -> None:  # fmt: skip
    """Distance from one fixed end, and the half turns around it, over one step of all lanes."""
    px, py, scale = load(at + at_x), load(at + at_y), load(at + at_scale)
    step, zero, nearest = load(at + AT.step), splat(0.0), load(at + AT.nearest_pivot2)
    x0, y0 = begin[0] - px, begin[1] - py
    x1, y1 = load(at + AT.x) - px, load(at + AT.y) - py
    out0 = x0 * speeds[0] + y0 * speeds[1]
    out1 = x1 * load(at + AT.vx) + y1 * load(at + AT.vy)
    far, near = x0 * x0 + y0 * y0, x1 * x1 + y1 * y1
    least = below(far, near, 2.0 * out0, 2.0 * out1, step)
    close = bits_below(least * scale, nearest) | bits_below(least, far * JUMP2)
    passes = bits_below(out0, zero) & bits_below(zero, out1) & close
    crosses = bits_below(x0, zero) ^ bits_below(x1, zero)
    store(at + AT.nearest_pivot2, smaller(near * scale, nearest))
    above, left = bits_below(zero, y1), bits_below(x1, zero)
    bits = passes | crosses
    while bits:
        lane = first_bit(bits)
        bit = 1 << lane
        bits ^= bit
        if crosses & bit:
            half_turns[lane] += 1.0 if (above & bit) == (left & bit) else -1.0
        if passes & bit:
            _approach(c, lanes, lane, at_x == AT.pivot_x1)


@part
def _approach(c: Any, lanes: Any, lane: int, first: bool) -> None:
    """The smallest distance from a fixed end inside a step."""
    if first:
        px, py, scale = lanes.pivot_x1[lane], lanes.pivot_y1[lane], lanes.scale1[lane]
    else:
        px, py, scale = lanes.pivot_x2[lane], lanes.pivot_y2[lane], lanes.scale2[lane]
    far = (c[0, 0, lane] - px) ** 2 + (c[1, 0, lane] - py) ** 2
    near = (lanes.x[lane] - px) ** 2 + (lanes.y[lane] - py) ** 2
    near = min(near, _turning_distance2(c, lanes, lane, px, py))
    if near < JUMP2 * far:
        near = 0.0
    lanes.nearest_pivot2[lane] = min(lanes.nearest_pivot2[lane], near * scale)


@part
def _extremum(c: Any, lanes: Any, variable: int, rate: int, lane: int) -> Any:
    last = lanes.vx[lane] if rate == 2 else lanes.vy[lane]
    return extremum(c, variable, rate, lane, lanes.step[lane], c[rate, 0, lane], last)


@part
def _turning_distance2(c: Any, lanes: Any, lane: int, px: float, py: float) -> Any:
    """Squared distance from a point where the radial velocity about it changes its sign."""
    step = lanes.step[lane]
    last = (lanes.x[lane] - px) * lanes.vx[lane] + (lanes.y[lane] - py) * lanes.vy[lane]
    x, y, vx, vy = c[0, 0, lane] - px, c[1, 0, lane] - py, c[2, 0, lane], c[3, 0, lane]
    slope = vx * vx + vy * vy + x * c[2, 1, lane] + y * c[3, 1, lane]
    first = x * vx + y * vy
    time, low, high = first_guess(first, last, slope, step), 0.0, step
    for turn in range(MOST_TURNS):
        x, y, vx, vy, ax, ay = evaluate_motion(c, lane, time)
        x, y = x - px, y - py
        outwards, slope = x * vx + y * vy, vx * vx + vy * vy + x * ax + y * ay
        before = time
        time, low, high = improved(time, outwards, slope, first, low, high)
        if settled(turn, time - before, step):
            break
    x, y, vx, vy = evaluate_state(c, lane, time)
    return (x - px) ** 2 + (y - py) ** 2


@part
def sample(
    c: Any, lanes: Any, regime: int, lane: int, times: Any, samples: Any, regimes: Any
) -> None:
    """States at the asked instants of one job that fall into this step."""
    following, step = lanes.sample[lane], lanes.step[lane]
    while following < times.size:
        offset = (times[following] - lanes.clock[lane]) - lanes.correction[lane]
        if offset > step:
            break
        state = evaluate_state(c, lane, offset)
        for variable in range(4):
            samples[following, variable] = state[variable]
        regimes[following] = regime
        following += 1
    lanes.sample[lane] = following
    lanes.next_sample[lane] = times[following] if following < times.size else math.inf


@inline
def watch_growth(at: int) -> Any:
    """Lanes whose perturbation has grown or shrunk a thousandfold, or passed what is lost."""
    square = splat(0.0)
    for row in (AT.dx, AT.dy, AT.dvx, AT.dvy):
        square = square + load(at + row) * load(at + row)
    usual = bits_below(splat(1e-6), square) & bits_below(square, splat(1e6))
    return ~(usual & bits_below(square, load(at + AT.lost_square)))


@part
def norm_of(lanes: Any, lane: int) -> float:
    """Norm of a lane's perturbation."""
    return math.sqrt(
        lanes.dx[lane] ** 2 + lanes.dy[lane] ** 2 + lanes.dvx[lane] ** 2 + lanes.dvy[lane] ** 2
    )


@part
def grow(lanes: Any, result: Any, lane: int) -> None:
    """Note the horizon when it is passed, and scale a perturbation back."""
    norm = norm_of(lanes, lane)
    if norm == 0.0:
        return
    growth = result.log_growth + math.log(norm / TANGENT_NORM)
    if math.isnan(result.horizon) and growth > lanes.lost_growth[lane]:
        result.horizon = lanes.clock[lane]
    if not 1e-3 < norm / TANGENT_NORM < 1e3:
        lanes.dx[lane] *= TANGENT_NORM / norm
        lanes.dy[lane] *= TANGENT_NORM / norm
        lanes.dvx[lane] *= TANGENT_NORM / norm
        lanes.dvy[lane] *= TANGENT_NORM / norm
        result.log_growth = growth
    limit_growth(lanes, result, lane)


@part
def limit_growth(lanes: Any, result: Any, lane: int) -> None:
    """Where ``watch_growth`` is to report: the squared norm at which the horizon is passed."""
    left = lanes.lost_growth[lane] - result.log_growth
    waits = math.isnan(result.horizon) and left < 300.0
    lanes.lost_square[lane] = math.exp(2.0 * left) if waits else math.inf
