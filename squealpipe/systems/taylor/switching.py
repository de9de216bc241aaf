"""Carry out a switch: reset, regime entered, count and log, and a perturbation across it.

Idea: after an event the state is reset, one component changes its regime, and the constants of its
regime are loaded; then each surface that the new regime watches gets the sign that it starts from.
What was just crossed starts from exactly zero, whatever round-off has left at its root, or it would
fire again. A perturbation is carried over by the saltation matrix. Invariant: a surface that the
state is beyond fires at once, and a clock's tick counts once. Cost: one lane at a time.
"""

import math
from typing import Any, NamedTuple

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.taylor import layout
from squealpipe.systems.taylor.lanes import call
from squealpipe.systems.taylor.observation import begin_late, entered_row
from squealpipe.systems.taylor.simd import ROW, first_bit


class SurfaceRoundOff(NamedTuple):
    """Round-off of a surface's values, over the terms that cancel in them.

    Attributes:
        slack: a surface lies within this of zero where round-off hides its sign. Doubling it takes
            twice as many starts for lying on their surface.
        noise: of its polynomial and of its rate. Doubling it hides roots twice as far from each
            other.
    """

    slack: float = 1e-13
    noise: float = 1e-15


surface_round_off = SurfaceRoundOff()


@part
def put_into(t: Any, m: Any, lane: int, component: int, regime: int) -> None:
    """Put a component of a lane into a regime: its constants."""
    m.integers[layout.integers.first_regime + component, lane] = regime
    first = t.n_rows - t.n_constants
    for constant in range(m.first_constant[component], m.first_constant[component + 1]):
        m.rows[first + constant, lane] = m.regimes[regime, constant]


@inline
def parameters_of(t: Any, lane: int) -> int:
    """Address of a lane's parameters, which the constants of its regimes follow."""
    first = t.n_rows - t.n_constants - t.n_parameters
    return int(t.rows + first * ROW + 8 * lane)


@part
def settle(t: Any, lane: int) -> None:
    """Compute what depends on a lane's parameters and regimes alone."""
    if t.settle:
        call(t.settle, (parameters_of(t, lane),))


@part
def gauge(t: Any, lane: int, width: int) -> None:
    """Surfaces and outputs, and the size of their terms, of the state in the scratch."""
    stride = 8 * width
    arguments = t.scratch, t.scratch + stride, parameters_of(t, lane)
    call(t.gauge, (*arguments, t.scratch + 2 * stride))


@part
def _watch_clock(m: Any, lane: int, surface: int, gauged: Any) -> None:
    """Note a clock that ticks just now, and whether that tick has been carried out already."""
    height, terms, rate = gauged[0], gauged[1], gauged[2]
    if abs(height) <= surface_round_off.slack * terms:
        m.fresh[surface] |= 1 << lane
        now = m.rows[layout.numbers.clock, lane]
        # a clock that fired less than this share of its unit of time before has not come round
        # again
        same_tick = 1e-6
        if (now - m.ticked[surface, lane]) * rate <= same_tick * terms:
            m.ticked[surface, lane] = now


@part
def watch(t: Any, m: Any, c: Any, lane: int, span: float) -> None:
    """Note the surfaces that a lane watches in its regimes, and those that start at zero or beyond.

    One that the state is beyond fires at once. Within the tolerance of zero it starts from there,
    and fires if it goes on. A surface with a switch on both sides has nothing beyond it, nor has
    one whose switch changes nothing, nor a clock. A clock's tick at this very instant counts, but
    once: what it leads to may lead back.
    """
    bit, keep = 1 << lane, ~(1 << lane)
    z, sizes, out = m.scratch[0], m.scratch[1], m.scratch[2]
    for variable in range(t.n_variables):
        z[variable] = c[variable, 0, lane]
        sizes[variable] = abs(z[variable]) + abs(c[variable, 1, lane]) * span
    gauge(t, lane, m.scratch.shape[1])
    # where an event was located to the tolerance only, the rate that follows from it is no better
    located = max(
        surface_round_off.noise,
        layout.LOST_ERROR
        * math.exp(-m.limits[m.integers[layout.integers.job, lane], 4]),
    )
    for surface in range(t.n_surfaces):
        m.noise[surface, 0, lane] = surface_round_off.noise * out[3 * surface + 1]
        m.noise[surface, 1, lane] = located * out[3 * surface + 2]
    # a state is known to round-off of its typical size, however small it has become
    job = m.integers[layout.integers.job, lane]
    for variable in range(t.n_states):
        sizes[variable] = max(sizes[variable], m.sizes[job, variable])
    gauge(t, lane, m.scratch.shape[1])
    for surface in range(t.n_surfaces):
        m.active[surface] &= keep
        m.fresh[surface] &= keep
        m.beyond[surface] &= keep
        regime = m.integers[layout.integers.first_regime + m.owner[surface], lane]
        falls, rises = m.falls[regime, surface] >= 0, m.rises[regime, surface] >= 0
        if not (falls or rises):
            continue
        m.active[surface] |= bit
        height, terms = out[3 * surface], out[3 * surface + 1]
        if m.clocks[surface]:
            _watch_clock(m, lane, surface, out[3 * surface : 3 * surface + 3])
            continue
        passed = falls != rises and (height < 0.0) == falls
        passed = passed and m.marks[regime, surface] == 0
        if passed and abs(height) > max(surface_round_off.slack, located) * terms:
            m.beyond[surface] |= bit
        elif passed or abs(height) <= surface_round_off.slack * terms:
            m.fresh[surface] |= bit


@part
def _start_where_crossed(t: Any, m: Any, lane: int, which: int, before: int) -> None:
    """Start a surface just crossed from zero, whatever round-off has left of it at its root.

    A root is known to round-off of the terms along its step, and the state keeps that error when
    they have become small: the terms after the switch tell nothing of it. So where a switch leads
    no further from the surface than the root was, it is on it. Follows :func:`watch`, whose
    surfaces are in the scratch.

    Args:
        which: the switch carried out.
        before: the regime that it leaves.
    """
    bit, component = 1 << lane, m.component_of[before]
    z, out = m.scratch[0], m.scratch[2]
    for surface in range(t.n_surfaces):
        crossed = m.falls[before, surface] == which or m.rises[before, surface] == which
        height, terms = out[3 * surface], out[3 * surface + 1]
        known = m.clocks[surface] != 0 or abs(height) <= surface_round_off.slack * terms
        if known or not (crossed and m.active[surface] & bit):
            continue
        for variable in range(t.n_states):
            z[variable] = m.rows[layout.numbers.first_of_system + variable, lane]
        after = m.integers[layout.integers.first_regime + component, lane]
        put_into(t, m, lane, component, before)
        settle(t, lane)
        gauge(t, lane, m.scratch.shape[1])
        put_into(t, m, lane, component, after)
        settle(t, lane)
        if abs(height) <= abs(out[3 * surface]) + surface_round_off.slack * terms:
            m.beyond[surface] &= ~bit
            m.fresh[surface] |= bit
        return


@part
def is_beyond(t: Any, m: Any, lane: int, which: int) -> bool:
    """Tell whether a lane has entered a regime beyond the surface of this switch of the regime."""
    beyond = False
    for surface in range(t.n_surfaces):
        regime = m.integers[layout.integers.first_regime + m.owner[surface], lane]
        if m.falls[regime, surface] == which or m.rises[regime, surface] == which:
            beyond |= (m.beyond[surface] & (1 << lane)) != 0
    return beyond


@part
def _log(t: Any, m: Any, lane: int, kind: int, regime: int) -> int:
    """Count an event and, if its kind is and there is room, log it; returns how many there were."""
    integers, job, after = (
        m.integers,
        m.integers[layout.integers.job, lane],
        m.scratch[3],
    )
    count, place = (
        integers[layout.integers.events, lane],
        integers[layout.integers.logged, lane],
    )
    if m.logs[kind] and place < t.n_logged:
        m.event_times[job, place] = (
            m.rows[layout.numbers.clock, lane] + m.rows[layout.numbers.correction, lane]
        )
        m.event_kinds[job, place], m.event_regimes[job, place] = kind, regime
        for variable in range(t.n_states):
            m.event_states[job, place, variable] = after[variable]
        integers[layout.integers.logged, lane] = place + 1
    integers[layout.integers.events, lane] = count + 1
    m.counts[job, kind] += 1
    before, peaks = m.scratch[0], m.peaks[job, kind]
    for variable in range(t.n_states):
        peaks[variable] = max(peaks[variable], abs(before[variable]))
    if math.isnan(m.firsts[job, kind]):
        m.firsts[job, kind] = m.rows[layout.numbers.clock, lane]
        if kind == t.late_from:
            begin_late(
                t, m, lane, layout.numbers.first_of_system + t.n_variables + t.n_states
            )
    return int(count + 1)


@part
def _note_constants(t: Any, m: Any, lane: int) -> None:
    """Keep the constants of the regimes that are left in the scratch."""
    first = t.n_rows - t.n_constants
    for constant in range(t.n_constants):
        m.scratch[5, constant] = m.rows[first + constant, lane]


@part
def _carry_over(
    t: Any, m: Any, lane: int, tangent_row: int, regime: int, at_once: int
) -> None:
    """A perturbation across the switch whose states and constants before it are in the scratch."""
    d, out, stride = m.scratch[4], m.scratch[2], m.scratch.shape[1] * 8
    for variable in range(t.n_states):
        d[variable] = m.rows[tangent_row + variable, lane]
    z, y, constants = t.scratch, t.scratch + 3 * stride, t.scratch + 5 * stride
    at, which = t.scratch + 4 * stride, m.integers[layout.integers.hit, lane]
    arguments = z, y, parameters_of(t, lane), constants, at, t.scratch + 2 * stride
    delay = t.rows + layout.numbers.delay * ROW + 8 * lane
    call(t.jump, (which, regime, at_once, delay, *arguments))
    for variable in range(t.n_states):
        m.rows[tangent_row + variable, lane] = out[variable]


@part
def switch(t: Any, m: Any, c: Any, lane: int, tangent_row: int) -> None:
    """Carry out the switch that ended a lane's step."""
    rows, integers = m.rows, m.integers
    which = integers[layout.integers.hit, lane]
    if which >= t.n_switches:
        integers[layout.integers.outcome, lane] = (
            layout.outcomes.stopped + which - t.n_switches
        )
        return
    span, clock = rows[layout.numbers.step, lane], rows[layout.numbers.clock, lane]
    z, after, out = m.scratch[0], m.scratch[3], m.scratch[2]
    for variable in range(t.n_variables):
        z[variable] = c[variable, 0, lane]
        after[variable] = z[variable]
    place = t.scratch + 2 * m.scratch.shape[1] * 8
    call(t.change, (which, t.scratch, parameters_of(t, lane), place))
    regime, kind = int(out[0]), int(out[1])
    for variable in range(t.n_states):
        after[variable] = out[2 + variable]
    for surface in range(t.n_surfaces):
        now = integers[layout.integers.first_regime + m.owner[surface], lane]
        if m.falls[now, surface] == which or m.rises[now, surface] == which:
            m.ticked[surface, lane] = clock
    component = m.component_of[regime]
    before = integers[layout.integers.first_regime + component, lane]
    at_once = int(is_beyond(t, m, lane, which))
    _note_constants(t, m, lane)
    put_into(t, m, lane, component, regime)
    settle(t, lane)
    if t.tangent:
        _carry_over(t, m, lane, tangent_row, regime, at_once)
    for variable in range(t.n_states):
        c[variable, 0, lane] = after[variable]
    integers[layout.integers.chained, lane] += 1
    if span > 4.0 * 2.0**-52 * abs(clock):
        integers[layout.integers.chained, lane] = 0
    count = _log(t, m, lane, kind, regime)
    first_time = (
        layout.numbers.first_of_system + t.n_variables + t.n_states + 2 * t.n_tracked
    )
    entered = entered_row(t) + component
    rows[first_time + before, lane] += clock - rows[entered, lane]
    rows[entered, lane] = clock
    watch(t, m, c, lane, span)
    if not at_once:
        _start_where_crossed(t, m, lane, which, before)
    _may_end(t, m, lane, kind, count)


@part
def _may_end(t: Any, m: Any, lane: int, kind: int, count: int) -> None:
    """End a run at the event that it waits for, or that makes too many."""
    integers, job = m.integers, m.integers[layout.integers.job, lane]
    # so many switches of a component without progress in time end a run
    longest_chain = 64
    if kind == t.until:
        integers[layout.integers.outcome, lane] = layout.outcomes.by_event
    elif integers[layout.integers.chained, lane] >= longest_chain * t.n_components:
        integers[layout.integers.outcome, lane] = layout.outcomes.accumulation
    elif count >= m.limits[job, 3]:
        integers[layout.integers.outcome, lane] = layout.outcomes.event_limit


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
    while special:
        lane = first_bit(special)
        special ^= 1 << lane
        end_step(t, m, c, lane, tangent_row)


@inline
def end_step(t: Any, m: Any, c: Any, lane: int, tangent_row: int) -> None:
    """Carry out what ended the step of a lane."""
    hit = m.integers[layout.integers.hit, lane]
    if hit == layout.integers.late_begins:
        begin_late(t, m, lane, tangent_row + t.n_states)
        # a surface may be crossed at this very instant
        watch(t, m, c, lane, m.rows[layout.numbers.step, lane])
    elif (
        hit >= 0
        and m.integers[layout.integers.outcome, lane] == layout.outcomes.running
    ):
        switch(t, m, c, lane, tangent_row)
    m.integers[layout.integers.hit, lane] = -1
