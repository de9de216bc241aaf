"""Note what a step shows: extremes, turns, samples and what has added up.

Idea: the series of a step are at hand, so nothing is integrated again. A sample is a value of its
polynomial. A quantity leaves the span of its ends within a step by at most h²/8 times its second
derivative: only where that could be a record are turning points located, as zeros of the rate, by
Newton's method. Invariant: extremes lie between samples as well, and do not depend on how often a
run is sampled. Cost: a few operations a step of all lanes; turning points only near records.
"""

import math
from typing import Any

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.taylor import layout
from squealpipe.systems.taylor.roots import evaluate, evaluate_all, evaluate_twice
from squealpipe.systems.taylor.simd import (
    ROW,
    bits_below,
    first_bit,
    fma,
    larger,
    load,
    magnitude,
    smaller,
    splat,
    store,
)


@part
def extremes_inside(c: Any, index: int, lane: int, begin: float, end: float) -> Any:
    """Return the least and largest value at turning points inside a part of a step."""
    low, high = math.inf, -math.inf
    step = end - begin
    _, before, bend = evaluate_twice(c, index, lane, begin)
    _, last_slope, last_bend = evaluate_twice(c, index, lane, end)
    if before * last_slope > 0.0:
        # a rate that loses its sign in between crosses zero along its tangents
        plain = (
            before * (before + bend * step) > 0.0
            and last_slope * (last_slope - last_bend * step) > 0.0
        )
        if plain:
            return low, high
    else:
        plain = bend * last_bend > 0.0
    # where there may be several turning points they are looked for in eighths of the step
    pieces = 1 if plain else 8
    left, width = begin, step / pieces
    # Newton iterations for an extremum; two do where the step is short beside the oscillation
    most_iterations = 60
    for _ in range(pieces):
        right = left + width
        after = last_slope
        if right != end:
            _, after, _ = evaluate_twice(c, index, lane, right)
        if before * after < 0.0:
            a, b, time = left, right, left + width * before / (before - after)
            for _ in range(most_iterations):
                value, slope, bend = evaluate_twice(c, index, lane, time)
                if slope * before > 0.0:
                    a = time
                else:
                    b = time
                last, time = time, time - slope / bend
                if not a <= time <= b:
                    time = 0.5 * (a + b)
                if abs(time - last) < 1e-7 * step:  # the error enters squared
                    break
            value, _, _ = evaluate_twice(c, index, lane, time)
            low, high = min(low, value), max(high, value)
        left, before = right, after
    return low, high


@inline
def _end_of(series: int, terms: int, step: Any) -> Any:
    """A series at the end of its step, its rate, and half of that one's."""
    value, slope, bend = load(series + (terms - 1) * ROW), splat(0.0), splat(0.0)
    for k in range(terms - 2, -1, -1):
        bend = fma(bend, step, slope)
        slope = fma(slope, step, value)
        value = fma(value, step, load(series + k * ROW))
    return value, slope, bend


@inline
def observe(t: Any, m: Any, c: Any, first_extreme: int, busy: int) -> None:
    """Extremes of the tracked quantities over one step of all lanes.

    Inside a step a quantity leaves the span of its ends by at most h²/8 times its second
    derivative, of which the first orders are nearly all: only where that could be a record are
    turning points looked for.
    """
    at, terms = t.rows, t.n_terms
    step, zero = load(at + layout.numbers.step * ROW), splat(0.0)
    # share of a quantity that the higher orders of its second derivative add to a step's span
    rest = 2e-4
    for index in range(t.n_tracked):
        variable = m.tracked[index, 0]
        series, r = t.series + variable * terms * ROW, first_extreme + 2 * index
        end, last, half_bend = _end_of(series, terms, step)
        start, first = load(series), load(series + ROW)
        low, high = smaller(start, end), larger(start, end)
        bend = 0.75 * magnitude(load(series + 3 * ROW)) + 1.5 * step * magnitude(
            load(series + 4 * ROW)
        )
        bend = step * step * (0.25 * magnitude(load(series + 2 * ROW)) + step * bend)
        beyond = bend + rest * larger(magnitude(start), magnitude(end))
        row = at + r * ROW
        least, most = smaller(low, load(row)), larger(high, load(row + ROW))
        store(row, least)
        store(row + ROW, most)
        bits = (
            bits_below(most, high + beyond) | bits_below(low - beyond, least)
        ) & busy
        # a rate that loses its sign in between crosses zero along its tangents
        onwards = first + load(series + 2 * ROW) * step * splat(2.0)
        back = last - half_bend * step * splat(2.0)
        bits &= ~(
            bits_below(zero, first * last)
            & bits_below(zero, first * onwards)
            & bits_below(zero, last * back)
        )
        while bits:
            lane = first_bit(bits)
            bits ^= 1 << lane
            inner_low, inner_high = extremes_inside(
                c, variable, lane, 0.0, m.rows[layout.numbers.step, lane]
            )
            m.rows[r, lane] = min(m.rows[r, lane], inner_low)
            m.rows[r + 1, lane] = max(m.rows[r + 1, lane], inner_high)


@part
def extremes_between(t: Any, m: Any, c: Any, lane: int) -> None:
    """Gather the extremes of a lane's tracked quantities between the asked instants, over one step.

    Each instant gets those since the instant before it, the first those since the run's begin: an
    extreme lies between samples, and a record of samples alone would miss it.
    """
    rows, job = m.rows, m.integers[layout.integers.job, lane]
    following, times = m.integers[layout.integers.sample, lane], m.sample_times[job]
    step, begin = rows[layout.numbers.step, lane], 0.0
    while True:
        end, due = step, False
        if following < times.size:
            offset = (times[following] - rows[layout.numbers.clock, lane]) - rows[
                layout.numbers.correction, lane
            ]
            due = offset <= step
            end = offset if due else step
        for index in range(t.n_tracked):
            quantity = m.tracked[index, 0]
            low, high = extremes_inside(c, quantity, lane, begin, end)
            for time in (begin, end):
                value = evaluate(c, quantity, lane, time)
                low, high = min(low, value), max(high, value)
            low = min(low, m.between[index, 0, lane])
            high = max(high, m.between[index, 1, lane])
            if due:
                m.sample_extremes[job, following, index, 0] = low
                m.sample_extremes[job, following, index, 1] = high
                low, high = math.inf, -math.inf
            m.between[index, 0, lane], m.between[index, 1, lane] = low, high
        if not due:
            return
        begin = end
        following += 1


@inline
def count_turns(t: Any, m: Any, first_turn: int, busy: int) -> int:
    """Count half turns around the points over one step of all lanes; returns those that ended."""
    at, zero, ended = t.rows, splat(0.0), 0
    for point in range(t.n_points):
        row = at + (first_turn + 3 * point) * ROW
        left = bits_below(load(at + layout.numbers.first_of_system * ROW), load(row))
        crossed = (bits_below(load(t.series), load(row)) ^ left) & busy
        if not crossed:
            continue
        y = load(at + (layout.numbers.first_of_system + 1) * ROW) - load(row + ROW)
        same = ~(bits_below(zero, y) ^ left)
        while crossed:
            lane = first_bit(crossed)
            crossed ^= 1 << lane
            turned = 1.0 if same & (1 << lane) else -1.0
            m.rows[first_turn + 3 * point + 2, lane] += turned
            least = math.inf
            for each in range(t.n_points):
                least = min(least, abs(m.rows[first_turn + 3 * each + 2, lane]))
            if 0.5 * least >= m.limits[m.integers[layout.integers.job, lane], 5]:
                m.integers[layout.integers.outcome, lane] = layout.outcomes.by_turns
                ended |= 1 << lane
    return ended


@inline
def entered_row(t: Any) -> int:
    """The first row of when each component entered its regime."""
    return int(t.n_rows - t.n_constants - t.n_parameters - t.n_components)


@part
def sample(t: Any, m: Any, c: Any, lane: int, first_time: int) -> None:
    """States, and sums, at the asked instants of one job that fall into this step."""
    rows, job = m.rows, m.integers[layout.integers.job, lane]
    following, times = m.integers[layout.integers.sample, lane], m.sample_times[job]
    while following < times.size:
        offset = (times[following] - rows[layout.numbers.clock, lane]) - rows[
            layout.numbers.correction, lane
        ]
        if offset > rows[layout.numbers.step, lane]:
            break
        evaluate_all(c, t.n_states, lane, offset, m.samples[job, following])
        for component in range(t.n_components):
            regime = m.integers[layout.integers.first_regime + component, lane]
            m.sample_regimes[job, following, component] = regime
        if t.n_sums:
            _sum(
                t, m, lane, m.sample_sums[job, following], first_time, times[following]
            )
        following += 1
    m.integers[layout.integers.sample, lane] = following
    rows[layout.numbers.next_sample, lane] = (
        times[following] if following < times.size else math.inf
    )


@part
def _sum(t: Any, m: Any, lane: int, sums: Any, first_time: int, time: float) -> None:
    """Sum up so far: growth (to the last step's end), times in regimes, half turns, events."""
    job, rows = m.integers[layout.integers.job, lane], m.rows
    sums[0] = m.summary[job, 0] + log_norm(
        t, m, lane, first_time - 2 * t.n_tracked - t.n_states
    )
    for regime in range(t.n_regimes):
        sums[1 + regime] = rows[first_time + regime, lane]
    for component in range(t.n_components):
        since = time - rows[entered_row(t) + component, lane]
        sums[1 + m.integers[layout.integers.first_regime + component, lane]] += since
    place = 1 + t.n_regimes
    for point in range(t.n_points):
        sums[place + point] = rows[first_time + t.n_regimes + 3 * point + 2, lane]
    place += t.n_points
    for kind in range(t.n_kinds):
        sums[place + kind] = m.counts[job, kind]


@part
def log_norm(t: Any, m: Any, lane: int, tangent_row: int) -> float:
    """ln of the size of a lane's perturbation."""
    square = 0.0
    for variable in range(t.n_states):
        square += (m.rows[tangent_row + variable, lane] * m.units[variable, lane]) ** 2
    return -math.inf if square == 0.0 else 0.5 * math.log(square)


@part
def clear_extremes(m: Any, lane: int, index: int, first_extreme: int) -> None:
    """No extremes yet; the smallest is not looked for where the largest alone is asked for."""
    r, largest_alone = first_extreme + 2 * index, m.tracked[index, 1]
    m.rows[r, lane] = -math.inf if largest_alone else math.inf
    m.rows[r + 1, lane] = -math.inf


@part
def begin_late(t: Any, m: Any, lane: int, first_extreme: int) -> None:
    """Keep the extremes of the early part, and begin those of the late part."""
    job = m.integers[layout.integers.job, lane]
    for index in range(t.n_tracked):
        for each in range(2):
            r = first_extreme + 2 * index + each
            m.extremes[job, index, 0, each] = m.rows[r, lane]
        clear_extremes(m, lane, index, first_extreme)
    m.integers[layout.integers.late, lane] = 1
    m.rows[layout.numbers.t_late, lane] = math.inf
