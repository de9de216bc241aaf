"""What happens to a lane after each Taylor step: events, ends, refilling; compiled.

All quantities are in units of m = k1 = l_pre = 1.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.methods.lanes import LANES, compile_advance, float_view, inline, integer_view, part
from squealpipe.methods.taylor_polynomial import evaluate
from squealpipe.models import switching
from squealpipe.sources import closure
from squealpipe.tasks.lane_layout import (
    BELT_SPEED,
    CLOCK,
    COEFFICIENTS,
    CONVERGED,
    CORRECTION,
    COUNT,
    COUNTS,
    EARLY_LARGEST_X,
    EVENT_KINDS,
    EVENT_LIMIT,
    EVENT_STATES,
    EVENT_TIMES,
    EVENTS,
    FINAL_STATE,
    FIRST_KIND,
    FIRST_SEPARATION,
    FIRST_TANGENT,
    HALF_TURNS1,
    HALF_TURNS2,
    IDLE,
    INITIAL,
    INTEGERS,
    JOB,
    LAST_STEP,
    LATE_EVENTS,
    LATE_LARGEST_X,
    LINEAR_SPRINGS,
    LOG_GROWTH,
    LOST_GROWTH,
    MAX_EVENTS,
    MAX_STEPS,
    MEMORY,
    N_COUNTS,
    N_INTEGERS,
    N_JOBS,
    N_LOGGED,
    N_MEMORY,
    N_ORDERS,
    N_PARS,
    N_RESULTS,
    N_SAMPLES,
    N_TERMS,
    N_VARIABLES,
    NEAREST_PIVOT2,
    NOT_FINITE,
    ORDER,
    ORDERS,
    OUTCOME,
    PARS,
    PIVOT_REACH2,
    QUEUE,
    REACHED,
    REGIME,
    RESULT,
    RESULTS,
    REVERSES,
    RUNNING,
    SAMPLE_REGIMES,
    SAMPLE_TIMES,
    SAMPLES,
    SEPARATED,
    SEPARATES,
    SEPARATION_FOUND,
    SINGULAR,
    STATE,
    STEP_LIMIT,
    STEPS,
    STICK,
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
from squealpipe.tasks.lane_start import idle, lane_parameters, load, set_regime


@inline
def _near_surface(state: Any, m: Any, lane: int, regime: int, step: float) -> Any:
    """Whether ``switching.switch`` must look at the state; cheap and on the safe side."""
    y, reach = state[1, lane], 1e-12 * (1.0 + abs(state[1, lane]) + step * abs(state[3, lane]))
    if regime == SEPARATED:
        return y <= 1.0 + reach
    if regime == STICK or (y >= 1.0 - reach and m[SEPARATES] > 0.0):
        return True
    gap = m[BELT_SPEED] - state[2, lane] if regime == 0 else state[2, lane] - m[BELT_SPEED]
    return m[REVERSES] > 0.0 and gap <= 1e-12 * (1.0 + abs(m[BELT_SPEED]))


@inline
def _finite(state: Any, step: float, lane: int) -> bool:
    total = step
    for variable in range(state.shape[0]):
        total += 0.0 * state[variable, lane]
    return math.isfinite(total)


@inline
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
    p, g, rules = lane_parameters(memory, lane)
    change = switching.switch(x, y, vx, vy, regime, step, p, g, rules)
    state[1, lane], state[2, lane] = change.y, change.vx
    if change.kind == switching.CHATTER:
        return np.nan
    if change.kind >= 0:
        _record(state, integers, lane, change.kind, time, events)
        integers[lane, COUNT + LATE_EVENTS] += change.late
        integers[lane, COUNT + REGIME] = change.regime
        set_regime(pars, memory, lane, change.regime)
        never = math.isnan(memory[lane, RESULT + FIRST_SEPARATION])
        if change.kind == switching.SEPARATION and never:
            memory[lane, RESULT + FIRST_SEPARATION] = time
    return change.saltation


@inline
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
    dim, terms, jobs = table[N_VARIABLES], table[N_TERMS], table[N_JOBS]
    samples, logged = table[N_SAMPLES], table[N_LOGGED]
    state = float_view(table[STATE], (dim, LANES))
    pars = float_view(table[PARS], (table[N_PARS], LANES))
    c = float_view(table[COEFFICIENTS], (dim, terms, LANES))
    last_step = float_view(table[LAST_STEP], (1, LANES))
    memory = float_view(table[MEMORY], (LANES, N_MEMORY))
    integers = integer_view(table[INTEGERS], (LANES, N_INTEGERS))
    times = float_view(table[SAMPLE_TIMES], (jobs, samples))
    states = float_view(table[SAMPLES], (jobs, samples, 4))
    regimes = integer_view(table[SAMPLE_REGIMES], (jobs, samples))
    events = (
        float_view(table[EVENT_TIMES], (jobs, logged)),
        integer_view(table[EVENT_KINDS], (jobs, logged)),
        float_view(table[EVENT_STATES], (jobs, logged, 4)),
    )
    queue = integer_view(table[QUEUE], (1, 3))
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
            result = float_view(table[RESULTS], (jobs, N_RESULTS))[job]
            counts = integer_view(table[COUNTS], (jobs, N_COUNTS))[job]
            _finish(state, memory, integers, lane, result, counts)
        if job == IDLE or queue[0, 0] >= queue[0, 1]:
            integers[lane, JOB] = IDLE
            idle(state, pars, lane)
        else:
            job = queue[0, 0]
            queue[0, 0] += queue[0, 2]
            integers[lane, JOB] = job
            orders = float_view(table[ORDERS], (jobs, N_ORDERS))
            for index in range(N_ORDERS):
                memory[lane, ORDER + index] = orders[job, index]
            initial = float_view(table[INITIAL], (jobs, 4))[job]
            load(state, pars, memory, integers, initial, lane)
            busy += 1
    return busy


@cache
def lane_kernel() -> Any:
    """The compiled round, built once a process."""
    return compile_advance(_advance, [Path(__file__), *closure(__file__)])
