"""The compiled loop of any hybrid system: a Taylor step of all lanes, then its events and its ends.

Compiled once for all systems: numbers of states, surfaces and regimes are data, and what a system
computes is called by address. After each step all lanes are looked at side by side; one in which
nothing ends, no surface may be crossed and no sample is due takes no path of its own.
"""

import math
from functools import cache
from typing import Any

import numpy as np

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.taylor import layout
from squealpipe.systems.taylor.checking import believe_or_halve, differing, end_stalled
from squealpipe.systems.taylor.lanes import (
    address_of,
    call,
    compile_advance,
    record_viewer,
    view,
)
from squealpipe.systems.taylor.memory import memory_at
from squealpipe.systems.taylor.observation import (
    clear_extremes,
    count_turns,
    entered_row,
    extremes_between,
    log_norm,
    observe,
    sample,
)
from squealpipe.systems.taylor.simd import (
    LANES,
    ROW,
    bits_below,
    first_bit,
    load,
    splat,
    store,
)
from squealpipe.systems.taylor.step import cut, reaches, take_step
from squealpipe.systems.taylor.switching import (
    put_into,
    settle,
    start_from_zero,
    switch_all,
    watch,
)

_record_at: Any = record_viewer(layout.LOOP_TABLE)


@part
def _grow(t: Any, m: Any, lane: int, tangent_row: int) -> None:
    """Note the horizon when it is passed, and scale a perturbation back."""
    job, size = m.integers[layout.integers.job, lane], log_norm(t, m, lane, tangent_row)
    if size == -math.inf:
        return
    growth = m.summary[job, 0] + size
    if math.isnan(m.summary[job, 1]) and growth > m.limits[job, 4]:
        m.summary[job, 1] = m.rows[layout.numbers.clock, lane]
    if not 1e-6 < math.exp(2.0 * size) < 1e6:
        for variable in range(t.n_states):
            m.rows[tangent_row + variable, lane] /= math.exp(size)
        m.summary[job, 0] = growth
    _limit_growth(m, lane)


@part
def _limit_growth(m: Any, lane: int) -> None:
    """The squared size of a perturbation at which the horizon is passed."""
    job = m.integers[layout.integers.job, lane]
    left = m.limits[job, 4] - m.summary[job, 0]
    waits = math.isnan(m.summary[job, 1]) and left < 300.0
    m.rows[layout.numbers.lost, lane] = math.exp(2.0 * left) if waits else math.inf


@inline
def _grow_all(t: Any, m: Any, tangent_row: int, busy: int) -> None:
    """Look at perturbations that have grown or shrunk a thousandfold, or passed what is lost."""
    square = splat(0.0)
    for variable in range(t.n_states):
        part = load(t.rows + (tangent_row + variable) * ROW) * load(
            t.units + variable * ROW
        )
        square = square + part * part
    usual = bits_below(splat(1e-6), square) & bits_below(square, splat(1e6))
    bits = (
        ~(usual & bits_below(square, load(t.rows + layout.numbers.lost * ROW))) & busy
    )
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        _grow(t, m, lane, tangent_row)


@part
def finish(
    t: Any, m: Any, c: Any, lane: int, tangent_row: int, first_extreme: int
) -> None:
    """Write a job's results."""
    rows, job = m.rows, m.integers[layout.integers.job, lane]
    m.ends[job, 0] = m.integers[layout.integers.outcome, lane]
    m.ends[job, 1] = int(rows[layout.numbers.steps, lane])
    m.ends[job, 2] = m.integers[layout.integers.events, lane]
    m.summary[job, 2] = rows[layout.numbers.clock, lane]
    for variable in range(t.n_states):
        m.final[job, variable] = c[variable, 0, lane]
    for index in range(t.n_tracked):
        for each in range(2):
            found = rows[first_extreme + 2 * index + each, lane]
            m.extremes[job, index, m.integers[layout.integers.late, lane], each] = found
    first_time = first_extreme + 2 * t.n_tracked
    for component in range(t.n_components):
        last = m.integers[layout.integers.first_regime + component, lane]
        since = rows[entered_row(t) + component, lane]
        rows[first_time + last, lane] += rows[layout.numbers.clock, lane] - since
    for regime in range(t.n_regimes):
        m.durations[job, regime] = rows[first_time + regime, lane]
    for point in range(t.n_points):
        m.half_turns[job, point] = rows[first_time + t.n_regimes + 3 * point + 2, lane]
    if t.tangent:
        m.summary[job, 0] += log_norm(t, m, lane, tangent_row)


@part
def start(
    t: Any, m: Any, c: Any, lane: int, job: int, tangent_row: int, first: int
) -> None:
    """Start a job in a lane."""
    rows, integers = m.rows, m.integers
    integers[:, lane] = 0
    integers[layout.integers.job, lane], integers[layout.integers.outcome, lane] = (
        job,
        layout.outcomes.running,
    )
    integers[layout.integers.hit, lane] = -1
    for row in (
        layout.numbers.clock,
        layout.numbers.correction,
        layout.numbers.steps,
        layout.numbers.step,
        layout.numbers.reach,
        layout.numbers.across,
        layout.numbers.delay,
    ):
        rows[row, lane] = 0.0
    rows[layout.numbers.longest, lane] = math.inf
    rows[layout.numbers.t_end, lane] = m.limits[job, 0]
    rows[layout.numbers.t_late, lane] = m.limits[job, 1]
    rows[layout.numbers.most_steps, lane] = m.limits[job, 2]
    rows[layout.numbers.origin, lane] = m.limits[job, 6]
    if m.limits[job, 1] <= 0.0:
        rows[layout.numbers.t_late, lane], integers[layout.integers.late, lane] = (
            math.inf,
            1,
        )
    times = m.sample_times[job]
    rows[layout.numbers.next_sample, lane] = times[0] if times.size else math.inf
    first_parameter = t.n_rows - t.n_constants - t.n_parameters
    for parameter in range(t.n_parameters):
        rows[first_parameter + parameter, lane] = m.parameters[job, parameter]
    c[: t.n_variables, :, lane] = 0.0
    for variable in range(t.n_states):
        c[variable, 0, lane] = m.initial[job, variable]
        m.units[variable, lane] = 1.0 / m.sizes[job, variable]
        rows[tangent_row + variable, lane] = m.sizes[job, variable] / math.sqrt(
            t.n_states
        )
    if t.n_variables > t.n_states:
        c[t.n_states, 0, lane] = rows[layout.numbers.origin, lane]
    for index in range(t.n_tracked):
        clear_extremes(m, lane, index, first)
        if t.n_between:
            m.between[index, 0, lane], m.between[index, 1, lane] = math.inf, -math.inf
    row = first + 2 * t.n_tracked
    rows[row : row + t.n_regimes, lane] = 0.0
    for point in range(t.n_points):
        row = first + 2 * t.n_tracked + t.n_regimes + 3 * point
        rows[row, lane] = m.points[job, point, 0]
        rows[row + 1, lane] = m.points[job, point, 1]
        rows[row + 2, lane] = 0.0
    m.summary[job, 0], m.summary[job, 1] = 0.0, math.nan
    _limit_growth(m, lane)
    for component in range(t.n_components):
        rows[entered_row(t) + component, lane] = 0.0
        put_into(t, m, lane, component, m.first_regime[job, component])
    settle(t, lane)
    m.ticked[:, lane] = -math.inf
    watch(t, m, c, lane, 0.0)


@inline
def _go_on(t: Any) -> None:
    """The end of each lane's step becomes the start of the next; its time is compensated."""
    at = t.rows
    for variable in range(t.n_variables):
        store(
            t.series + variable * t.n_terms * ROW,
            load(at + (layout.numbers.first_of_system + variable) * ROW),
        )
    store(at + layout.numbers.steps * ROW, load(at + layout.numbers.steps * ROW) + 1.0)
    increment = load(at + layout.numbers.step * ROW) + load(
        at + layout.numbers.correction * ROW
    )
    clock = load(at + layout.numbers.clock * ROW)
    time = clock + increment
    store(at + layout.numbers.correction * ROW, (clock - time) + increment)
    store(at + layout.numbers.clock * ROW, time)


@inline
def _cut_all(t: Any, m: Any, c: Any, special: int) -> None:
    """End the steps of some lanes where something happens in them."""
    while special:
        lane = first_bit(special)
        special ^= 1 << lane
        cut(t, m, c, lane)


@inline
def _check(t: Any, m: Any, c: Any, parameters: int, busy: int) -> int:
    """Halve steps until their ends can be believed; returns lanes that were halved or ended."""
    store(t.rows + layout.numbers.gap * ROW, splat(math.inf))
    wrong, halved = busy, 0
    while True:
        wrong &= differing(t, m, parameters)
        if not wrong:
            return halved
        bits = wrong
        while bits:
            lane = first_bit(bits)
            bits ^= 1 << lane
            stands = believe_or_halve(t, m, c, lane)
            if stands:
                wrong ^= 1 << lane
            if (
                not stands
                or m.integers[layout.integers.outcome, lane] != layout.outcomes.running
            ):
                halved |= 1 << lane


@inline
def _refill(
    t: Any, m: Any, c: Any, busy: int, ended: int, tangent_row: int, first_extreme: int
) -> int:
    """Finish the lanes that have ended and give them new jobs; returns the busy ones."""
    while ended:
        lane = first_bit(ended)
        ended ^= 1 << lane
        if m.integers[layout.integers.job, lane] >= 0:
            finish(t, m, c, lane, tangent_row, first_extreme)
        busy &= ~(1 << lane)
        m.integers[layout.integers.job, lane] = -1
        if m.queue[0] < m.queue[1]:
            job = m.queue[0]
            m.queue[0] += m.queue[2]
            start(t, m, c, lane, job, tangent_row, first_extreme)
            busy |= 1 << lane
    return busy


@inline
def _ended(t: Any, m: Any, special: int, busy: int) -> int:
    """Lanes whose run has ended, among those that ended their step and those out of steps."""
    spent = ~bits_below(
        load(t.rows + layout.numbers.steps * ROW),
        load(t.rows + layout.numbers.most_steps * ROW),
    )
    bits, ended = (special | spent) & busy, 0
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        if m.integers[
            layout.integers.outcome, lane
        ] == layout.outcomes.running and spent & (1 << lane):
            m.integers[layout.integers.outcome, lane] = layout.outcomes.step_limit
        if m.integers[layout.integers.outcome, lane] != layout.outcomes.running:
            ended |= 1 << lane
    return ended


@inline
def _gather_extremes(t: Any, m: Any, c: Any, busy: int) -> None:
    """Gather the extremes between the asked instants over one step of all lanes, if asked for."""
    while t.n_between and busy:
        lane = first_bit(busy)
        busy ^= 1 << lane
        extremes_between(t, m, c, lane)


@inline
def _rounds(t: Any, m: Any, c: Any) -> int:
    """Steps of all lanes until none is busy, or there were enough."""
    tangent_row = layout.numbers.first_of_system + t.n_variables
    first_extreme = tangent_row + t.n_states
    first_time = first_extreme + 2 * t.n_tracked
    first_parameter = t.n_rows - t.n_constants - t.n_parameters
    parameters = t.rows + first_parameter * ROW
    time_unit = first_parameter + t.n_parameters - 1
    busy, ended = 0, 0
    for lane in range(LANES):
        busy |= (1 << lane) if m.integers[layout.integers.job, lane] >= 0 else 0
        ended |= (
            (1 << lane)
            if m.integers[layout.integers.outcome, lane] != layout.outcomes.running
            else 0
        )
    for _ in range(t.n_rounds):
        busy = _refill(t, m, c, busy, ended, tangent_row, first_extreme)
        if not busy:
            return 0
        call(t.take_step, (t.series, parameters, t.inverses, t.n_terms))
        if t.tangent:
            call(
                t.longest,
                (
                    t.series,
                    parameters,
                    t.rows + layout.numbers.longest * ROW,
                    t.n_terms,
                ),
            )
        start_from_zero(t, m, c)
        special = take_step(t, m, c, parameters) & busy
        due = reaches(t.rows, layout.numbers.next_sample) & busy if t.n_samples else 0
        _cut_all(t, m, c, special)
        if t.verify:
            special |= _check(t, m, c, parameters, busy)
        special |= end_stalled(t, m, c, busy)
        # before the samples, which count on to the next one that is due
        _gather_extremes(t, m, c, busy)
        while due:
            lane = first_bit(due)
            due ^= 1 << lane
            sample(t, m, c, lane, first_time)
        observe(t, m, c, first_extreme, busy)
        turned = count_turns(t, m, first_time + t.n_regimes, busy)
        if t.tangent:
            step, at = t.rows + layout.numbers.step * ROW, t.rows + tangent_row * ROW
            call(t.perturb, (t.series, parameters, step, at, t.n_terms))
        _go_on(t)
        if t.n_variables > t.n_states:
            clock = load(t.rows + layout.numbers.clock * ROW) + load(
                t.rows + layout.numbers.correction * ROW
            )
            now = clock * load(t.rows + time_unit * ROW)
            now = now + load(t.rows + layout.numbers.origin * ROW)
            store(t.series + t.n_states * t.n_terms * ROW, now)
        switch_all(t, m, c, special, tangent_row)
        if t.tangent:
            _grow_all(t, m, tangent_row, busy)
        ended = _ended(t, m, special | turned, busy)
    return int(busy)


def _advance(table: Any) -> int:
    """Some rounds over all lanes; returns how many are busy. The table: ``layout.LOOP_TABLE``."""
    t = _record_at(address_of(table))
    m = memory_at(address_of(table))
    # with any strides, as that of structures: both loops share what is compiled for it
    c = view(t.series, (t.n_series, t.n_terms, LANES), np.float64)[:, :, ::1]
    return int(_rounds(t, m, c))


@cache
def loop() -> Any:
    """The compiled loop, built once a process.

    It computes with lanes side by side already; what LLVM would vectorize beside them is short.
    """
    return compile_advance(_advance, vectorize=False)
