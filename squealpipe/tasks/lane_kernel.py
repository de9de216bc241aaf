"""What happens to a lane after each Taylor step: events, ends, refilling; compiled.

All quantities are in units of m = k1 = l_pre = 1.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numba.extending import register_jitable

from squealpipe.laws import contact, springs
from squealpipe.methods.lanes import (
    LANES,
    PART_OPTIONS,
    compile_advance,
    evaluate,
    float_view,
    integer_view,
    part,
)
from squealpipe.models import switching
from squealpipe.models.switching import Rules, ScaledParameters
from squealpipe.sources import closure
from squealpipe.tasks.lane_layout import (
    CLOCK,
    CONVERGED,
    CORRECTION,
    COUNT,
    EARLY_LARGEST_X,
    EVENT_LIMIT,
    EVENTS,
    FINAL_STATE,
    FIRST_KIND,
    FIRST_SEPARATION,
    FIRST_TANGENT,
    HALF_TURNS1,
    HALF_TURNS2,
    HIGHEST_Y,
    HORIZON,
    IDLE,
    JOB,
    LARGEST_R2,
    LARGEST_SPEED,
    LATE_EVENTS,
    LATE_LARGEST_X,
    LINEAR_SPRINGS,
    LOG_GROWTH,
    LOST_GROWTH,
    LOWEST_Y,
    MAX_EVENTS,
    MAX_STEPS,
    N_COUNTS,
    N_INTEGERS,
    N_MEMORY,
    N_ORDERS,
    N_PHYSICAL,
    N_RESULTS,
    NEAREST_PIVOT2,
    NEXT_SAMPLE,
    NOT_FINITE,
    ORDER,
    OUTCOME,
    PIVOT_REACH2,
    PIVOTS,
    REACHED,
    REGIME,
    RESULT,
    REVERSES,
    RUNNING,
    SEPARATED,
    SEPARATES,
    SEPARATION_FOUND,
    SINGULAR,
    STEP_LIMIT,
    STEPS,
    STICK,
    STICKS,
    STOP_AT_SEPARATION,
    STOP_AT_TURNS,
    STOP_AT_X,
    SUSPECT_PIVOT2,
    T_END,
    TANGENT_NORM,
    TIME,
    UNRESOLVED,
)
from squealpipe.tasks.lane_observers import grow, observe, sample

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
    register_jitable(**PART_OPTIONS)(law)


@part
def _parameters(memory: Any, lane: int) -> Any:
    m = memory[lane, ORDER:]
    p = ScaledParameters(1.0, 1.0, m[0], m[1], m[2], m[3], 1.0, m[4], m[5])
    rules = Rules(m[SEPARATES] > 0.0, m[REVERSES] > 0.0, m[STICKS] > 0.0, m[LINEAR_SPRINGS] > 0.0)
    return p, springs.Geometry(m[6], m[7], m[8], m[9]), rules


@part
def _set_regime(pars: Any, memory: Any, lane: int, regime: int) -> None:
    """Write a regime into the lane's parameters (see ``tasks.a1_system.REGIME``)."""
    slipping = regime not in (SEPARATED, STICK)
    pars[10, lane] = 0.0 if regime == SEPARATED else 1.0
    pars[11, lane] = 0.0 if not slipping else (1.0 if regime == 0 else -1.0)
    pars[12, lane] = 1.0 if regime == STICK else 0.0
    pars[13, lane] = memory[lane, ORDER + REVERSES] if slipping else 0.0
    pars[14, lane] = memory[lane, ORDER + SEPARATES]
    pars[15, lane] = 1.0 / (1.0 + abs(memory[lane, ORDER + 3]))


@part
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


@part
def _idle(state: Any, pars: Any, lane: int) -> None:
    """The state of rest in contact, again after each step: a finite step without events."""
    for variable in range(state.shape[0]):
        state[variable, lane] = 0.0
    pars[10, lane], pars[12, lane] = 1.0, 0.0
    pars[13, lane], pars[14, lane] = 0.0, 0.0


@part
def _near_surface(state: Any, m: Any, lane: int, regime: int, step: float) -> Any:
    """Whether ``switching.switch`` must look at the state; cheap and on the safe side."""
    y, reach = state[1, lane], 1e-12 * (1.0 + abs(state[1, lane]) + step * abs(state[3, lane]))
    if regime == SEPARATED:
        return y <= 1.0 + reach
    if regime == STICK or (y >= 1.0 - reach and m[SEPARATES] > 0.0):
        return True
    gap = m[3] - state[2, lane] if regime == 0 else state[2, lane] - m[3]
    return m[REVERSES] > 0.0 and gap <= 1e-12 * (1.0 + abs(m[3]))


@part
def _finite(state: Any, step: float, lane: int) -> bool:
    total = step
    for variable in range(state.shape[0]):
        total += 0.0 * state[variable, lane]
    return math.isfinite(total)


@part
def _advance_lane(
    state: Any, pars: Any, c: Any, step: float, memory: Any, integers: Any, lane: int, events: Any
) -> Any:
    """Observe one lane's step and handle its event; returns the outcome, or RUNNING."""
    regime = integers[lane, COUNT + REGIME]
    m, result = memory[lane, ORDER:], memory[lane, RESULT:]
    if not _finite(state, step, lane):
        for variable in range(state.shape[0]):
            state[variable, lane] = c[variable, 0, lane]
        return SINGULAR if result[NEAREST_PIVOT2] < SUSPECT_PIVOT2 else NOT_FINITE
    integers[lane, COUNT + STEPS] += 1
    remaining = (m[T_END] - memory[lane, CLOCK]) - memory[lane, CORRECTION]
    if remaining <= step:
        # t_end never shortens a step: the state there is read off the Taylor polynomial.
        for variable in range(state.shape[0]):
            state[variable, lane] = evaluate(c, variable, lane, remaining)
        step = remaining
    end = (state[0, lane], state[1, lane], state[2, lane], state[3, lane])
    if step > 0.0:
        observe(c, end, memory, lane, regime, step)
    increment = step + memory[lane, CORRECTION]
    time = memory[lane, CLOCK] + increment
    memory[lane, CORRECTION] = (memory[lane, CLOCK] - time) + increment
    memory[lane, CLOCK] = time
    if remaining <= step:
        return CONVERGED
    if result[NEAREST_PIVOT2] < PIVOT_REACH2 and m[LINEAR_SPRINGS] == 0.0:
        return SINGULAR
    saltation = 1.0
    if _near_surface(state, m, lane, regime, step):
        saltation = _switch(state, pars, memory, integers, lane, step, time, events)
    if state.shape[0] > FIRST_TANGENT:
        grow(state, result, lane, time, saltation, m[LOST_GROWTH])
    return _stop_reason(m, result, integers, lane, saltation)


@part
def _switch(
    state: Any,
    pars: Any,
    memory: Any,
    integers: Any,
    lane: int,
    step: float,
    time: float,
    events: Any,
) -> float:
    """Change the regime if it is due; returns the saltation factor, NaN where none exists."""
    regime = integers[lane, COUNT + REGIME]
    x, y, vx, vy = state[0, lane], state[1, lane], state[2, lane], state[3, lane]
    p, g, rules = _parameters(memory, lane)
    change = switching.switch(x, y, vx, vy, regime, step, p, g, rules)
    state[1, lane], state[2, lane] = change.y, change.vx
    if change.kind == switching.CHATTER:
        return np.nan
    if change.kind >= 0:
        _record(state, integers, lane, change.kind, time, events)
        integers[lane, COUNT + LATE_EVENTS] += change.late
        integers[lane, COUNT + REGIME] = change.regime
        _set_regime(pars, memory, lane, change.regime)
        never = math.isnan(memory[lane, RESULT + FIRST_SEPARATION])
        if change.kind == switching.SEPARATION and never:
            memory[lane, RESULT + FIRST_SEPARATION] = time
    return change.saltation


@part
def _stop_reason(m: Any, result: Any, integers: Any, lane: int, saltation: float) -> int:
    """The outcome if the run is to end here, or RUNNING."""
    outcome = RUNNING
    if integers[lane, COUNT + STEPS] >= m[MAX_STEPS]:
        outcome = STEP_LIMIT
    if integers[lane, COUNT + EVENTS] >= m[MAX_EVENTS] or math.isnan(saltation):
        outcome = EVENT_LIMIT
    far = max(result[EARLY_LARGEST_X], result[LATE_LARGEST_X]) > m[STOP_AT_X]
    turns = 0.5 * min(abs(result[HALF_TURNS1]), abs(result[HALF_TURNS2]))
    if far or turns >= m[STOP_AT_TURNS]:
        outcome = REACHED
    if m[STOP_AT_SEPARATION] > 0.0 and not math.isnan(result[FIRST_SEPARATION]):
        outcome = SEPARATION_FOUND
    return outcome


@part
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


@part
def _finish(state: Any, memory: Any, integers: Any, lane: int, result: Any, counts: Any) -> None:
    """Write a job's results."""
    memory[lane, RESULT + TIME] = memory[lane, CLOCK]
    for variable in range(4):
        memory[lane, RESULT + FINAL_STATE + variable] = state[variable, lane]
    for index in range(N_RESULTS):
        result[index] = memory[lane, RESULT + index]
    for index in range(N_COUNTS):
        counts[index] = integers[lane, COUNT + index]
    if state.shape[0] > FIRST_TANGENT:
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
                sample(c, memory, integers, lane, times[job], states[job], regimes[job], used)
            outcome = _advance_lane(state, pars, c, step, memory, integers, lane, events)
            if outcome == RUNNING:
                busy += 1
                continue
            answered = outcome in (CONVERGED, SEPARATION_FOUND, REACHED)
            if answered and integers[lane, COUNT + LATE_EVENTS] > 0:
                outcome = UNRESOLVED
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
