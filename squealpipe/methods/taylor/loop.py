"""The compiled loop of any hybrid system: a Taylor step of all lanes, then its events and its ends.

Compiled once for all systems: numbers of states, surfaces and regimes are data, and what a system
computes is called by address. After each step all lanes are looked at side by side; one in which
nothing ends, no surface may be crossed and no sample is due takes no path of its own.
"""

import math
from functools import cache
from typing import Any, NamedTuple

import numba
import numpy as np

from squealpipe.methods.compiled import inline, part
from squealpipe.methods.taylor.lanes import call, compile_advance, view
from squealpipe.methods.taylor.roots import evaluate, evaluate_twice, first_crossing
from squealpipe.methods.taylor.simd import (
    LANES,
    ROW,
    bits_below,
    choose_below,
    first_bit,
    fma,
    larger,
    load,
    magnitude,
    rough_power,
    smaller,
    splat,
    store,
)

_numba: Any = numba
SLACK = 1e-13
"""A surface lies within this of zero where round-off hides its sign, over the terms that cancel."""
NOISE = 1e-15
"""Round-off of a surface's polynomial and of its rate, likewise."""
NOTHING = 1e-30
"""Below the round-off of any quantity."""
LOST_ERROR = 1e-3
"""Error, in units of the states' sizes, from which a state says nothing about its run."""
CHAIN = 64
"""Switches without progress in time that end a run."""
LATE_BEGINS = -2
"""What ends a step where the late part of a run begins."""
REST = 2e-4
"""Share of a quantity that the higher orders of its second derivative add to a step's span."""
MOST_TURNS = 60
"""Newton iterations for an extremum; two do where the step is short beside the oscillation."""
PIECES = 8
"""Pieces of a step in which turning points are looked for, where there may be several."""


RUNNING, CONVERGED, STEP_LIMIT, EVENT_LIMIT, NOT_FINITE, ACCUMULATION = -1, 0, 3, 4, 6, 38
"""How a run ends, by the numbers of ``schema.Outcome``."""
STOPPED = 100
"""A stop of the system's own is this plus its number."""
BY_EVENT, BY_TURNS = 98, 99
"""Ends of runs that were to end at the first event of a kind, or after so many turns."""
(
    CLOCK, CORRECTION, STEP, LONGEST, T_END, T_LATE, NEXT_SAMPLE, STEPS, MOST_STEPS, ENTERED, LOST,
    FIXED_ROWS,
) = range(12)  # fmt: skip
"""Rows of numbers of the lanes that every system has; those of a system follow."""
JOB, OUTCOME, SAMPLE, REGIME, EVENTS, CHAINED, HIT, LATE, FIXED_INTEGERS = range(9)
"""Rows of integers of the lanes."""

ARRAYS = (
    "rows", "integers", "series", "inverses", "sizes", "tracked", "regimes", "falls", "rises",
    "active", "fresh", "noise", "scratch", "initial", "parameters", "first_regime", "limits",
    "final", "extremes", "counts", "firsts", "durations", "ends", "summary", "sample_times",
    "samples", "sample_regimes", "sample_sums", "event_times", "event_kinds", "event_regimes",
    "event_states", "peaks", "points", "half_turns", "queue",
)  # fmt: skip
SIZES = (
    "n_terms", "n_jobs", "n_states", "n_variables", "n_surfaces", "n_tracked", "n_parameters",
    "n_constants", "n_regimes", "n_kinds", "n_samples", "n_sums", "n_logged", "n_points",
    "n_rounds", "until", "late_from", "tangent",
    "take_step", "perturb", "longest", "gauge", "change", "jump", "n_series", "n_rows",
    "n_switches",
)  # fmt: skip
TABLE = np.dtype([(name, "i8") for name in (*ARRAYS, *SIZES)])

_fields: Any = [(name, Any) for name in ARRAYS if name not in {"series", "inverses"}]
_named_tuple: Any = NamedTuple
_Memory: Any = _named_tuple("_Memory", _fields)


@inline
def _step_length(base: int, terms: int, n_states: int, sizes: Any) -> Any:
    """Lengths of the next steps from the last two orders (Jorba and Zou 2005; Biscani 2021)."""
    size, last, previous = splat(1.0), splat(1e-300), splat(1e-300)
    for variable in range(n_states):
        series, unit = base + variable * terms * ROW, splat(1.0 / sizes[variable])
        size = larger(magnitude(load(series)) * unit, size)
        last = larger(magnitude(load(series + (terms - 1) * ROW)) * unit, last)
        previous = larger(magnitude(load(series + (terms - 2) * ROW)) * unit, previous)
    order = terms - 1.0
    reach = smaller(
        rough_power(size / last, splat(1.0 / order)),
        rough_power(size / previous, splat(1.0 / (order - 1.0))),
    )
    return reach * math.exp(-2.0 - 0.7 / (order - 1.0))


@inline
def _reach(series: int, terms: int) -> Any:
    """Longest step of a series that is no state's, from ratios of its orders.

    Where the state rests, what depends on the time alone still needs short steps. Its highest
    order may be left out. Of a quantity that is kept at zero all orders are round-off.
    """
    reach, tiny = splat(0.0), splat(1e-300)
    for low in (0, 1, 2):
        base, nearer = magnitude(load(series + low * ROW)), splat(np.inf)
        if low == 0:
            base = splat(NOTHING)
        for high in (terms - 3, terms - 2):
            last = magnitude(load(series + high * ROW))
            power = rough_power(larger(base, tiny) / larger(last, tiny), splat(1.0 / (high - low)))
            nearer = smaller(nearer, choose_below(tiny, last, power, splat(np.inf)))
        reach = larger(reach, nearer)
    return reach * math.exp(-2.0)


@inline
def _at_end(series: int, terms: int, step: Any) -> Any:
    """A series' value at the end of its step."""
    value = load(series + (terms - 1) * ROW)
    for k in range(terms - 2, -1, -1):
        value = fma(value, step, load(series + k * ROW))
    return value


@inline
def _free(series: int, terms: int, step: Any) -> Any:
    """Lanes in which a surface has no root: both ends are further from zero than it bends."""
    value, bend = load(series + (terms - 1) * ROW), splat(0.0)
    for k in range(terms - 1, 1, -1):
        row = load(series + k * ROW)
        bend = fma(bend, step, magnitude(row) * splat(k * (k - 1.0)))
        value = fma(value, step, row)
    value = fma(value, step, load(series + ROW))
    first = load(series)
    value = fma(value, step, first)
    free = bits_below(splat(0.0), first * value)
    nearest = smaller(magnitude(first), magnitude(value))
    return free & bits_below(bend * step * step * 0.125, nearest)


@inline
def _reaches(rows: int, instant: int) -> Any:
    """Lanes whose step does not end before the instant in a row."""
    left = load(rows + instant * ROW) - load(rows + CLOCK * ROW)
    return ~bits_below(load(rows + STEP * ROW), left - load(rows + CORRECTION * ROW))


@inline
def _take_step(t: Any, active: Any, sizes: Any) -> Any:
    """Ends of all lanes' steps; returns the lanes that need a look of their own."""
    terms, base, at = t.n_terms, t.series, t.rows
    step = smaller(_step_length(base, terms, t.n_states, sizes), load(at + LONGEST * ROW))
    if t.n_variables > t.n_states:
        for each in range(t.n_surfaces + t.n_tracked - t.n_states):
            step = smaller(step, _reach(base + (t.n_variables + each) * terms * ROW, terms))
    store(at + STEP * ROW, step)
    lost = step
    for variable in range(t.n_variables):
        value = _at_end(base + variable * terms * ROW, terms, step)
        store(at + (FIXED_ROWS + variable) * ROW, value)
        lost = lost + value * 0.0
    plain = bits_below(magnitude(lost), splat(np.inf))
    for surface in range(t.n_surfaces):
        if active[surface]:
            series = base + (t.n_variables + surface) * terms * ROW
            plain &= _free(series, terms, step) | ~active[surface]
    return ~plain | _reaches(at, T_END) | _reaches(at, T_LATE)


@part
def _first_switch(t: Any, m: Any, c: Any, lane: int, step: float) -> float:
    """When the first watched surface is crossed, whose switch goes into ``HIT``; or the step."""
    integers = m.integers
    regime, bit = integers[REGIME, lane], 1 << lane
    first, tie = step, step * 2.0**-44
    for surface in range(t.n_surfaces):
        falls, rises = m.falls[regime, surface], m.rises[regime, surface]
        if falls < 0 and rises < 0:
            continue
        root = first_crossing(
            c, t.n_variables + surface, lane, step, falls >= 0, rises >= 0,
            (m.fresh[surface] & bit) != 0, m.noise[surface, 0, lane], m.noise[surface, 1, lane],
        )  # fmt: skip
        if root < 0.0 or root > first + tie:
            continue
        _, slope, _ = evaluate_twice(c, t.n_variables + surface, lane, root)
        which = falls if rises < 0 or (falls >= 0 and slope < 0.0) else rises
        earlier = root < first - tie or integers[HIT, lane] < 0
        # of switches at one instant the first by name goes first, whatever their order
        if earlier or which < integers[HIT, lane]:
            first, integers[HIT, lane] = min(root, first), which
    return first


@part
def _cut(t: Any, m: Any, c: Any, lane: int) -> None:
    """End a lane's step at the first crossing, at the late time or at the end of its run."""
    rows, integers = m.rows, m.integers
    integers[HIT, lane] = -1
    total = rows[STEP, lane]
    for variable in range(t.n_variables):
        total += 0.0 * rows[FIXED_ROWS + variable, lane]
    if not math.isfinite(total):
        rows[STEP, lane] = 0.0
        integers[OUTCOME, lane] = NOT_FINITE
        for variable in range(t.n_variables):  # of its series higher orders may be no numbers
            rows[FIXED_ROWS + variable, lane] = c[variable, 0, lane]
        return
    done = rows[CLOCK, lane]
    remaining = (rows[T_END, lane] - done) - rows[CORRECTION, lane]
    step, ends = min(rows[STEP, lane], remaining), remaining <= rows[STEP, lane]
    late = (rows[T_LATE, lane] - done) - rows[CORRECTION, lane]
    turns_late = late <= step
    if turns_late:
        step, ends = late, ends and late >= remaining
    first = _first_switch(t, m, c, lane, step)
    if integers[HIT, lane] >= 0:
        step, ends, turns_late = first, False, False
    if turns_late:
        rows[T_LATE, lane] = math.inf
    if step != rows[STEP, lane]:
        rows[STEP, lane] = step
        _set_end(t, m, c, lane)
    if turns_late:
        integers[HIT, lane] = LATE_BEGINS
    if ends:
        integers[OUTCOME, lane] = CONVERGED


@part
def _set_end(t: Any, m: Any, c: Any, lane: int) -> None:
    for variable in range(t.n_variables):
        m.rows[FIXED_ROWS + variable, lane] = evaluate(c, variable, lane, m.rows[STEP, lane])


@part
def _extremes(c: Any, index: int, lane: int, step: float) -> Any:
    """Least and largest value at turning points inside a step."""
    low, high = math.inf, -math.inf
    before, bend = c[index, 1, lane], 2.0 * c[index, 2, lane]
    _, after, last_bend = evaluate_twice(c, index, lane, step)
    if before * after > 0.0:
        # a rate that loses its sign in between crosses zero along its tangents
        plain = before * (before + bend * step) > 0.0 and after * (after - last_bend * step) > 0.0
        if plain:
            return low, high
    else:
        plain = bend * last_bend > 0.0
    pieces = 1 if plain else PIECES
    left, width = 0.0, step / pieces
    for _ in range(pieces):
        right = left + width
        _, after, _ = evaluate_twice(c, index, lane, right)
        if before * after < 0.0:
            a, b, time = left, right, left + width * before / (before - after)
            for _ in range(MOST_TURNS):
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
def _observe(t: Any, m: Any, c: Any, first_extreme: int, busy: int) -> None:
    """Extremes of the tracked quantities over one step of all lanes.

    Inside a step a quantity leaves the span of its ends by at most h²/8 times its second
    derivative, of which the first orders are nearly all: only where that could be a record are
    turning points looked for.
    """
    at, terms = t.rows, t.n_terms
    step, zero = load(at + STEP * ROW), splat(0.0)
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
        beyond = bend + REST * larger(magnitude(start), magnitude(end))
        row = at + r * ROW
        least, most = smaller(low, load(row)), larger(high, load(row + ROW))
        store(row, least)
        store(row + ROW, most)
        bits = (bits_below(most, high + beyond) | bits_below(low - beyond, least)) & busy
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
            inner_low, inner_high = _extremes(c, variable, lane, m.rows[STEP, lane])
            m.rows[r, lane] = min(m.rows[r, lane], inner_low)
            m.rows[r + 1, lane] = max(m.rows[r + 1, lane], inner_high)


@inline
def _turn(t: Any, m: Any, first_turn: int, busy: int) -> int:
    """Count half turns around the points over one step of all lanes; returns those that ended."""
    at, zero, ended = t.rows, splat(0.0), 0
    for point in range(t.n_points):
        row = at + (first_turn + 3 * point) * ROW
        left = bits_below(load(at + FIXED_ROWS * ROW), load(row))
        crossed = (bits_below(load(t.series), load(row)) ^ left) & busy
        if not crossed:
            continue
        y = load(at + (FIXED_ROWS + 1) * ROW) - load(row + ROW)
        same = ~(bits_below(zero, y) ^ left)
        while crossed:
            lane = first_bit(crossed)
            crossed ^= 1 << lane
            turned = 1.0 if same & (1 << lane) else -1.0
            m.rows[first_turn + 3 * point + 2, lane] += turned
            least = math.inf
            for each in range(t.n_points):
                least = min(least, abs(m.rows[first_turn + 3 * each + 2, lane]))
            if 0.5 * least >= m.limits[m.integers[JOB, lane], 5]:
                m.integers[OUTCOME, lane] = BY_TURNS
                ended |= 1 << lane
    return ended


@part
def _sample(t: Any, m: Any, c: Any, lane: int, first_time: int) -> None:
    """States, and sums, at the asked instants of one job that fall into this step."""
    rows, job = m.rows, m.integers[JOB, lane]
    following, times = m.integers[SAMPLE, lane], m.sample_times[job]
    while following < times.size:
        offset = (times[following] - rows[CLOCK, lane]) - rows[CORRECTION, lane]
        if offset > rows[STEP, lane]:
            break
        for variable in range(t.n_states):
            m.samples[job, following, variable] = evaluate(c, variable, lane, offset)
        m.sample_regimes[job, following] = m.integers[REGIME, lane]
        if t.n_sums:
            _sum(t, m, lane, m.sample_sums[job, following], first_time, times[following])
        following += 1
    m.integers[SAMPLE, lane] = following
    rows[NEXT_SAMPLE, lane] = times[following] if following < times.size else math.inf


@part
def _sum(t: Any, m: Any, lane: int, sums: Any, first_time: int, time: float) -> None:
    """What has added up: growth (to the last step's end), times in regimes, half turns, events."""
    job, rows = m.integers[JOB, lane], m.rows
    sums[0] = m.summary[job, 0] + _log_norm(t, m, lane, first_time - 2 * t.n_tracked - t.n_states)
    for regime in range(t.n_regimes):
        sums[1 + regime] = rows[first_time + regime, lane]
    sums[1 + m.integers[REGIME, lane]] += time - rows[ENTERED, lane]
    place = 1 + t.n_regimes
    for point in range(t.n_points):
        sums[place + point] = rows[first_time + t.n_regimes + 3 * point + 2, lane]
    place += t.n_points
    for kind in range(t.n_kinds):
        sums[place + kind] = m.counts[job, kind]


@part
def _log_norm(t: Any, m: Any, lane: int, tangent_row: int) -> float:
    """ln of the size of a lane's perturbation."""
    square = 0.0
    for variable in range(t.n_states):
        square += (m.rows[tangent_row + variable, lane] / m.sizes[variable]) ** 2
    return -math.inf if square == 0.0 else 0.5 * math.log(square)


@part
def _clear(m: Any, lane: int, index: int, first_extreme: int) -> None:
    """No extremes yet; the smallest is not looked for where the largest alone is asked for."""
    r, largest_alone = first_extreme + 2 * index, m.tracked[index, 1]
    m.rows[r, lane] = -math.inf if largest_alone else math.inf
    m.rows[r + 1, lane] = -math.inf


@part
def _begin_late(t: Any, m: Any, lane: int, first_extreme: int) -> None:
    """From here on extremes are those of the late part."""
    job = m.integers[JOB, lane]
    for index in range(t.n_tracked):
        for each in range(2):
            r = first_extreme + 2 * index + each
            m.extremes[job, index, 0, each] = m.rows[r, lane]
        _clear(m, lane, index, first_extreme)
    m.integers[LATE, lane] = 1
    m.rows[T_LATE, lane] = math.inf


@part
def _enter(t: Any, m: Any, c: Any, lane: int, regime: int, span: float) -> None:
    """Put a lane into a regime: its constants, which surfaces it watches, which start from zero."""
    m.integers[REGIME, lane] = regime
    bit, keep = 1 << lane, ~(1 << lane)
    first = t.n_rows - t.n_constants
    for constant in range(t.n_constants):
        m.rows[first + constant, lane] = m.regimes[regime, constant]
    z, sizes, out = m.scratch[0], m.scratch[1], m.scratch[2]
    for variable in range(t.n_variables):
        z[variable] = c[variable, 0, lane]
        sizes[variable] = abs(z[variable]) + abs(c[variable, 1, lane]) * span
    parameters = t.rows + (first - t.n_parameters) * ROW + 8 * lane
    constants = t.regimes + 8 * regime * t.n_constants
    stride = m.scratch.shape[1] * 8
    call(t.gauge, (t.scratch, t.scratch + stride, parameters, constants, t.scratch + 2 * stride))
    # where an event was located to the tolerance only, the rate that follows from it is no better
    located = max(NOISE, LOST_ERROR * math.exp(-m.limits[m.integers[JOB, lane], 4]))
    for surface in range(t.n_surfaces):
        m.noise[surface, 0, lane] = NOISE * out[3 * surface + 1]
        m.noise[surface, 1, lane] = located * out[3 * surface + 2]
    # a state is known to round-off of its typical size, however small it has become
    for variable in range(t.n_states):
        sizes[variable] = max(sizes[variable], m.sizes[variable])
    call(t.gauge, (t.scratch, t.scratch + stride, parameters, constants, t.scratch + 2 * stride))
    for surface in range(t.n_surfaces):
        m.active[surface] &= keep
        m.fresh[surface] &= keep
        if m.falls[regime, surface] >= 0 or m.rises[regime, surface] >= 0:
            m.active[surface] |= bit
            if abs(out[3 * surface]) <= SLACK * out[3 * surface + 1]:
                m.fresh[surface] |= bit


@part
def _log(t: Any, m: Any, lane: int, kind: int, regime: int) -> int:
    """Count an event and, where there is room, log it; returns how many there were."""
    integers, job, after = m.integers, m.integers[JOB, lane], m.scratch[3]
    count = integers[EVENTS, lane]
    if count < t.n_logged:
        m.event_times[job, count] = m.rows[CLOCK, lane] + m.rows[CORRECTION, lane]
        m.event_kinds[job, count], m.event_regimes[job, count] = kind, regime
        for variable in range(t.n_states):
            m.event_states[job, count, variable] = after[variable]
    integers[EVENTS, lane] = count + 1
    m.counts[job, kind] += 1
    before, peaks = m.scratch[0], m.peaks[job, kind]
    for variable in range(t.n_states):
        peaks[variable] = max(peaks[variable], abs(before[variable]))
    if math.isnan(m.firsts[job, kind]):
        m.firsts[job, kind] = m.rows[CLOCK, lane]
        if kind == t.late_from:
            _begin_late(t, m, lane, FIXED_ROWS + t.n_variables + t.n_states)
    return int(count + 1)


@part
def _carry_over(t: Any, m: Any, lane: int, tangent_row: int, regime: int, parameters: int) -> None:
    """A perturbation across the switch whose states before and after are in the scratch."""
    d, out, stride = m.scratch[4], m.scratch[2], m.scratch.shape[1] * 8
    for variable in range(t.n_states):
        d[variable] = m.rows[tangent_row + variable, lane]
    before = t.regimes + 8 * m.integers[REGIME, lane] * t.n_constants
    after = t.regimes + 8 * regime * t.n_constants
    z, y = t.scratch, t.scratch + 3 * stride
    at, which = t.scratch + 4 * stride, m.integers[HIT, lane]
    call(t.jump, (which, z, y, parameters, before, after, at, t.scratch + 2 * stride))
    for variable in range(t.n_states):
        m.rows[tangent_row + variable, lane] = out[variable]


@part
def _switch(t: Any, m: Any, c: Any, lane: int, tangent_row: int) -> None:
    """Carry out the switch that ended a lane's step."""
    rows, integers, job = m.rows, m.integers, m.integers[JOB, lane]
    which, before = integers[HIT, lane], integers[REGIME, lane]
    if which >= t.n_switches:
        integers[OUTCOME, lane] = STOPPED + which - t.n_switches
        return
    span, clock = rows[STEP, lane], rows[CLOCK, lane]
    z, after, out = m.scratch[0], m.scratch[3], m.scratch[2]
    for variable in range(t.n_variables):
        z[variable] = c[variable, 0, lane]
        after[variable] = z[variable]
    stride = m.scratch.shape[1] * 8
    first = t.n_rows - t.n_constants - t.n_parameters
    parameters = t.rows + first * ROW + 8 * lane
    constants = t.regimes + 8 * before * t.n_constants
    call(t.change, (which, t.scratch, parameters, constants, t.scratch + 2 * stride))
    regime, kind = int(out[0]), int(out[1])
    for variable in range(t.n_states):
        after[variable] = out[2 + variable]
    if t.tangent:
        _carry_over(t, m, lane, tangent_row, regime, parameters)
    for variable in range(t.n_states):
        c[variable, 0, lane] = after[variable]
    integers[CHAINED, lane] += 1
    if span > 4.0 * 2.0**-52 * abs(clock):
        integers[CHAINED, lane] = 0
    count = _log(t, m, lane, kind, regime)
    first_time = FIXED_ROWS + t.n_variables + t.n_states + 2 * t.n_tracked
    rows[first_time + before, lane] += clock - rows[ENTERED, lane]
    rows[ENTERED, lane] = clock
    _enter(t, m, c, lane, regime, span)
    if kind == t.until:
        integers[OUTCOME, lane] = BY_EVENT
    elif integers[CHAINED, lane] >= CHAIN:
        integers[OUTCOME, lane] = ACCUMULATION
    elif count >= m.limits[job, 3]:
        integers[OUTCOME, lane] = EVENT_LIMIT


@part
def _grow(t: Any, m: Any, lane: int, tangent_row: int) -> None:
    """Note the horizon when it is passed, and scale a perturbation back."""
    job, size = m.integers[JOB, lane], _log_norm(t, m, lane, tangent_row)
    if size == -math.inf:
        return
    growth = m.summary[job, 0] + size
    if math.isnan(m.summary[job, 1]) and growth > m.limits[job, 4]:
        m.summary[job, 1] = m.rows[CLOCK, lane]
    if not 1e-6 < math.exp(2.0 * size) < 1e6:
        for variable in range(t.n_states):
            m.rows[tangent_row + variable, lane] /= math.exp(size)
        m.summary[job, 0] = growth
    _limit_growth(m, lane)


@part
def _limit_growth(m: Any, lane: int) -> None:
    """The squared size of a perturbation at which the horizon is passed."""
    job = m.integers[JOB, lane]
    left = m.limits[job, 4] - m.summary[job, 0]
    waits = math.isnan(m.summary[job, 1]) and left < 300.0
    m.rows[LOST, lane] = math.exp(2.0 * left) if waits else math.inf


@inline
def _grow_all(t: Any, m: Any, tangent_row: int, busy: int) -> None:
    """Look at perturbations that have grown or shrunk a thousandfold, or passed what is lost."""
    square = splat(0.0)
    for variable in range(t.n_states):
        part = load(t.rows + (tangent_row + variable) * ROW) * splat(1.0 / m.sizes[variable])
        square = square + part * part
    usual = bits_below(splat(1e-6), square) & bits_below(square, splat(1e6))
    bits = ~(usual & bits_below(square, load(t.rows + LOST * ROW))) & busy
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        _grow(t, m, lane, tangent_row)


@part
def _finish(t: Any, m: Any, c: Any, lane: int, tangent_row: int, first_extreme: int) -> None:
    """Write a job's results."""
    rows, job = m.rows, m.integers[JOB, lane]
    m.ends[job, 0], m.ends[job, 1] = m.integers[OUTCOME, lane], m.integers[REGIME, lane]
    m.ends[job, 2], m.ends[job, 3] = int(rows[STEPS, lane]), m.integers[EVENTS, lane]
    m.summary[job, 2] = rows[CLOCK, lane]
    for variable in range(t.n_states):
        m.final[job, variable] = c[variable, 0, lane]
    for index in range(t.n_tracked):
        for each in range(2):
            found = rows[first_extreme + 2 * index + each, lane]
            m.extremes[job, index, m.integers[LATE, lane], each] = found
    first_time = first_extreme + 2 * t.n_tracked
    rows[first_time + m.integers[REGIME, lane], lane] += rows[CLOCK, lane] - rows[ENTERED, lane]
    for regime in range(t.n_regimes):
        m.durations[job, regime] = rows[first_time + regime, lane]
    for point in range(t.n_points):
        m.half_turns[job, point] = rows[first_time + t.n_regimes + 3 * point + 2, lane]
    if t.tangent:
        m.summary[job, 0] += _log_norm(t, m, lane, tangent_row)


@part
def _start(t: Any, m: Any, c: Any, lane: int, job: int, tangent_row: int, first: int) -> None:
    """Start a job in a lane."""
    rows, integers = m.rows, m.integers
    integers[:, lane] = 0
    integers[JOB, lane], integers[OUTCOME, lane], integers[HIT, lane] = job, RUNNING, -1
    for row in (CLOCK, CORRECTION, STEPS, STEP, ENTERED):
        rows[row, lane] = 0.0
    rows[LONGEST, lane] = math.inf
    rows[T_END, lane], rows[T_LATE, lane] = m.limits[job, 0], m.limits[job, 1]
    rows[MOST_STEPS, lane] = m.limits[job, 2]
    if m.limits[job, 1] <= 0.0:
        rows[T_LATE, lane], integers[LATE, lane] = math.inf, 1
    times = m.sample_times[job]
    rows[NEXT_SAMPLE, lane] = times[0] if times.size else math.inf
    first_parameter = t.n_rows - t.n_constants - t.n_parameters
    for parameter in range(t.n_parameters):
        rows[first_parameter + parameter, lane] = m.parameters[job, parameter]
    c[: t.n_variables, :, lane] = 0.0
    for variable in range(t.n_states):
        c[variable, 0, lane] = m.initial[job, variable]
        rows[tangent_row + variable, lane] = m.sizes[variable] / math.sqrt(t.n_states)
    for index in range(t.n_tracked):
        _clear(m, lane, index, first)
    row = first + 2 * t.n_tracked
    rows[row : row + t.n_regimes, lane] = 0.0
    for point in range(t.n_points):
        row = first + 2 * t.n_tracked + t.n_regimes + 3 * point
        rows[row, lane], rows[row + 1, lane] = m.points[job, point, 0], m.points[job, point, 1]
        rows[row + 2, lane] = 0.0
    m.summary[job, 0], m.summary[job, 1] = 0.0, math.nan
    _limit_growth(m, lane)
    _enter(t, m, c, lane, m.first_regime[job], 0.0)


@inline
def _go_on(t: Any) -> None:
    """The end of each lane's step becomes the start of the next; its time is compensated."""
    at = t.rows
    for variable in range(t.n_variables):
        store(t.series + variable * t.n_terms * ROW, load(at + (FIXED_ROWS + variable) * ROW))
    store(at + STEPS * ROW, load(at + STEPS * ROW) + 1.0)
    increment = load(at + STEP * ROW) + load(at + CORRECTION * ROW)
    clock = load(at + CLOCK * ROW)
    time = clock + increment
    store(at + CORRECTION * ROW, (clock - time) + increment)
    store(at + CLOCK * ROW, time)


@inline
def _refill(
    t: Any, m: Any, c: Any, busy: int, ended: int, tangent_row: int, first_extreme: int
) -> int:
    """Finish the lanes that have ended and give them new jobs; returns the busy ones."""
    while ended:
        lane = first_bit(ended)
        ended ^= 1 << lane
        if m.integers[JOB, lane] >= 0:
            _finish(t, m, c, lane, tangent_row, first_extreme)
        busy &= ~(1 << lane)
        m.integers[JOB, lane] = -1
        if m.queue[0] < m.queue[1]:
            job = m.queue[0]
            m.queue[0] += m.queue[2]
            _start(t, m, c, lane, job, tangent_row, first_extreme)
            busy |= 1 << lane
    return busy


@inline
def _start_from_zero(t: Any, m: Any, c: Any) -> None:
    """Surfaces whose sign round-off hides start from exactly zero."""
    for surface in range(t.n_surfaces):
        bits = m.fresh[surface]
        while bits:
            lane = first_bit(bits)
            bits ^= 1 << lane
            c[t.n_variables + surface, 0, lane] = 0.0


@inline
def _switch_all(t: Any, m: Any, c: Any, special: int, tangent_row: int) -> None:
    """Carry out what ended the steps of some lanes."""
    for surface in range(t.n_surfaces):
        m.fresh[surface] = 0
    while special:
        lane = first_bit(special)
        special ^= 1 << lane
        hit = m.integers[HIT, lane]
        if hit == LATE_BEGINS:
            _begin_late(t, m, lane, tangent_row + t.n_states)
            # a surface may be crossed at this very instant
            _enter(t, m, c, lane, m.integers[REGIME, lane], m.rows[STEP, lane])
        elif hit >= 0 and m.integers[OUTCOME, lane] == RUNNING:
            _switch(t, m, c, lane, tangent_row)
        m.integers[HIT, lane] = -1


@inline
def _ended(t: Any, m: Any, special: int, busy: int) -> int:
    """Lanes whose run has ended, among those that ended their step and those out of steps."""
    spent = ~bits_below(load(t.rows + STEPS * ROW), load(t.rows + MOST_STEPS * ROW))
    bits, ended = (special | spent) & busy, 0
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        if m.integers[OUTCOME, lane] == RUNNING and spent & (1 << lane):
            m.integers[OUTCOME, lane] = STEP_LIMIT
        if m.integers[OUTCOME, lane] != RUNNING:
            ended |= 1 << lane
    return ended


@inline
def _rounds(t: Any, m: Any, c: Any) -> int:
    """Steps of all lanes until none is busy, or there were enough."""
    tangent_row = FIXED_ROWS + t.n_variables
    first_extreme = tangent_row + t.n_states
    first_time = first_extreme + 2 * t.n_tracked
    first_parameter = t.n_rows - t.n_constants - t.n_parameters
    parameters = t.rows + first_parameter * ROW
    time_unit = first_parameter + t.n_parameters - 1
    busy, ended = 0, 0
    for lane in range(LANES):
        busy |= (1 << lane) if m.integers[JOB, lane] >= 0 else 0
        ended |= (1 << lane) if m.integers[OUTCOME, lane] != RUNNING else 0
    for _ in range(t.n_rounds):
        busy = _refill(t, m, c, busy, ended, tangent_row, first_extreme)
        if not busy:
            return 0
        call(t.take_step, (t.series, parameters, t.inverses, t.n_terms))
        if t.tangent:
            call(t.longest, (t.series, parameters, t.rows + LONGEST * ROW, t.n_terms))
        _start_from_zero(t, m, c)
        special = _take_step(t, m.active, m.sizes) & busy
        due = _reaches(t.rows, NEXT_SAMPLE) & busy if t.n_samples else 0
        bits = special
        while bits:
            lane = first_bit(bits)
            bits ^= 1 << lane
            _cut(t, m, c, lane)
        while due:
            lane = first_bit(due)
            due ^= 1 << lane
            _sample(t, m, c, lane, first_time)
        _observe(t, m, c, first_extreme, busy)
        turned = _turn(t, m, first_time + t.n_regimes, busy)
        if t.tangent:
            step, at = t.rows + STEP * ROW, t.rows + tangent_row * ROW
            call(t.perturb, (t.series, parameters, step, at, t.n_terms))
        _go_on(t)
        if t.n_variables > t.n_states:
            clock = load(t.rows + CLOCK * ROW) + load(t.rows + CORRECTION * ROW)
            now = clock * load(t.rows + time_unit * ROW)
            store(t.series + t.n_states * t.n_terms * ROW, now)
        _switch_all(t, m, c, special, tangent_row)
        if t.tangent:
            _grow_all(t, m, tangent_row, busy)
        ended = _ended(t, m, special | turned, busy)
    return int(busy)


def _advance(table: Any) -> int:
    """Some rounds over all lanes; returns how many are busy. The table: :data:`TABLE`."""
    t = _numba.carray(table, (1,), TABLE)[0]
    width = max(3 * t.n_surfaces, t.n_variables) + 2
    size = t.n_states
    m = _Memory(
        rows=view(t.rows, (t.n_rows, LANES), np.float64),
        integers=view(t.integers, (FIXED_INTEGERS, LANES), np.int64),
        sizes=view(t.sizes, (size,), np.float64),
        tracked=view(t.tracked, (t.n_tracked, 2), np.int64),
        regimes=view(t.regimes, (t.n_regimes, t.n_constants), np.float64),
        falls=view(t.falls, (t.n_regimes, t.n_surfaces), np.int64),
        rises=view(t.rises, (t.n_regimes, t.n_surfaces), np.int64),
        active=view(t.active, (t.n_surfaces,), np.int64),
        fresh=view(t.fresh, (t.n_surfaces,), np.int64),
        noise=view(t.noise, (t.n_surfaces, 2, LANES), np.float64),
        scratch=view(t.scratch, (5, width), np.float64),
        initial=view(t.initial, (t.n_jobs, size), np.float64),
        parameters=view(t.parameters, (t.n_jobs, t.n_parameters), np.float64),
        first_regime=view(t.first_regime, (t.n_jobs,), np.int64),
        limits=view(t.limits, (t.n_jobs, 6), np.float64),
        final=view(t.final, (t.n_jobs, size), np.float64),
        extremes=view(t.extremes, (t.n_jobs, t.n_tracked, 2, 2), np.float64),
        counts=view(t.counts, (t.n_jobs, t.n_kinds), np.int64),
        firsts=view(t.firsts, (t.n_jobs, t.n_kinds), np.float64),
        durations=view(t.durations, (t.n_jobs, t.n_regimes), np.float64),
        ends=view(t.ends, (t.n_jobs, 4), np.int64),
        summary=view(t.summary, (t.n_jobs, 3), np.float64),
        sample_times=view(t.sample_times, (t.n_jobs, t.n_samples), np.float64),
        samples=view(t.samples, (t.n_jobs, t.n_samples, size), np.float64),
        sample_regimes=view(t.sample_regimes, (t.n_jobs, t.n_samples), np.int64),
        sample_sums=view(t.sample_sums, (t.n_jobs, t.n_samples, t.n_sums), np.float64),
        event_times=view(t.event_times, (t.n_jobs, t.n_logged), np.float64),
        event_kinds=view(t.event_kinds, (t.n_jobs, t.n_logged), np.int64),
        event_regimes=view(t.event_regimes, (t.n_jobs, t.n_logged), np.int64),
        event_states=view(t.event_states, (t.n_jobs, t.n_logged, size), np.float64),
        peaks=view(t.peaks, (t.n_jobs, t.n_kinds, size), np.float64),
        points=view(t.points, (t.n_jobs, t.n_points, 2), np.float64),
        half_turns=view(t.half_turns, (t.n_jobs, t.n_points), np.float64),
        queue=view(t.queue, (3,), np.int64),
    )
    c = view(t.series, (t.n_series, t.n_terms, LANES), np.float64)
    return int(_rounds(t, m, c))


@cache
def loop() -> Any:
    """The compiled loop, built once a process."""
    return compile_advance(_advance)
