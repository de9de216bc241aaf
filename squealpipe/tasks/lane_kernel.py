"""What happens to a lane after each Taylor step: events, observation, refilling; compiled.

All quantities are in units of m = k1 = l_pre = 1. The functions see one step through its Taylor
coefficients, so extrema and samples inside it cost no further integration.
"""

from __future__ import annotations

import math
from enum import IntEnum, auto
from functools import cache
from typing import Any, NamedTuple

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


class Column(IntEnum):
    """Floating-point results of a job."""

    time = 0
    first_separation = auto()
    separated_time = auto()
    stick_time = auto()
    lowest_y = auto()
    largest_r2 = auto()
    largest_x = auto()
    late_largest_x = auto()
    largest_speed = auto()
    nearest_pivot2 = auto()
    half_turns = auto()
    log_growth = auto()
    horizon = auto()
    x = auto()
    y = auto()
    vx = auto()
    vy = auto()


class Count(IntEnum):
    """Integer results of a job."""

    outcome = 0
    regime = auto()
    steps = auto()
    late_events = auto()
    events = auto()
    separation = auto()
    contact = auto()
    stick = auto()
    slip = auto()
    reversal = auto()


class Order(IntEnum):
    """What a job asks for, after its physical parameters."""

    t_end = 10
    t_late = auto()
    stop_at_x = auto()
    stop_at_separation = auto()
    max_steps = auto()
    max_events = auto()
    separates = auto()
    reverses = auto()
    sticks = auto()
    linear_springs = auto()


N_COLUMNS, N_COUNTS, N_ORDERS = len(Column), len(Count), 10 + len(Order)
TANGENT_NORM = 1e-4
"""Norm that a tangent vector is scaled back to: small, so that it does not set the step size."""
HORIZON_GROWTH = 1e-3 / 2.0**-52
"""Growth that turns round-off into an error of a thousandth of l_pre."""
PIVOT_REACH = 1e-7
"""Distance from a pivot, in free lengths, below which the force's direction is lost."""

for law in (
    springs.fixed_ends,
    springs.squared_distance,
    springs.spring_force,
    springs.elastic_force,
    springs.linear_stiffness,
    springs.linear_elastic_force,
    contact.contact_force,
    switching.spring_forces,
    switching.friction_slack,
    switching.speed_nudge,
    switching.contact_regime,
    switching.start,
    switching.switch,
    switching._release,
    switching._reach_belt_speed,
):
    register_jitable(law)


class Views(NamedTuple):
    """The arrays of one driver: the integrator's memory, lanes, jobs and results."""

    state: Any
    pars: Any
    coefficients: Any
    last_step: Any
    lane: Any
    job_of: Any
    orders: Any
    initial: Any
    results: Any
    counts: Any
    sample_times: Any
    samples: Any
    sample_regimes: Any
    event_times: Any
    event_kinds: Any
    event_states: Any
    queue: Any


class LaneField(IntEnum):
    """Floating-point memory of a lane: its compensated time."""

    time = 0
    correction = 1


_SEPARATED = int(switching.SEPARATED)
_STICK = int(switching.STICK)
_OUTCOMES = {name: int(Outcome[name]) for name in Outcome.__members__}
_CONVERGED = _OUTCOMES["converged"]
_SEPARATION_FOUND = _OUTCOMES["separated"]
_STEP_LIMIT = _OUTCOMES["step_limit"]
_EVENT_LIMIT = _OUTCOMES["event_limit"]
_SINGULAR = _OUTCOMES["singular_geometry"]
_NOT_FINITE = _OUTCOMES["not_finite"]
_REACHED = _OUTCOMES["amplitude_reached"]
_UNRESOLVED = _OUTCOMES["unresolved"]
_RUNNING = -1


@numba.njit
def _parameters(views: Any, job: int) -> Any:
    o = views.orders
    p = ScaledParameters(
        1.0, 1.0, o[job, 0], o[job, 1], o[job, 2], o[job, 3], 1.0, o[job, 4], o[job, 5]
    )
    g = springs.Geometry(o[job, 6], o[job, 7], o[job, 8], o[job, 9])
    rules = Rules(
        o[job, Order.separates] > 0.0,
        o[job, Order.reverses] > 0.0,
        o[job, Order.sticks] > 0.0,
        o[job, Order.linear_springs] > 0.0,
    )
    return p, g, rules


@numba.njit
def _set_regime(views: Any, lane: int, job: int, regime: int) -> None:
    """Write a regime into the lane's parameters (see ``tasks.a1_system.REGIME``)."""
    pars, orders = views.pars, views.orders
    speed = orders[job, 3]
    slipping = regime not in (_SEPARATED, _STICK)
    pars[10, lane] = 0.0 if regime == _SEPARATED else 1.0
    pars[11, lane] = 0.0 if not slipping else (1.0 if regime == 0 else -1.0)
    pars[12, lane] = 1.0 if regime == _STICK else 0.0
    pars[13, lane] = orders[job, Order.reverses] if slipping else 0.0
    pars[14, lane] = orders[job, Order.separates]
    pars[15, lane] = 1.0 / (1.0 + abs(speed))
    views.counts[job, Count.regime] = regime


@numba.njit
def _load(views: Any, lane: int, job: int) -> None:
    """Start a job in a lane."""
    views.job_of[lane, 0] = job
    views.job_of[lane, 1] = 0
    views.lane[lane, LaneField.time] = 0.0
    views.lane[lane, LaneField.correction] = 0.0
    p, g, rules = _parameters(views, job)
    x, y, vx, vy = (
        views.initial[job, 0],
        views.initial[job, 1],
        views.initial[job, 2],
        views.initial[job, 3],
    )
    regime, y, vx = switching.start(x, y, vx, vy, p, g, rules)
    for index in range(10):
        views.pars[index, lane] = views.orders[job, index]
    _set_regime(views, lane, job, regime)
    state = views.state
    state[0, lane], state[1, lane], state[2, lane], state[3, lane] = x, y, vx, vy
    for index in range(4, state.shape[0]):
        state[index, lane] = 0.5 * TANGENT_NORM
    results, counts = views.results, views.counts
    results[job, :] = 0.0
    results[job, Column.first_separation] = 0.0 if regime == _SEPARATED else np.nan
    results[job, Column.horizon] = np.nan
    results[job, Column.lowest_y] = np.inf if regime == _SEPARATED else y
    results[job, Column.largest_r2] = x * x + y * y
    results[job, Column.largest_x] = abs(x)
    results[job, Column.largest_speed] = vx
    results[job, Column.nearest_pivot2] = np.inf
    counts[job, Count.outcome] = _RUNNING
    counts[job, Count.steps] = 0
    for index in range(Count.late_events, N_COUNTS):
        counts[job, index] = 0


@numba.njit
def _next_job(views: Any, lane: int) -> None:
    """Refill a lane, or give it a harmless state when nothing is left."""
    queue = views.queue
    if queue[0] < queue[1]:
        _load(views, lane, queue[0])
        queue[0] += queue[2]
    else:
        views.job_of[lane, 0] = -1
        _idle(views, lane)


@numba.njit
def _idle(views: Any, lane: int) -> None:
    """The state of rest in contact, again after each step: a finite step without events."""
    for variable in range(views.state.shape[0]):
        views.state[variable, lane] = 0.0
    views.pars[10, lane], views.pars[12, lane] = 1.0, 0.0
    views.pars[13, lane], views.pars[14, lane] = 0.0, 0.0


@numba.njit
def _observe(views: Any, lane: int, job: int, regime: int, step: float, time: float) -> None:
    """Times in each regime and the extrema over one step."""
    c, results, orders = views.coefficients, views.results, views.orders
    x0, y0, vx0, vy0 = c[0, 0, lane], c[1, 0, lane], c[2, 0, lane], c[3, 0, lane]
    x1, y1 = evaluate(c, 0, lane, step), evaluate(c, 1, lane, step)
    vx1, vy1 = evaluate(c, 2, lane, step), evaluate(c, 3, lane, step)
    if regime == _SEPARATED:
        results[job, Column.separated_time] += step
    else:
        if regime == _STICK:
            results[job, Column.stick_time] += step
        low = min(y0, y1)
        if vy0 < 0.0 < vy1 and low + 0.5 * step * min(vy0, -vy1) < results[job, Column.lowest_y]:
            low = min(low, evaluate(c, 1, lane, root_of(c, 3, lane, step, vy0, vy1)))
        results[job, Column.lowest_y] = min(results[job, Column.lowest_y], low)
    large = max(abs(x0), abs(x1))
    if vx0 * vx1 < 0.0 and large + 0.5 * step * max(abs(vx0), abs(vx1)) > min(
        results[job, Column.largest_x], results[job, Column.late_largest_x]
    ):
        large = max(large, abs(evaluate(c, 0, lane, root_of(c, 2, lane, step, vx0, vx1))))
    results[job, Column.largest_x] = max(results[job, Column.largest_x], large)
    if time >= orders[job, Order.t_late]:
        results[job, Column.late_largest_x] = max(results[job, Column.late_largest_x], large)
    results[job, Column.largest_speed] = max(results[job, Column.largest_speed], vx1)
    _largest_distance(views, lane, job, step, x0 * vx0 + y0 * vy0, x1 * vx1 + y1 * vy1)
    middle = 0.5 * (orders[job, 4] * orders[job, 6] - orders[job, 5] * orders[job, 8])
    if (x0 < middle) != (x1 < middle):
        height = 0.5 * (orders[job, 4] * orders[job, 7] + orders[job, 5] * orders[job, 9])
        turn = 1.0 if (y1 > height) == (x1 < middle) else -1.0
        results[job, Column.half_turns] += turn


@numba.njit
def _largest_distance(
    views: Any, lane: int, job: int, step: float, first: float, last: float
) -> None:
    """Largest x² + y², refined where the radial velocity changes its sign."""
    c, results = views.coefficients, views.results
    x, y = evaluate(c, 0, lane, step), evaluate(c, 1, lane, step)
    largest = x * x + y * y
    if first > 0.0 > last and largest - step * last > results[job, Column.largest_r2]:
        low, high = 0.0, step
        for _ in range(4):
            middle = low - first * (high - low) / (last - first)
            x, y = evaluate(c, 0, lane, middle), evaluate(c, 1, lane, middle)
            radial = x * evaluate(c, 2, lane, middle) + y * evaluate(c, 3, lane, middle)
            largest = max(largest, x * x + y * y)
            if radial > 0.0:
                low, first, last = middle, radial, 0.5 * last
            else:
                high, last, first = middle, radial, 0.5 * first
    results[job, Column.largest_r2] = max(results[job, Column.largest_r2], largest)


@numba.njit
def _sample(views: Any, lane: int, job: int, regime: int, step: float) -> None:
    """States at the asked instants that fall into this step."""
    times, c = views.sample_times, views.coefficients
    next_sample = views.job_of[lane, 1]
    start, correction = views.lane[lane, LaneField.time], views.lane[lane, LaneField.correction]
    while next_sample < times.shape[1]:
        offset = (times[job, next_sample] - start) - correction
        if offset > step:
            break
        for variable in range(4):
            views.samples[job, next_sample, variable] = evaluate(c, variable, lane, offset)
        views.sample_regimes[job, next_sample] = regime
        next_sample += 1
    views.job_of[lane, 1] = next_sample


@numba.njit
def _grow(views: Any, lane: int, job: int, time: float, saltation: float) -> None:
    """Growth of the tangent vector, with the jump of the field at belt speed."""
    state, results = views.state, views.results
    state[6, lane] *= saltation
    square = 0.0
    for index in range(4, 8):
        square += state[index, lane] * state[index, lane]
    norm = math.sqrt(square)
    if norm == 0.0:
        return
    growth = results[job, Column.log_growth] + math.log(norm / TANGENT_NORM)
    if math.isnan(results[job, Column.horizon]) and growth > math.log(HORIZON_GROWTH):
        results[job, Column.horizon] = time
    if not 1e-3 < norm / TANGENT_NORM < 1e2:
        for index in range(4, 8):
            state[index, lane] *= TANGENT_NORM / norm
        results[job, Column.log_growth] = growth


@numba.njit
def _pivot_is_near(views: Any, lane: int, job: int) -> bool:
    orders, state = views.orders, views.state
    x, y = state[0, lane], state[1, lane]
    x1, y1 = orders[job, 4] * orders[job, 6], orders[job, 4] * orders[job, 7]
    x2, y2 = -orders[job, 5] * orders[job, 8], orders[job, 5] * orders[job, 9]
    d1 = ((x - x1) ** 2 + (y - y1) ** 2) / orders[job, 4] ** 2
    d2 = ((x - x2) ** 2 + (y - y2) ** 2) / orders[job, 5] ** 2
    nearest = min(d1, d2)
    results = views.results
    results[job, Column.nearest_pivot2] = min(results[job, Column.nearest_pivot2], nearest)
    return orders[job, Order.linear_springs] == 0.0 and nearest < PIVOT_REACH * PIVOT_REACH


@numba.njit
def _finish(views: Any, lane: int, job: int, outcome: int, time: float) -> None:
    """Write a job's last values; the lane is refilled next."""
    counts, results = views.counts, views.results
    counts[job, Count.outcome] = outcome
    results[job, Column.time] = time
    for variable in range(4):
        results[job, Column.x + variable] = views.state[variable, lane]
    if views.state.shape[0] > 4:
        square = 0.0
        for index in range(4, 8):
            square += views.state[index, lane] ** 2
        if square > 0.0:
            results[job, Column.log_growth] += math.log(math.sqrt(square) / TANGENT_NORM)
    _next_job(views, lane)


@numba.njit
def _after_step(views: Any, lane: int, job: int) -> None:
    """Handle one lane after a Taylor step."""
    counts, results, orders, state = views.counts, views.results, views.orders, views.state
    regime, step = counts[job, Count.regime], views.last_step[lane]
    start, correction = views.lane[lane, LaneField.time], views.lane[lane, LaneField.correction]
    finite = math.isfinite(step)
    for variable in range(state.shape[0]):
        finite = finite and math.isfinite(state[variable, lane])
    if not finite:
        near = results[job, Column.nearest_pivot2] < 1e-6
        for variable in range(4):
            state[variable, lane] = views.coefficients[variable, 0, lane]
        _finish(views, lane, job, _SINGULAR if near else _NOT_FINITE, start)
        return
    counts[job, Count.steps] += 1
    remaining = (orders[job, Order.t_end] - start) - correction
    # t_end never shortens a step: the state there is read off the Taylor polynomial.
    used = min(step, remaining)
    if used > 0.0:
        _observe(views, lane, job, regime, used, start)
    _sample(views, lane, job, regime, used)
    if remaining <= step:
        for variable in range(4):
            state[variable, lane] = evaluate(views.coefficients, variable, lane, used)
        late = counts[job, Count.late_events] > 0
        _finish(
            views, lane, job, _UNRESOLVED if late else _CONVERGED, orders[job, Order.t_end]
        )
        return
    time = start + (step + correction)
    views.lane[lane, LaneField.correction] = (start - time) + (step + correction)
    views.lane[lane, LaneField.time] = time
    if _pivot_is_near(views, lane, job):
        _finish(views, lane, job, _SINGULAR, time)
        return
    saltation = 1.0
    p, g, rules = _parameters(views, job)
    change = switching.switch(
        state[0, lane], state[1, lane], state[2, lane], state[3, lane], regime, step, p, g, rules
    )
    state[1, lane], state[2, lane] = change.y, change.vx
    if change.kind == switching.CHATTER:
        _finish(views, lane, job, _EVENT_LIMIT, time)
        return
    if change.kind >= 0:
        saltation = change.saltation
        _record(views, lane, job, change.kind, time)
        counts[job, Count.late_events] += change.late
        _set_regime(views, lane, job, change.regime)
        if change.kind == switching.SEPARATION:
            if math.isnan(results[job, Column.first_separation]):
                results[job, Column.first_separation] = time
            if orders[job, Order.stop_at_separation] > 0.0:
                _finish(views, lane, job, _SEPARATION_FOUND, time)
                return
    if state.shape[0] > 4:
        _grow(views, lane, job, time, saltation)
    if results[job, Column.largest_x] > orders[job, Order.stop_at_x]:
        _finish(views, lane, job, _REACHED, time)
    elif counts[job, Count.events] >= orders[job, Order.max_events]:
        _finish(views, lane, job, _EVENT_LIMIT, time)
    elif counts[job, Count.steps] >= orders[job, Order.max_steps]:
        _finish(views, lane, job, _STEP_LIMIT, time)


@numba.njit
def _record(views: Any, lane: int, job: int, kind: int, time: float) -> None:
    """Count an event and, where there is room, log it."""
    counts = views.counts
    total = counts[job, Count.events]
    counts[job, Count.events] += 1
    counts[job, Count.separation + kind] += 1
    if total < views.event_times.shape[1]:
        views.event_times[job, total] = time
        views.event_kinds[job, total] = kind
        for variable in range(4):
            views.event_states[job, total, variable] = views.state[variable, lane]


@numba.njit
def _views(table: Any) -> Views:
    """Arrays from the addresses and sizes of a workspace (see ``tasks.ensemble``)."""
    dim, pars, terms, jobs, samples, events = (
        table[17],
        table[18],
        table[19],
        table[20],
        table[21],
        table[22],
    )
    return Views(
        float_view(table[0], (dim, LANES)),
        float_view(table[1], (pars, LANES)),
        float_view(table[2], (dim, terms, LANES)),
        float_view(table[3], (LANES,)),
        float_view(table[4], (LANES, 2)),
        integer_view(table[5], (LANES, 2)),
        float_view(table[6], (jobs, N_ORDERS)),
        float_view(table[7], (jobs, 4)),
        float_view(table[8], (jobs, N_COLUMNS)),
        integer_view(table[9], (jobs, N_COUNTS)),
        float_view(table[10], (jobs, samples)),
        float_view(table[11], (jobs, samples, 4)),
        integer_view(table[12], (jobs, samples)),
        float_view(table[13], (jobs, events)),
        integer_view(table[14], (jobs, events)),
        float_view(table[15], (jobs, events, 4)),
        integer_view(table[16], (3,)),
    )


def _advance(table: Any) -> int:
    """One round over all lanes; returns how many are still busy."""
    views = _views(table)
    busy = 0
    for lane in range(LANES):
        job = views.job_of[lane, 0]
        if job >= 0:
            _after_step(views, lane, job)
        elif job == -1:
            _idle(views, lane)
        else:
            _next_job(views, lane)
        busy += views.job_of[lane, 0] >= 0
    return busy


@cache
def lane_kernel() -> Any:
    """The compiled round, built once a process."""
    return compile_advance(_advance)
