"""What happens to a lane after each Taylor step: observation, events, refilling; compiled.

All quantities are in units of m = k1 = l_pre = 1. The functions see one step through its Taylor
coefficients ``c[variable, order, lane]``, so extrema and samples inside it need no integration.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.extending import register_jitable

from squealpipe.laws import contact, springs
from squealpipe.methods.lanes import (
    LANES,
    compile_advance,
    evaluate,
    float_view,
    integer_view,
    root_of,
)
from squealpipe.models import switching
from squealpipe.models.switching import Rules, ScaledParameters
from squealpipe.schema import Outcome
from squealpipe.sources import closure

# A job's order: its physical parameters (tasks.a1_system.PHYSICAL), then what is asked for.
N_PHYSICAL = 10
T_END, T_LATE, STOP_AT_X, STOP_AT_SEPARATION, MAX_STEPS, MAX_EVENTS = range(10, 16)
SEPARATES, REVERSES, STICKS, LINEAR_SPRINGS, LOST_GROWTH, STOP_AT_TURNS = range(16, 22)
N_ORDERS = 22
# A job's floating-point results.
TIME, FIRST_SEPARATION, SEPARATED_TIME, STICK_TIME, LOWEST_Y, LARGEST_R2 = range(6)
EARLY_LARGEST_X, LATE_LARGEST_X, LARGEST_SPEED, NEAREST_PIVOT2 = range(6, 10)
HIGHEST_Y, HALF_TURNS1, HALF_TURNS2, LOG_GROWTH, HORIZON, FINAL_STATE = range(10, 16)
N_RESULTS = FINAL_STATE + 4
# A job's integer results; the counts of the five kinds of events come last.
OUTCOME, REGIME, STEPS, LATE_EVENTS, EVENTS, FIRST_KIND = range(6)
N_COUNTS = 11
# A lane's memory: its compensated time, the pivots, then the job's order and results so far.
CLOCK, CORRECTION, PIVOTS, ORDER = 0, 1, 2, 6
RESULT = ORDER + N_ORDERS
N_MEMORY = RESULT + N_RESULTS
# A lane's integer memory: job, next sample, then the counts.
JOB, NEXT_SAMPLE, COUNT = 0, 1, 2
N_INTEGERS = COUNT + N_COUNTS

TANGENT_NORM = 1e-4
"""Norm that a tangent vector is scaled back to: small, so that it does not set the step size."""
PIVOT_REACH2 = 1e-14
"""Squared distance from a pivot, in free lengths, below which the force's direction is lost."""
JUMP2 = 1e-2
"""A step that ends its approach to a pivot this much nearer than it began, squared, has jumped over
the singularity: straight through a pivot the Taylor series of the force is smooth to round-off."""

SEPARATED, STICK = switching.SEPARATED, switching.STICK
CONVERGED, SEPARATION_FOUND = int(Outcome.converged), int(Outcome.separated)
STEP_LIMIT, EVENT_LIMIT = int(Outcome.step_limit), int(Outcome.event_limit)
SINGULAR, NOT_FINITE = int(Outcome.singular_geometry), int(Outcome.not_finite)
REACHED, UNRESOLVED = int(Outcome.amplitude_reached), int(Outcome.unresolved)
RUNNING, IDLE, EMPTY = -1, -1, -2

for law in (
    springs.fixed_ends,
    springs.squared_distance,
    springs.spring_force,
    springs.elastic_force,
    springs.linear_stiffness,
    springs.linear_elastic_force,
    contact.contact_force,
    *switching.COMPILED,
):
    register_jitable(no_cpython_wrapper=True, no_cfunc_wrapper=True)(law)

_njit = numba.njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


@_njit
def _parameters(memory: Any, lane: int) -> Any:
    m = memory[lane, ORDER:]
    p = ScaledParameters(1.0, 1.0, m[0], m[1], m[2], m[3], 1.0, m[4], m[5])
    rules = Rules(m[SEPARATES] > 0.0, m[REVERSES] > 0.0, m[STICKS] > 0.0, m[LINEAR_SPRINGS] > 0.0)
    return p, springs.Geometry(m[6], m[7], m[8], m[9]), rules


@_njit
def _set_regime(pars: Any, memory: Any, lane: int, regime: int) -> None:
    """Write a regime into the lane's parameters (see ``tasks.a1_system.REGIME``)."""
    slipping = regime not in (SEPARATED, STICK)
    pars[10, lane] = 0.0 if regime == SEPARATED else 1.0
    pars[11, lane] = 0.0 if not slipping else (1.0 if regime == 0 else -1.0)
    pars[12, lane] = 1.0 if regime == STICK else 0.0
    pars[13, lane] = memory[lane, ORDER + REVERSES] if slipping else 0.0
    pars[14, lane] = memory[lane, ORDER + SEPARATES]
    pars[15, lane] = 1.0 / (1.0 + abs(memory[lane, ORDER + 3]))


@_njit
def _load(state: Any, pars: Any, memory: Any, integers: Any, initial: Any, lane: int) -> None:
    """Start the job whose order is in the lane's memory."""
    p, g, rules = _parameters(memory, lane)
    x, vy = initial[0], initial[3]
    regime, y, vx = switching.start(x, initial[1], initial[2], vy, p, g, rules)
    for index in range(N_PHYSICAL):
        pars[index, lane] = memory[lane, ORDER + index]
    _set_regime(pars, memory, lane, regime)
    state[0, lane], state[1, lane], state[2, lane], state[3, lane] = x, y, vx, vy
    for index in range(4, state.shape[0]):
        state[index, lane] = 0.5 * TANGENT_NORM
    m = memory[lane]
    m[CLOCK] = m[CORRECTION] = 0.0
    m[PIVOTS], m[PIVOTS + 1] = p.length1 * g.c1, p.length1 * g.s1
    m[PIVOTS + 2], m[PIVOTS + 3] = -p.length2 * g.c2, p.length2 * g.s2
    for index in range(RESULT, N_MEMORY):
        memory[lane, index] = 0.0
    m = memory[lane, RESULT:]
    m[FIRST_SEPARATION] = 0.0 if regime == SEPARATED else np.nan
    m[HORIZON] = np.nan
    m[LOWEST_Y], m[HIGHEST_Y] = (np.inf, -np.inf) if regime == SEPARATED else (y, y)
    m[LARGEST_R2] = x * x + y * y
    m[EARLY_LARGEST_X] = abs(x)
    m[LARGEST_SPEED] = vx
    nearest = min(
        ((x - p.length1 * g.c1) ** 2 + (y - p.length1 * g.s1) ** 2) / p.length1**2,
        ((x + p.length2 * g.c2) ** 2 + (y - p.length2 * g.s2) ** 2) / p.length2**2,
    )
    m[NEAREST_PIVOT2] = nearest
    for index in range(NEXT_SAMPLE, N_INTEGERS):
        integers[lane, index] = 0
    integers[lane, COUNT + REGIME] = regime


@_njit
def _idle(state: Any, pars: Any, lane: int) -> None:
    """The state of rest in contact, again after each step: a finite step without events."""
    for variable in range(state.shape[0]):
        state[variable, lane] = 0.0
    pars[10, lane], pars[12, lane] = 1.0, 0.0
    pars[13, lane], pars[14, lane] = 0.0, 0.0


@_njit
def _observe(c: Any, end: Any, memory: Any, lane: int, regime: int, step: float) -> None:
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
        if vy0 < 0.0 < vy1 and low + step * vy0 < m[LOWEST_Y]:
            low = min(low, evaluate(c, 1, lane, root_of(c, 3, lane, step, vy0, vy1)))
        m[LOWEST_Y] = min(m[LOWEST_Y], low)
        high = max(y0, y1)
        if vy0 > 0.0 > vy1 and high + step * vy0 > m[HIGHEST_Y]:
            high = max(high, evaluate(c, 1, lane, root_of(c, 3, lane, step, vy0, vy1)))
        m[HIGHEST_Y] = max(m[HIGHEST_Y], high)
    large = max(abs(x0), abs(x1))
    window = EARLY_LARGEST_X
    if memory[lane, CLOCK] >= memory[lane, ORDER + T_LATE]:
        window = LATE_LARGEST_X
    if vx0 * vx1 < 0.0 and large + step * abs(vx0) > m[window]:
        large = max(large, abs(evaluate(c, 0, lane, root_of(c, 2, lane, step, vx0, vx1))))
    m[window] = max(m[window], large)
    m[LARGEST_SPEED] = max(m[LARGEST_SPEED], vx1)
    out0, out1 = x0 * vx0 + y0 * vy0, x1 * vx1 + y1 * vy1
    largest = x1 * x1 + y1 * y1
    if out0 > 0.0 > out1 and largest - 2.0 * step * out1 > m[LARGEST_R2]:
        largest = max(largest, _turning_distance2(c, lane, step, 0.0, 0.0, out0, out1))
    m[LARGEST_R2] = max(m[LARGEST_R2], largest)
    for number in range(2):
        px, py = memory[lane, PIVOTS + 2 * number], memory[lane, PIVOTS + 2 * number + 1]
        scale = memory[lane, ORDER + 4 + number] ** -2
        if (x0 < px) != (x1 < px):
            m[HALF_TURNS1 + number] += 1.0 if (y1 > py) == (x1 < px) else -1.0
        near = (x1 - px) ** 2 + (y1 - py) ** 2
        out0, out1 = (x0 - px) * vx0 + (y0 - py) * vy0, (x1 - px) * vx1 + (y1 - py) * vy1
        if out0 < 0.0 < out1:
            near = min(near, _turning_distance2(c, lane, step, px, py, out0, out1))
            if near < JUMP2 * ((x0 - px) ** 2 + (y0 - py) ** 2):
                near = 0.0
        m[NEAREST_PIVOT2] = min(m[NEAREST_PIVOT2], near * scale)


@_njit
def _turning_distance2(
    c: Any, lane: int, step: float, px: float, py: float, first: float, last: float
) -> float:
    """Squared distance from a point where the radial velocity about it changes its sign."""
    low, high, middle = 0.0, step, 0.5 * step
    for _ in range(5):
        middle = low - first * (high - low) / (last - first)
        x, y = evaluate(c, 0, lane, middle) - px, evaluate(c, 1, lane, middle) - py
        out = x * evaluate(c, 2, lane, middle) + y * evaluate(c, 3, lane, middle)
        if (out > 0.0) == (first > 0.0):
            low, first, last = middle, out, 0.5 * last
        else:
            high, last, first = middle, out, 0.5 * first
    x, y = evaluate(c, 0, lane, middle) - px, evaluate(c, 1, lane, middle) - py
    return x * x + y * y


@_njit
def _sample(
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
        for variable in range(4):
            samples[following, variable] = evaluate(c, variable, lane, offset)
        regimes[following] = integers[lane, COUNT + REGIME]
        following += 1
    integers[lane, NEXT_SAMPLE] = following


@_njit
def _grow(state: Any, m: Any, lane: int, time: float, saltation: float, lost: float) -> None:
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


@_njit
def _near_surface(state: Any, m: Any, lane: int, regime: int, step: float) -> bool:
    """Whether ``switching.switch`` must look at the state; cheap and on the safe side."""
    y, reach = state[1, lane], 1e-12 * (1.0 + abs(state[1, lane]) + step * abs(state[3, lane]))
    if regime == SEPARATED:
        return y <= 1.0 + reach
    if regime == STICK or (y >= 1.0 - reach and m[SEPARATES] > 0.0):
        return True
    gap = m[3] - state[2, lane] if regime == 0 else state[2, lane] - m[3]
    return m[REVERSES] > 0.0 and gap <= 1e-12 * (1.0 + abs(m[3]))


@_njit
def _advance_lane(
    state: Any, pars: Any, c: Any, step: float, memory: Any, integers: Any, lane: int, events: Any
) -> int:
    """Observe one lane's step and handle its event; returns the outcome, or RUNNING."""
    regime = integers[lane, COUNT + REGIME]
    m, result = memory[lane, ORDER:], memory[lane, RESULT:]
    total = step
    for variable in range(state.shape[0]):
        total += 0.0 * state[variable, lane]
    if not math.isfinite(total):
        for variable in range(state.shape[0]):
            state[variable, lane] = c[variable, 0, lane]
        return SINGULAR if result[NEAREST_PIVOT2] < 1e-6 else NOT_FINITE
    integers[lane, COUNT + STEPS] += 1
    remaining = (m[T_END] - memory[lane, CLOCK]) - memory[lane, CORRECTION]
    if remaining <= step:
        # t_end never shortens a step: the state there is read off the Taylor polynomial.
        for variable in range(state.shape[0]):
            state[variable, lane] = evaluate(c, variable, lane, remaining)
        step = remaining
    end = (state[0, lane], state[1, lane], state[2, lane], state[3, lane])
    if step > 0.0:
        _observe(c, end, memory, lane, regime, step)
    increment = step + memory[lane, CORRECTION]
    time = memory[lane, CLOCK] + increment
    memory[lane, CORRECTION] = (memory[lane, CLOCK] - time) + increment
    memory[lane, CLOCK] = time
    if remaining <= step:
        return UNRESOLVED if integers[lane, COUNT + LATE_EVENTS] > 0 else CONVERGED
    if result[NEAREST_PIVOT2] < PIVOT_REACH2 and m[LINEAR_SPRINGS] == 0.0:
        return SINGULAR
    saltation = 1.0
    if _near_surface(state, m, lane, regime, step):
        p, g, rules = _parameters(memory, lane)
        change = switching.switch(end[0], end[1], end[2], end[3], regime, step, p, g, rules)
        state[1, lane], state[2, lane] = change.y, change.vx
        if change.kind == switching.CHATTER:
            return EVENT_LIMIT
        if change.kind >= 0:
            saltation = change.saltation
            _record(state, integers, lane, change.kind, time, events)
            integers[lane, COUNT + LATE_EVENTS] += change.late
            integers[lane, COUNT + REGIME] = change.regime
            _set_regime(pars, memory, lane, change.regime)
            if change.kind == switching.SEPARATION and math.isnan(result[FIRST_SEPARATION]):
                result[FIRST_SEPARATION] = time
    if state.shape[0] > 4:
        _grow(state, result, lane, time, saltation, m[LOST_GROWTH])
    if m[STOP_AT_SEPARATION] > 0.0 and not math.isnan(result[FIRST_SEPARATION]):
        return SEPARATION_FOUND
    if max(result[EARLY_LARGEST_X], result[LATE_LARGEST_X]) > m[STOP_AT_X]:
        return REACHED
    if min(abs(result[HALF_TURNS1]), abs(result[HALF_TURNS2])) >= 2.0 * m[STOP_AT_TURNS]:
        return REACHED
    if integers[lane, COUNT + EVENTS] >= m[MAX_EVENTS]:
        return EVENT_LIMIT
    return STEP_LIMIT if integers[lane, COUNT + STEPS] >= m[MAX_STEPS] else RUNNING


@_njit
def _record(
    state: Any, integers: Any, lane: int, kind: int, time: float, events: tuple[Any, Any, Any]
) -> None:
    """Count an event and, where there is room, log it."""
    times, kinds, states = events
    job, total = integers[lane, JOB], integers[lane, COUNT + EVENTS]
    integers[lane, COUNT + EVENTS] += 1
    integers[lane, COUNT + FIRST_KIND + kind] += 1
    if total < times.shape[1]:
        times[job, total], kinds[job, total] = time, kind
        for variable in range(4):
            states[job, total, variable] = state[variable, lane]


@_njit
def _finish(state: Any, memory: Any, integers: Any, lane: int, result: Any, counts: Any) -> None:
    """Write a job's results."""
    memory[lane, RESULT + TIME] = memory[lane, CLOCK]
    for variable in range(4):
        memory[lane, RESULT + FINAL_STATE + variable] = state[variable, lane]
    for index in range(N_RESULTS):
        result[index] = memory[lane, RESULT + index]
    for index in range(N_COUNTS):
        counts[index] = integers[lane, COUNT + index]
    if state.shape[0] > 4:
        square = 0.0
        for variable in range(4, 8):
            square += state[variable, lane] ** 2
        if square > 0.0:
            result[LOG_GROWTH] += math.log(math.sqrt(square) / TANGENT_NORM)


def _advance(table: Any) -> int:
    """One round over all lanes; returns how many are busy. See ``tasks.ensemble`` for the table."""
    dim, terms, jobs, samples, logged = table[17], table[19], table[20], table[21], table[22]
    state = float_view(table[0], (dim, LANES))
    pars = float_view(table[1], (table[18], LANES))
    c = float_view(table[2], (dim, terms, LANES))
    last_step = float_view(table[3], (1, LANES))
    memory = float_view(table[4], (LANES, N_MEMORY))
    integers = integer_view(table[5], (LANES, N_INTEGERS))
    times = float_view(table[10], (jobs, samples))
    states = float_view(table[11], (jobs, samples, 4))
    regimes = integer_view(table[12], (jobs, samples))
    events = (
        float_view(table[13], (jobs, logged)),
        integer_view(table[14], (jobs, logged)),
        float_view(table[15], (jobs, logged, 4)),
    )
    queue = integer_view(table[16], (1, 3))
    busy = 0
    for lane in range(LANES):
        job = integers[lane, JOB]
        outcome = CONVERGED
        if job >= 0:
            step = last_step[0, lane]
            if samples > 0 and math.isfinite(step):
                remaining = (memory[lane, ORDER + T_END] - memory[lane, CLOCK]) - memory[
                    lane, CORRECTION
                ]
                used = min(step, remaining)
                _sample(c, memory, integers, lane, times[job], states[job], regimes[job], used)
            outcome = _advance_lane(state, pars, c, step, memory, integers, lane, events)
            if outcome == RUNNING:
                busy += 1
                continue
            integers[lane, COUNT + OUTCOME] = outcome
            result = float_view(table[8], (jobs, N_RESULTS))[job]
            counts = integer_view(table[9], (jobs, N_COUNTS))[job]
            _finish(state, memory, integers, lane, result, counts)
        if job == IDLE or queue[0, 0] >= queue[0, 1]:
            integers[lane, JOB] = IDLE
            _idle(state, pars, lane)
        else:
            job = queue[0, 0]
            queue[0, 0] += queue[0, 2]
            integers[lane, JOB] = job
            orders = float_view(table[6], (jobs, N_ORDERS))
            for index in range(N_ORDERS):
                memory[lane, ORDER + index] = orders[job, index]
            initial = float_view(table[7], (jobs, 4))[job]
            _load(state, pars, memory, integers, initial, lane)
            busy += 1
    return busy


@cache
def lane_kernel() -> Any:
    """The compiled round, built once a process."""
    return compile_advance(_advance, [Path(__file__), *closure(__file__)])
