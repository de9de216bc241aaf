"""What a switch does: reset, regime entered, count and log, and a perturbation across it."""

import math
from typing import Any

from squealpipe.methods.compiled import inline, part
from squealpipe.methods.taylor import layout
from squealpipe.methods.taylor.lanes import call
from squealpipe.methods.taylor.observation import begin_late
from squealpipe.methods.taylor.simd import ROW, first_bit

SLACK = 1e-13
"""A surface lies within this of zero where round-off hides its sign, over the terms that cancel."""
NOISE = 1e-15
"""Round-off of a surface's polynomial and of its rate, likewise."""
CHAIN = 64
"""Switches without progress in time that end a run."""


@part
def gauge(t: Any, m: Any, lane: int, regime: int) -> None:
    """Surfaces and outputs, and the size of their terms, of the state in the scratch."""
    first = t.n_rows - t.n_constants - t.n_parameters
    parameters = t.rows + first * ROW + 8 * lane
    constants = t.regimes + 8 * regime * t.n_constants
    stride = m.scratch.shape[1] * 8
    call(
        t.gauge,
        (t.scratch, t.scratch + stride, parameters, constants, t.scratch + 2 * stride),
    )


@part
def enter_regime(t: Any, m: Any, c: Any, lane: int, regime: int, span: float) -> None:
    """Put a lane into a regime: its constants, which surfaces it watches, which start from zero."""
    m.integers[layout.REGIME, lane] = regime
    bit, keep = 1 << lane, ~(1 << lane)
    first = t.n_rows - t.n_constants
    for constant in range(t.n_constants):
        m.rows[first + constant, lane] = m.regimes[regime, constant]
    z, sizes, out = m.scratch[0], m.scratch[1], m.scratch[2]
    for variable in range(t.n_variables):
        z[variable] = c[variable, 0, lane]
        sizes[variable] = abs(z[variable]) + abs(c[variable, 1, lane]) * span
    gauge(t, m, lane, regime)
    # where an event was located to the tolerance only, the rate that follows from it is no better
    located = max(
        NOISE, layout.LOST_ERROR * math.exp(-m.limits[m.integers[layout.JOB, lane], 4])
    )
    for surface in range(t.n_surfaces):
        m.noise[surface, 0, lane] = NOISE * out[3 * surface + 1]
        m.noise[surface, 1, lane] = located * out[3 * surface + 2]
    # a state is known to round-off of its typical size, however small it has become
    for variable in range(t.n_states):
        sizes[variable] = max(sizes[variable], m.sizes[variable])
    gauge(t, m, lane, regime)
    for surface in range(t.n_surfaces):
        m.active[surface] &= keep
        m.fresh[surface] &= keep
        m.passed[surface] &= keep
        m.beyond[surface] &= keep
        falls, rises = m.falls[regime, surface], m.rises[regime, surface]
        if falls < 0 and rises < 0:
            continue
        m.active[surface] |= bit
        height, slack = out[3 * surface], SLACK * out[3 * surface + 1]
        which = falls if height < 0.0 else rises
        if abs(height) <= slack:
            m.fresh[surface] |= bit
        elif which >= t.n_switches or (which >= 0 and m.marks[regime, which] < 2):
            m.beyond[surface] |= bit


@inline
def entered_beyond(t: Any, m: Any) -> int:
    """Lanes whose regime was entered beyond one of its surfaces."""
    lanes = 0
    for surface in range(t.n_surfaces):
        lanes |= m.beyond[surface]
    return lanes


@part
def _log(t: Any, m: Any, lane: int, kind: int, regime: int) -> int:
    """Count an event and, where there is room, log it; returns how many there were."""
    integers, job, after = m.integers, m.integers[layout.JOB, lane], m.scratch[3]
    count = integers[layout.EVENTS, lane]
    if count < t.n_logged:
        m.event_times[job, count] = (
            m.rows[layout.CLOCK, lane] + m.rows[layout.CORRECTION, lane]
        )
        m.event_kinds[job, count], m.event_regimes[job, count] = kind, regime
        for variable in range(t.n_states):
            m.event_states[job, count, variable] = after[variable]
    integers[layout.EVENTS, lane] = count + 1
    m.counts[job, kind] += 1
    before, peaks = m.scratch[0], m.peaks[job, kind]
    for variable in range(t.n_states):
        peaks[variable] = max(peaks[variable], abs(before[variable]))
    if math.isnan(m.firsts[job, kind]):
        m.firsts[job, kind] = m.rows[layout.CLOCK, lane]
        if kind == t.late_from:
            begin_late(t, m, lane, layout.FIXED_ROWS + t.n_variables + t.n_states)
    return int(count + 1)


@part
def _is_beyond(t: Any, m: Any, lane: int) -> bool:
    """Whether a lane's regime was entered beyond a surface."""
    return bool(entered_beyond(t, m) & (1 << lane))


@part
def _pass_mark(t: Any, m: Any, lane: int, before: int, which: int) -> None:
    """A surface that changed nothing is passed: only its next crossing counts."""
    regime, bit = m.integers[layout.REGIME, lane], 1 << lane
    stays = regime == before and m.marks[before, which] > 0
    if not (stays or m.marks[regime, which] > 1):
        return
    for surface in range(t.n_surfaces):
        if which in (m.falls[regime, surface], m.rises[regime, surface]):
            m.fresh[surface] |= bit
            m.passed[surface] |= bit
            m.beyond[surface] &= ~bit


@part
def _carry_over(
    t: Any, m: Any, lane: int, tangent_row: int, regime: int, parameters: int
) -> None:
    """A perturbation across the switch whose states before and after are in the scratch."""
    d, out, stride = m.scratch[4], m.scratch[2], m.scratch.shape[1] * 8
    for variable in range(t.n_states):
        d[variable] = m.rows[tangent_row + variable, lane]
    before = t.regimes + 8 * m.integers[layout.REGIME, lane] * t.n_constants
    after = t.regimes + 8 * regime * t.n_constants
    z, y = t.scratch, t.scratch + 3 * stride
    at, which = t.scratch + 4 * stride, m.integers[layout.HIT, lane]
    at_once = 1 if _is_beyond(t, m, lane) else 0
    out_at = t.scratch + 2 * stride
    call(t.jump, (which, at_once, z, y, parameters, before, after, at, out_at))
    for variable in range(t.n_states):
        m.rows[tangent_row + variable, lane] = out[variable]


@part
def _switch(t: Any, m: Any, c: Any, lane: int, tangent_row: int) -> None:
    """Carry out the switch that ended a lane's step."""
    rows, integers, job = m.rows, m.integers, m.integers[layout.JOB, lane]
    which, before = integers[layout.HIT, lane], integers[layout.REGIME, lane]
    if which >= t.n_switches:
        integers[layout.OUTCOME, lane] = layout.STOPPED + which - t.n_switches
        return
    span, clock = rows[layout.STEP, lane], rows[layout.CLOCK, lane]
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
    integers[layout.CHAINED, lane] += 1
    if span > 4.0 * 2.0**-52 * abs(clock):
        integers[layout.CHAINED, lane] = 0
    count = _log(t, m, lane, kind, regime)
    first_time = layout.FIXED_ROWS + t.n_variables + t.n_states + 2 * t.n_tracked
    rows[first_time + before, lane] += clock - rows[layout.ENTERED, lane]
    rows[layout.ENTERED, lane] = clock
    enter_regime(t, m, c, lane, regime, span)
    _pass_mark(t, m, lane, before, which)
    if kind == t.until:
        integers[layout.OUTCOME, lane] = layout.BY_EVENT
    elif integers[layout.CHAINED, lane] >= CHAIN:
        integers[layout.OUTCOME, lane] = layout.ACCUMULATION
    elif count >= m.limits[job, 3]:
        integers[layout.OUTCOME, lane] = layout.EVENT_LIMIT


@inline
def start_from_zero(t: Any, m: Any, c: Any) -> None:
    """Surfaces whose sign round-off hides start from exactly zero."""
    for surface in range(t.n_surfaces):
        bits = m.fresh[surface]
        while bits:
            lane = first_bit(bits)
            bits ^= 1 << lane
            c[t.n_variables + surface, 0, lane] = 0.0


@inline
def switch_all(t: Any, m: Any, c: Any, special: int, tangent_row: int) -> None:
    """Carry out what ended the steps of some lanes."""
    for surface in range(t.n_surfaces):
        m.fresh[surface] = 0
        m.passed[surface] = 0
    while special:
        lane = first_bit(special)
        special ^= 1 << lane
        hit = m.integers[layout.HIT, lane]
        if hit == layout.LATE_BEGINS:
            begin_late(t, m, lane, tangent_row + t.n_states)
            # a surface may be crossed at this very instant
            enter_regime(
                t,
                m,
                c,
                lane,
                m.integers[layout.REGIME, lane],
                m.rows[layout.STEP, lane],
            )
        elif hit >= 0 and m.integers[layout.OUTCOME, lane] == layout.RUNNING:
            _switch(t, m, c, lane, tangent_row)
        m.integers[layout.HIT, lane] = -1
