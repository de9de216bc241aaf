"""What is seen of each Taylor step: times in regimes, extrema, samples, growth; compiled.

Functions see one step through its Taylor coefficients ``c[variable, order, lane]``, so extrema and
samples inside it need no integration. Units are m = k1 = l_pre = 1.
"""

from __future__ import annotations

import math
from typing import Any

from squealpipe.methods.lanes import inline, part
from squealpipe.methods.taylor_polynomial import (
    evaluate_motion,
    evaluate_state,
    extremum,
    first_guess,
    inside,
    tangents_meet,
)
from squealpipe.tasks.lane_layout import (
    CLOCK,
    CORRECTION,
    COUNT,
    EARLY_LARGEST_X,
    HALF_TURNS1,
    HIGHEST_Y,
    HORIZON,
    JUMP2,
    LARGEST_R2,
    LARGEST_SPEED,
    LATE_LARGEST_X,
    LENGTH1,
    LOG_GROWTH,
    LOWEST_Y,
    NEAREST_PIVOT2,
    NEXT_SAMPLE,
    ORDER,
    PIVOTS,
    REGIME,
    RESULT,
    SEPARATED,
    SEPARATED_TIME,
    STICK,
    STICK_TIME,
    T_LATE,
    TANGENT_NORM,
)


@inline
def observe(c: Any, end: Any, memory: Any, lane: int, regime: int, step: float) -> None:
    """Times in each regime and the extrema over one step that ends in the state ``end``."""
    m = memory[lane, RESULT:]
    x0, y0, vx0, vy0 = c[0, 0, lane], c[1, 0, lane], c[2, 0, lane], c[3, 0, lane]
    x1, y1, vx1, vy1 = end
    if regime == SEPARATED:
        m[SEPARATED_TIME] += step
    else:
        if regime == STICK:
            m[STICK_TIME] += step
        low = min(y0, y1)
        if vy0 < 0.0 < vy1 and tangents_meet(y0, y1, vy0, vy1, step) < m[LOWEST_Y]:
            low = min(low, extremum(c, 1, 3, lane, step, vy0, vy1))
        m[LOWEST_Y] = min(m[LOWEST_Y], low)
        high = max(y0, y1)
        if vy0 > 0.0 > vy1 and tangents_meet(y0, y1, vy0, vy1, step) > m[HIGHEST_Y]:
            high = max(high, extremum(c, 1, 3, lane, step, vy0, vy1))
        m[HIGHEST_Y] = max(m[HIGHEST_Y], high)
    large = max(abs(x0), abs(x1))
    window = EARLY_LARGEST_X
    if memory[lane, CLOCK] >= memory[lane, ORDER + T_LATE]:
        window = LATE_LARGEST_X
    if vx0 * vx1 < 0.0 and abs(tangents_meet(x0, x1, vx0, vx1, step)) > m[window]:
        large = max(large, abs(extremum(c, 0, 2, lane, step, vx0, vx1)))
    m[window] = max(m[window], large)
    m[LARGEST_SPEED] = max(m[LARGEST_SPEED], vx1)
    _observe_distances(c, end, memory, lane, step)


@inline
def _observe_distances(c: Any, end: Any, memory: Any, lane: int, step: float) -> None:
    """Distances from the start and from the pivots, and the half turns around these."""
    m = memory[lane, RESULT:]
    x0, y0, vx0, vy0 = c[0, 0, lane], c[1, 0, lane], c[2, 0, lane], c[3, 0, lane]
    x1, y1, vx1, vy1 = end
    out0, out1 = x0 * vx0 + y0 * vy0, x1 * vx1 + y1 * vy1
    first, largest = x0 * x0 + y0 * y0, x1 * x1 + y1 * y1
    if (
        out0 > 0.0 > out1
        and tangents_meet(first, largest, 2.0 * out0, 2.0 * out1, step) > m[LARGEST_R2]
    ):
        largest = max(largest, _turning_distance2(c, lane, step, 0.0, 0.0, out0, out1))
    m[LARGEST_R2] = max(m[LARGEST_R2], largest)
    for number in range(2):
        px, py = memory[lane, PIVOTS + 2 * number], memory[lane, PIVOTS + 2 * number + 1]
        scale = memory[lane, ORDER + LENGTH1 + number] ** -2
        if (x0 < px) != (x1 < px):
            m[HALF_TURNS1 + number] += 1.0 if (y1 > py) == (x1 < px) else -1.0
        far, near = (x0 - px) ** 2 + (y0 - py) ** 2, (x1 - px) ** 2 + (y1 - py) ** 2
        out0, out1 = (x0 - px) * vx0 + (y0 - py) * vy0, (x1 - px) * vx1 + (y1 - py) * vy1
        if out0 < 0.0 < out1:
            least = tangents_meet(far, near, 2.0 * out0, 2.0 * out1, step)
            if least * scale < m[NEAREST_PIVOT2] or least < JUMP2 * far:
                near = min(near, _turning_distance2(c, lane, step, px, py, out0, out1))
                if near < JUMP2 * far:
                    near = 0.0
        m[NEAREST_PIVOT2] = min(m[NEAREST_PIVOT2], near * scale)


@part
def _turning_distance2(
    c: Any, lane: int, step: float, px: float, py: float, first: float, last: float
) -> Any:
    """Squared distance from a point where the radial velocity about it changes its sign."""
    x, y, vx, vy = c[0, 0, lane] - px, c[1, 0, lane] - py, c[2, 0, lane], c[3, 0, lane]
    slope = vx * vx + vy * vy + x * c[2, 1, lane] + y * c[3, 1, lane]
    time = first_guess(first, last, slope, step)
    for _ in range(2):
        x, y, vx, vy, ax, ay = evaluate_motion(c, lane, time)
        x, y = x - px, y - py
        slope = vx * vx + vy * vy + x * ax + y * ay
        time = inside(time - (x * vx + y * vy) / slope, step)
    x, y, vx, vy = evaluate_state(c, lane, time)
    return (x - px) ** 2 + (y - py) ** 2


@inline
def sample(
    c: Any,
    memory: Any,
    integers: Any,
    lane: int,
    times: Any,
    samples: Any,
    regimes: Any,
    step: float,
) -> None:
    """States at the asked instants of one job that fall into this step."""
    following = integers[lane, NEXT_SAMPLE]
    while following < times.size:
        offset = (times[following] - memory[lane, CLOCK]) - memory[lane, CORRECTION]
        if offset > step:
            break
        state = evaluate_state(c, lane, offset)
        for variable in range(4):
            samples[following, variable] = state[variable]
        regimes[following] = integers[lane, COUNT + REGIME]
        following += 1
    integers[lane, NEXT_SAMPLE] = following


@inline
def grow(state: Any, m: Any, lane: int, time: float, saltation: float, lost: float) -> None:
    """Growth of the tangent vector, with the jump of the field at belt speed."""
    state[6, lane] *= saltation
    norm = math.sqrt(
        state[4, lane] ** 2 + state[5, lane] ** 2 + state[6, lane] ** 2 + state[7, lane] ** 2
    )
    if norm == 0.0:
        return
    growth = m[LOG_GROWTH] + math.log(norm / TANGENT_NORM)
    if math.isnan(m[HORIZON]) and growth > lost:
        m[HORIZON] = time
    if not 1e-3 < norm / TANGENT_NORM < 1e2:
        for variable in range(4, 8):
            state[variable, lane] *= TANGENT_NORM / norm
        m[LOG_GROWTH] = growth
