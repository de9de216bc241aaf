"""The compiled loop of an ensemble: a Taylor step of all lanes, then its events and its ends.

After each step all lanes are looked at side by side. A lane in which nothing ends, no event may
lie and no sample is due takes no path of its own. All quantities are in units of
m = k1 = l_pre = 1.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba import literal_unroll

from squealpipe.methods.compiled import inline, part
from squealpipe.methods.taylor.lanes import call, compile_advance, view
from squealpipe.methods.taylor.simd import (
    LANES,
    ROW,
    bits_below,
    first_bit,
    larger,
    load,
    magnitude,
    smaller,
    store,
)
from squealpipe.models import switching
from squealpipe.rerun.sources import closure
from squealpipe.solvers.a1.observers import (
    grow,
    norm_of,
    observe,
    observe_pivot,
    sample,
    watch_growth,
)
from squealpipe.solvers.a1.records import (
    AT,
    CODES,
    IDLE,
    LANE,
    MARKS,
    OBSERVED,
    ORDER,
    QUEUE,
    RESULT,
    RUNNING,
    SEPARATED,
    STICK,
    TABLE,
    TANGENT_NORM,
)
from squealpipe.solvers.a1.start import set_regime, start_job
from squealpipe.solvers.a1.steps import AT_STATE, N_EVENTS, N_STATE, end_of_step, reaches, take_step
from squealpipe.solvers.a1.system import PARAMETERS

_numba: Any = numba
FIRST_PARAMETER = getattr(AT, PARAMETERS[0])


@part
def _near_surface(lanes: Any, order: Any, lane: int, regime: int) -> Any:
    """Whether ``switching.switch`` must look at the state; cheap and on the safe side."""
    y, step = lanes.y[lane], lanes.step[lane]
    reach = 1e-12 * (1.0 + abs(y) + step * abs(lanes.vy[lane]))
    if regime == SEPARATED:
        return y <= 1.0 + reach
    if regime == STICK or (y >= 1.0 - reach and order.separates > 0.0):
        return True
    gap = order.belt_speed - lanes.vx[lane]
    if regime != 0:
        gap = -gap
    return order.reverses > 0.0 and gap <= 1e-12 * (1.0 + abs(order.belt_speed))


@part
def _switch(lanes: Any, c: Any, order: Any, result: Any, lane: int, events: Any) -> Any:
    """Change the regime if it is due; returns an outcome or RUNNING."""
    x, y, vx, vy = c[0, 0, lane], c[1, 0, lane], c[2, 0, lane], c[3, 0, lane]
    step = lanes.step[lane]
    change = switching.switch(x, y, vx, vy, result.regime, step, order, order, order)
    c[1, 0, lane], c[2, 0, lane] = change.y, change.vx
    if change.kind == switching.CHATTER:
        return CODES.event_limit
    kick = change.kick
    lanes.dvx[lane] = (
        change.saltation * lanes.dvx[lane]
        + kick[0] * lanes.dx[lane]
        + kick[1] * lanes.dy[lane]
        + kick[2] * lanes.dvx[lane]
        + kick[3] * lanes.dvy[lane]
    )
    if change.kind >= 0:
        _record(lanes, c, result, lane, change.kind, events)
        result.late_events += change.late
        result.regime = change.regime
        set_regime(lanes, order, lane, change.regime)
        if change.kind == switching.SEPARATION and math.isnan(result.first_separation):
            result.first_separation = lanes.clock[lane]
        if change.kind == switching.CONTACT:
            _return_to_belt(lanes, result, lane, change.y, abs(vy))
    if order.stop_at_separation > 0.0 and not math.isnan(result.first_separation):
        return CODES.separated
    return CODES.event_limit if result.events >= order.max_events else RUNNING


@part
def _record(
    lanes: Any, c: Any, result: Any, lane: int, kind: int, events: tuple[Any, Any, Any]
) -> None:
    """Count an event and, where there is room, log it."""
    times, kinds, states = events
    job, total = lanes.job[lane], result.events
    result.events += 1
    result.kinds[kind] += 1
    if total < times.shape[1]:
        times[job, total], kinds[job, total] = lanes.clock[lane], kind
        for variable in range(N_STATE):
            states[job, total, variable] = c[variable, 0, lane]


@part
def _return_to_belt(lanes: Any, result: Any, lane: int, y: float, speed: float) -> None:
    """The speed of an impact; from the first one on, extremes of y are kept apart."""
    if result.kinds[switching.CONTACT] == 1:
        result.lowest_y, lanes.lowest_y[lane] = lanes.lowest_y[lane], y
        result.impact_speed = speed
    result.impact_speed = max(result.impact_speed, speed)


@part
def _mark(lanes: Any, c: Any, result: Any, order: Any, lane: int) -> None:
    """Keep the sums of a run at one of its marks."""
    mark = result.marks
    result.mark_separated_time[mark] = lanes.separated_time[lane]
    result.mark_stick_time[mark] = lanes.stick_time[lane]
    result.mark_growth[mark] = result.log_growth + math.log(norm_of(lanes, lane) / TANGENT_NORM)
    result.mark_half_turns[mark, 0] = lanes.half_turns1[lane]
    result.mark_half_turns[mark, 1] = lanes.half_turns2[lane]
    for variable in range(N_STATE):
        result.mark_state[mark, variable] = c[variable, 0, lane]
    for kind in range(result.kinds.size):
        result.mark_kinds[mark, kind] = result.kinds[kind]
    result.marks += 1
    last = result.marks == len(MARKS)
    lanes.next_mark[lane] = math.inf if last else MARKS[result.marks] * order.t_end


@inline
def _mark_runs(lanes: Any, c: Any, bits: int, jobs: Any) -> None:
    orders, results, _ = jobs
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        job = lanes.job[lane]
        _mark(lanes, c, results[job], orders[job], lane)


@inline
def _within_limits(at: int) -> Any:
    """Lanes that no limit stops."""
    turns = smaller(magnitude(load(at + AT.half_turns1)), magnitude(load(at + AT.half_turns2)))
    far = larger(load(at + AT.early_largest_x), load(at + AT.late_largest_x))
    return (
        bits_below(load(at + AT.steps), load(at + AT.max_steps))
        & ~bits_below(load(at + AT.stop_at_x), far)
        & bits_below(turns * 0.5, load(at + AT.stop_at_turns))
        & ~bits_below(load(at + AT.nearest_pivot2), load(at + AT.reach2))
    )


@part
def _limit(lanes: Any, lane: int) -> Any:
    """The limit that stops a lane, or RUNNING."""
    if lanes.nearest_pivot2[lane] < lanes.reach2[lane]:
        return CODES.singular_geometry
    far = max(lanes.early_largest_x[lane], lanes.late_largest_x[lane])
    turns = 0.5 * min(abs(lanes.half_turns1[lane]), abs(lanes.half_turns2[lane]))
    if far > lanes.stop_at_x[lane] or turns >= lanes.stop_at_turns[lane]:
        return CODES.amplitude_reached
    return CODES.step_limit if lanes.steps[lane] >= lanes.max_steps[lane] else RUNNING


@part
def _finish(lanes: Any, c: Any, result: Any, lane: int, outcome: int, tangent: int) -> None:
    """Write a job's results."""
    answered = outcome in (CODES.converged, CODES.separated, CODES.amplitude_reached)
    result.outcome = CODES.unresolved if answered and result.late_events > 0 else outcome
    result.time, result.steps = lanes.clock[lane], int(lanes.steps[lane])
    first_lowest = result.lowest_y
    for name in literal_unroll(OBSERVED):
        result[name] = lanes[name][lane]
    result.return_lowest_y = result.lowest_y if result.kinds[switching.CONTACT] else np.nan
    result.lowest_y = min(result.lowest_y, first_lowest)
    result.half_turns[0], result.half_turns[1] = lanes.half_turns1[lane], lanes.half_turns2[lane]
    for variable in range(N_STATE):
        result.final_state[variable] = c[variable, 0, lane]
    norm = norm_of(lanes, lane)
    if tangent and norm > 0.0:
        result.log_growth += math.log(norm / TANGENT_NORM)


@inline
def _refill(
    lanes: Any, c: Any, ended: int, busy: int, jobs: Any, samples: Any, queue: Any,
    tangent: int,
) -> Any:  # fmt: skip
    """Finish the lanes that have ended and give them new jobs; returns the busy ones."""
    orders, results, initial = jobs
    times, _, _ = samples
    while ended:
        lane = first_bit(ended)
        ended ^= 1 << lane
        if lanes.job[lane] >= 0:
            _finish(lanes, c, results[lanes.job[lane]], lane, lanes.outcome[lane], tangent)
        busy &= ~(1 << lane)
        lanes.job[lane] = IDLE
        if queue.next < queue.end:
            job = lanes.job[lane] = queue.next
            queue.next += queue.stride
            start_job(lanes, c, orders[job], results[job], initial[job], lane)
            lanes.next_sample[lane] = times[job, 0] if times.shape[1] else np.inf
            lanes.outcome[lane] = RUNNING
            busy |= 1 << lane
    return busy


@inline
def _cut_steps(lanes: Any, c: Any, bits: int) -> Any:
    """Where steps end at events or at the end of a run; returns lanes at an end."""
    ended = 0
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        lanes.outcome[lane] = end_of_step(lanes, c, lane)
        if lanes.outcome[lane] != RUNNING:
            ended |= 1 << lane
    return ended


@inline
def _sample(lanes: Any, c: Any, bits: int, results: Any, samples: Any) -> None:
    """States at the instants that are asked for."""
    times, states, regimes = samples
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        job = lanes.job[lane]
        sample(c, lanes, results[job].regime, lane, times[job], states[job], regimes[job])


@inline
def _change_regimes(lanes: Any, c: Any, bits: int, jobs: Any, events: Any) -> Any:
    """Regimes that end, limits that are reached; returns lanes that stop."""
    orders, results, _ = jobs
    ended = 0
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        order, result = orders[lanes.job[lane]], results[lanes.job[lane]]
        outcome = _limit(lanes, lane)
        if outcome != CODES.singular_geometry and _near_surface(lanes, order, lane, result.regime):
            switched = _switch(lanes, c, order, result, lane, events)
            outcome = outcome if switched == RUNNING else switched
        if outcome != RUNNING:
            lanes.outcome[lane] = outcome
            ended |= 1 << lane
    return ended


@inline
def _observe(lanes: Any, c: Any, at: int, base: int, terms: int) -> None:
    begin = (load(base), load(base + terms * ROW))
    speeds = (load(base + 2 * terms * ROW), load(base + 3 * terms * ROW))
    rates = (load(base + (2 * terms + 1) * ROW), load(base + (3 * terms + 1) * ROW))
    observe(c, lanes, at, begin, speeds, rates, load(base + (2 * terms + 2) * ROW))
    first, second = lanes.half_turns1, lanes.half_turns2
    observe_pivot(c, lanes, at, begin, speeds, first, AT.pivot_x1, AT.pivot_y1, AT.scale1)
    observe_pivot(c, lanes, at, begin, speeds, second, AT.pivot_x2, AT.pivot_y2, AT.scale2)


@inline
def _go_on(at: int, base: int, terms: int) -> None:
    """The end of each lane's step becomes the start of the next; its time is compensated."""
    for variable in range(N_STATE):
        store(base + variable * terms * ROW, load(at + AT_STATE[variable]))
    store(at + AT.steps, load(at + AT.steps) + 1.0)
    increment = load(at + AT.step) + load(at + AT.correction)
    clock = load(at + AT.clock)
    time = clock + increment
    store(at + AT.correction, (clock - time) + increment)
    store(at + AT.clock, time)


@inline
def _grow(lanes: Any, at: int, results: Any, busy: int) -> None:
    bits = watch_growth(at) & busy
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        grow(lanes, results[lanes.job[lane]], lane)


def _advance(table: Any) -> int:
    """Some rounds over all lanes; returns how many are busy. The table: ``records.TABLE``."""
    t = _numba.carray(table, (1,), TABLE)[0]
    at, base, terms, n_jobs, n_samples = t.lanes, t.series, t.n_terms, t.n_jobs, t.n_samples
    c = view(base, (N_STATE + N_EVENTS, terms, LANES), np.float64)
    lanes = view(at, (1,), LANE)[0]
    jobs = (
        view(t.orders, (n_jobs,), ORDER),
        view(t.results, (n_jobs,), RESULT),
        view(t.initial, (n_jobs, N_STATE), np.float64),
    )
    samples = (
        view(t.sample_times, (n_jobs, n_samples), np.float64),
        view(t.samples, (n_jobs, n_samples, N_STATE), np.float64),
        view(t.sample_regimes, (n_jobs, n_samples), np.int64),
    )
    events = (
        view(t.event_times, (n_jobs, t.n_logged), np.float64),
        view(t.event_kinds, (n_jobs, t.n_logged), np.int64),
        view(t.event_states, (n_jobs, t.n_logged, N_STATE), np.float64),
    )
    queue = view(t.queue, (1,), QUEUE)[0]
    parameters = at + FIRST_PARAMETER
    busy, ended = 0, 0
    for lane in range(LANES):
        busy |= (1 << lane) if lanes.job[lane] >= 0 else 0
        ended |= (1 << lane) if lanes.outcome[lane] != RUNNING else 0
    for _ in range(t.n_rounds):
        busy = _refill(lanes, c, ended, busy, jobs, samples, queue, t.tangent)
        if not busy:
            return 0
        call(t.take_step, (base, parameters, t.inverses, terms))
        if t.tangent:
            call(t.longest, (base, parameters, at + AT.longest_step, terms))
        special = take_step(at, base, terms) & busy
        due = reaches(at, AT.next_sample) & busy if n_samples else 0
        ended = _cut_steps(lanes, c, special)
        _sample(lanes, c, due, jobs[1], samples)
        _observe(lanes, c, at, base, terms)
        if t.tangent:
            call(t.perturb, (base, parameters, at + AT.step, at + AT.dx, terms))
        _go_on(at, base, terms)
        bits = (special | ~_within_limits(at)) & busy & ~ended
        ended |= _change_regimes(lanes, c, bits, jobs, events)
        if t.tangent:
            _grow(lanes, at, jobs[1], busy)
        _mark_runs(lanes, c, ~bits_below(load(at + AT.clock), load(at + AT.next_mark)) & busy, jobs)
    return int(busy)


@cache
def lane_kernel() -> Any:
    """The compiled loop, built once a process."""
    return compile_advance(_advance, [Path(__file__), *closure(__file__)])
