"""The compiled loop of all linear structures: one run after the other, a Taylor step at a time.

Idea: what happens after a step (events located, switched, logged; samples, extremes, ends) is the
engine's, :mod:`squealpipe.systems.taylor`, whose functions take one lane of arrays. What a step
itself takes is written here for one lane with its orders side by side, so that products with
matrices and tests of all surfaces run through memory once; a structure of hundreds of contacts
has no room for the sixteen lanes of the engine.

Invariant: a surface is looked at one by one where a bound of its second derivative cannot exclude
a root; events, regimes and outcomes are those of the engine.

Cost: an order of the series takes four products of modes × contacts; an event about as much again.
"""

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.linear.contact_numbers import contact_row
from squealpipe.systems.linear.forces import exact_ends, write_forces
from squealpipe.systems.linear.matrices import friction_number
from squealpipe.systems.linear.numbering import OF_CONTACT, surface_number
from squealpipe.systems.linear.plan import (
    SPECIAL,
    numbers_of,
    parameter_row,
    plan_at,
    plan_of,
)
from squealpipe.systems.linear.series import series
from squealpipe.systems.linear.sizes import gauge_state
from squealpipe.systems.linear.starts import find_starts
from squealpipe.systems.linear.sticking import settle_stick
from squealpipe.systems.linear.switches import change_state
from squealpipe.systems.taylor import layout
from squealpipe.systems.taylor.checking import (
    believe_or_halve,
    stands_still,
    step_checks,
)
from squealpipe.systems.taylor.lanes import (
    address_of,
    call,
    compile_advance,
    compile_called,
    record_viewer,
    view,
)
from squealpipe.systems.taylor.loop import finish, start
from squealpipe.systems.taylor.memory import memory_at
from squealpipe.systems.taylor.observation import (
    extremes_between,
    extremes_inside,
    sample,
)
from squealpipe.systems.taylor.step import cut, series_convergence
from squealpipe.systems.taylor.switching import end_step, parameters_of

_FOLDER = Path(__file__).parent
_record_at: Any = record_viewer(layout.LOOP_TABLE)
LANE = 0
"""The only lane that runs."""


@part
def step_length(mem: Any, units: Any) -> Any:
    """Length of the next step from the last two orders (Jorba and Zou 2005; Biscani 2021)."""
    terms, size, last, previous = mem.shape[0], 1.0, 1e-300, 1e-300
    first, top, below = mem[0], mem[terms - 1], mem[terms - 2]
    for i in range(units.shape[0]):
        unit = units[i, LANE]
        size = max(size, abs(first[i]) * unit)
        last = max(last, abs(top[i]) * unit)
        previous = max(previous, abs(below[i]) * unit)
    order = terms - 1.0
    reach = min(
        (size / last) ** (1.0 / order), (size / previous) ** (1.0 / (order - 1.0))
    )
    return reach * math.exp(-2.0 - 0.7 / (order - 1.0))


@part
def _has_converged(mem: Any, place: int, step: float) -> Any:
    """Return the longest step, up to one, in which a surface has converged as the states have."""
    terms = mem.shape[0]
    last, later = abs(mem[terms - 3, place]), abs(mem[terms - 2, place])
    height, slope, bend = abs(mem[0, place]), abs(mem[1, place]), abs(mem[2, place])
    shorter = step
    size = height + shorter * (slope + shorter * bend)
    share = series_convergence.spare * math.exp(-2.0 * (terms - 3.0)) * size
    at_last, at_later = last * step ** (terms - 3), later * step ** (terms - 2)
    if at_last < share and at_later < share * math.exp(-2.0):
        return step
    for _ in range(series_convergence.fits):
        size = height + shorter * (slope + shorter * bend)
        if not size > 1e-300:
            break
        target = math.inf
        if last > 1e-300:
            target = (size / last) ** (1.0 / (terms - 3.0)) * math.exp(-2.0)
        if later > 1e-300:
            other = (size / later) ** (1.0 / (terms - 2.0)) * math.exp(-2.0)
            target = min(target, other)
        shorter = min(shorter, target)
    return shorter


@part
def shorter_step(m: Any, k: Any, rows: Any, mem: Any, step: float) -> Any:
    """Return a step that the friction of no contact makes too long.

    Far from where it acts an exponential has coefficients that round to nothing: its argument
    changes by 2, or by a share of what lies beyond, at most (as ``series.shorten_source``).
    """
    terms, c = mem.shape[0], k.c
    for surface in range(surface_number.margin * c, (surface_number.margin + 2) * c):
        if m.active[surface] & 1:
            step = _has_converged(mem, k.n_states + surface, step)
    for i in range(c):
        if (
            k.laws[i] != friction_number.exponential
            or k.by_contact[contact_row.side, i] == 0.0
        ):
            continue
        reference = rows[parameter_row.coefficients + OF_CONTACT * i + 2, 0]
        place = k.n_states + surface_number.lag * c + i
        most = max(0.3 * (abs(mem[0, place]) / reference - 20.0), 2.0) * reference
        low, x = step * 1e-12, step
        for _ in range(6):
            u = abs(mem[terms - 1, place])
            for order in range(terms - 2, 0, -1):
                u = u * x + abs(mem[order, place])
            low = max(low, min(most / u, x)) if u > 0.0 else max(low, x)
            x = math.sqrt(low * step)
        step = min(step, low)
    return step


@inline
def _look_at_surfaces(t: Any, m: Any, mem: Any, step: float, work: Any) -> Any:
    """Mark the surfaces that may have a root in the step; tell whether there are any.

    Both ends of the others are further from zero than they bend, or they are monotone from one side
    of zero that round-off does not hide.
    """
    terms, first, count = mem.shape[0], t.n_variables, t.n_surfaces
    value, bend = work[0], work[1]
    for s in range(count):
        value[s], bend[s] = mem[terms - 1, first + s], 0.0
    for order in range(terms - 1, 1, -1):
        row, weight = mem[order, first : first + count], order * (order - 1.0)
        below = mem[order - 1, first : first + count]
        for s in range(count):
            bend[s] = bend[s] * step + abs(row[s]) * weight
            value[s] = value[s] * step + below[s]
    share, found = 0.125 * step * step, False
    for s in range(count):
        start = mem[0, first + s]
        end = value[s] * step + start
        slope, nearest = abs(mem[1, first + s]) * step, min(abs(start), abs(end))
        bound = bend[s] * share
        if 8.0 * bound < slope:  # which the second derivative cannot turn
            bound = min(bound, 1e-9 * slope)
        free = start * end > 0.0 and bound < nearest
        suspect = m.active[s] & 1 and (not free or m.beyond[s] & 1)
        m.suspects[s] = 1 if suspect else 0
        found = found or suspect
    return found


@part
def _write_ends(mem: Any, first: int, step: float, value: Any) -> None:
    """Write some series, side by side, at the end of a step."""
    terms, n = mem.shape[0], value.size
    for i in range(n):
        value[i] = mem[terms - 1, first + i]
    for order in range(terms - 2, -1, -1):
        row = mem[order, first : first + n]
        for i in range(n):
            value[i] = value[i] * step + row[i]


@inline
def _end_states(t: Any, m: Any, mem: Any, step: float, work: Any) -> Any:
    """Write the states at the end of a step; tell whether all are finite."""
    n, value = t.n_variables, work[0]
    _write_ends(mem, 0, step, value[:n])
    lost = 0.0
    for i in range(n):
        m.rows[layout.numbers.first_of_system + i, LANE] = value[i]
        lost += 0.0 * value[i]
    return lost == 0.0


@inline
def _reaches(m: Any, instant: int) -> Any:
    """Tell whether the step does not end before the instant in a row."""
    left = m.rows[instant, LANE] - m.rows[layout.numbers.clock, LANE]
    return (
        not m.rows[layout.numbers.step, LANE]
        < left - m.rows[layout.numbers.correction, LANE]
    )


@inline
def _take_step(t: Any, m: Any, k: Any, rows: Any, mem: Any, work: Any) -> Any:
    """Choose a step; tell whether something may happen in it."""
    step = min(step_length(mem, m.units), m.rows[layout.numbers.longest, LANE])
    natural, left = step, -math.inf
    if k.curved:
        left = m.rows[layout.numbers.t_end, LANE] - m.rows[layout.numbers.clock, LANE]
        left -= m.rows[layout.numbers.correction, LANE]
        step = shorter_step(m, k, rows, mem, min(step, left))
    m.rows[layout.numbers.step, LANE] = step
    m.rows[layout.numbers.natural, LANE] = step if step < left else natural
    plain = _end_states(t, m, mem, step, work)
    suspect = _look_at_surfaces(t, m, mem, step, work)
    ends = _reaches(m, layout.numbers.t_end) or _reaches(m, layout.numbers.t_late)
    return not plain or suspect or ends


@part
def _check(t: Any, m: Any, c: Any, k: Any, rows: Any, work: Any) -> Any:
    """Halve a step until its end can be believed; tell whether it was halved or ended the run."""
    m.rows[layout.numbers.gap, LANE], halved = math.inf, False
    while m.rows[layout.numbers.step, LANE] > 0.0:
        for i in range(t.n_variables):
            work[0, i] = m.rows[layout.numbers.first_of_system + i, LANE]
        exact_ends(k, rows, work[0], m.exact)
        stands = believe_or_halve(t, m, c, LANE)
        if (
            not stands
            or m.integers[layout.integers.outcome, LANE] != layout.outcomes.running
        ):
            halved = True
        if stands:
            break
    return halved


@inline
def _observe(t: Any, m: Any, c: Any, mem: Any, first_extreme: int) -> None:
    """Extremes of the tracked quantities over a step.

    Inside a step a quantity leaves the span of its ends by at most h²/8 times its second
    derivative, bounded by its first orders and a share for the others: only where that could be a
    record are turning points looked for.
    """
    step, n = m.rows[layout.numbers.step, LANE], t.n_variables
    ends = m.scratch[4]
    if t.n_tracked:  # states at the end are known
        _write_ends(mem, n, step, ends[: t.n_surfaces + t.n_outputs])
    for index in range(t.n_tracked):
        place, r = m.tracked[index, 0], first_extreme + 2 * index
        start = c[place, 0, LANE]
        end = m.rows[layout.numbers.first_of_system + place, LANE]
        if place >= n:
            end = ends[place - n]
        low, high = min(start, end), max(start, end)
        bend = 0.75 * abs(c[place, 3, LANE]) + 1.5 * step * abs(c[place, 4, LANE])
        bend = step * step * (0.25 * abs(c[place, 2, LANE]) + step * bend)
        beyond = bend + 2e-4 * max(abs(start), abs(end))
        least, most = min(low, m.rows[r, LANE]), max(high, m.rows[r + 1, LANE])
        # a slope that the second derivative cannot turn leaves no turning point
        turns = abs(c[place, 1, LANE]) * step < 8.0 * beyond
        if turns and (most < high + beyond or low - beyond < least):
            inner_low, inner_high = extremes_inside(c, place, LANE, 0.0, step)
            least, most = min(least, inner_low), max(most, inner_high)
        m.rows[r, LANE], m.rows[r + 1, LANE] = least, most


@inline
def _go_on(t: Any, m: Any, mem: Any) -> None:
    """Start the next step where this one ended; the time is compensated."""
    for i in range(t.n_variables):
        mem[0, i] = m.rows[layout.numbers.first_of_system + i, LANE]
    m.rows[layout.numbers.steps, LANE] += 1.0
    increment = (
        m.rows[layout.numbers.step, LANE] + m.rows[layout.numbers.correction, LANE]
    )
    clock = m.rows[layout.numbers.clock, LANE]
    time = clock + increment
    m.rows[layout.numbers.correction, LANE] = (clock - time) + increment
    m.rows[layout.numbers.clock, LANE] = time


@part
def _switch(t: Any, m: Any, c: Any, tangent_row: int, special: bool) -> None:
    """Carry out what ended a step."""
    for surface in range(t.n_surfaces):
        m.fresh[surface] = 0
    if special:
        end_step(t, m, c, LANE, tangent_row)


@part
def _next_run(t: Any, m: Any, c: Any, k: Any, tangent_row: int) -> Any:
    """Finish the run that has ended and start the next one; tell whether there is one."""
    first_extreme = tangent_row + t.n_states
    if m.integers[layout.integers.job, LANE] >= 0:
        finish(t, m, c, LANE, tangent_row, first_extreme)
    m.integers[layout.integers.job, LANE] = -1
    if m.queue[0] >= m.queue[1]:
        return False
    job = m.queue[0]
    m.queue[0] += m.queue[2]
    k.counts[0] = -1  # of another run
    start(t, m, c, LANE, job, tangent_row, first_extreme)
    return True


@inline
def _step(t: Any, m: Any, c: Any, k: Any, rows: Any, mem: Any, work: Any) -> Any:
    """Choose a step of the series that can be believed; tell whether it is special."""
    for surface in range(t.n_surfaces):
        if m.fresh[surface] & 1:
            mem[0, t.n_variables + surface] = 0.0
    special = _take_step(t, m, k, rows, mem, work)
    if special:
        cut(t, m, c, LANE)
    if k.curved:
        special = _check(t, m, c, k, rows, work) or special
    short = step_checks.finest * m.rows[layout.numbers.t_end, LANE]
    if m.rows[layout.numbers.step, LANE] < short and stands_still(t, m, c, LANE):
        m.integers[layout.integers.outcome, LANE] = layout.outcomes.discontinuity
        special = True
    return special


@inline
def _rounds(table: int, t: Any, m: Any, c: Any, k: Any, mem: Any) -> Any:
    """Steps until no run is left, or there were enough.

    Args:
        table: address of what ``t`` is.
    """
    parameters = parameters_of(t, LANE)
    tangent_row = layout.numbers.first_of_system + t.n_variables
    first_extreme = tangent_row + t.n_states
    first_time = first_extreme + 2 * t.n_tracked
    for _ in range(t.n_rounds):
        ended = m.integers[layout.integers.outcome, LANE] != layout.outcomes.running
        if ended and not _next_run(t, m, c, k, tangent_row):
            return 0
        call(t.take_step, (parameters, t.series, t.n_terms))
        call(t.longest, (table,))
        special = k.counts[SPECIAL] != 0
        # before the samples, which count on to the next one that is due
        if t.n_between:
            extremes_between(t, m, c, LANE)
        if t.n_samples and _reaches(m, layout.numbers.next_sample):
            sample(t, m, c, LANE, first_time)
        _observe(t, m, c, mem, first_extreme)
        _go_on(t, m, mem)
        _switch(t, m, c, tangent_row, special)
        spent = (
            m.rows[layout.numbers.steps, LANE]
            >= m.rows[layout.numbers.most_steps, LANE]
        )
        if (
            spent
            and m.integers[layout.integers.outcome, LANE] == layout.outcomes.running
        ):
            m.integers[layout.integers.outcome, LANE] = layout.outcomes.step_limit
    return 1


def _advance(table: Any) -> int:
    """Some rounds; returns 0 where all runs are finished. The table: that of the engine."""
    address = address_of(table)
    t = _record_at(address)
    m = memory_at(address)
    mem = view(t.series, (t.n_terms, t.n_series), np.float64)
    c = view(t.series, (1, t.n_terms, t.n_series), np.float64)[:, :, ::1].T
    k = plan_at(t.inverses)
    return int(_rounds(address, t, m, c, k, mem))


def _take(table: int) -> None:
    """Choose a step by the address of a table; the plan gets whether it is special."""
    t = _record_at(table)
    m = memory_at(table)
    mem = view(t.series, (t.n_terms, t.n_series), np.float64)
    c = view(t.series, (1, t.n_terms, t.n_series), np.float64)[:, :, ::1].T
    k = plan_at(t.inverses)
    rows = numbers_of(k, parameters_of(t, LANE))
    special = _step(t, m, c, k, rows, mem, m.scratch[4:6])
    k.counts[SPECIAL] = 1 if special else 0


def _series(parameters: int, orders: int, terms: int) -> None:
    """Call :func:`.series.series` by addresses."""
    k = plan_of(parameters)
    # after those of the states, surfaces and outputs come
    width = k.n_states + k.n_sorts * k.c + 2 * k.c + k.n_shapes
    mem = view(orders, (terms, width), np.float64)
    series(k, numbers_of(k, parameters), mem)


def _gauge(z: int, sizes: int, parameters: int, out: int) -> None:
    """Call :func:`.sizes.gauge_state` by addresses."""
    k = plan_of(parameters)
    count, n = 3 * (k.n_sorts * k.c + 2 * k.c + k.n_shapes), k.n_states
    state, of_state = view(z, (n,), np.float64), view(sizes, (n,), np.float64)
    found = view(out, (count,), np.float64)
    gauge_state(k, numbers_of(k, parameters), state, of_state, found)


def _change(which: int, z: int, parameters: int, out: int) -> None:
    """Call :func:`.switches.change_state` by addresses."""
    k = plan_of(parameters)
    n = k.n_states
    state, found = view(z, (n,), np.float64), view(out, (n + 2,), np.float64)
    change_state(k, numbers_of(k, parameters), which, state, found)


def _settle(parameters: int) -> None:
    """Call :func:`.sticking.settle_stick` by the address of a lane's parameters."""
    k = plan_of(parameters)
    settle_stick(k, numbers_of(k, parameters))


def _forces(parameters: int, z: int, pressing: int) -> None:
    """Call :func:`.forces.write_forces` by addresses."""
    k = plan_of(parameters)
    state, found = (
        view(z, (k.n_states,), np.float64),
        view(pressing, (k.contacts,), np.float64),
    )
    write_forces(k, numbers_of(k, parameters), state, found)


@cache
def loop() -> Any:
    """Return the compiled loop, built once a process and kept on disk."""
    return compile_advance(_advance, _FOLDER)


@cache
def functions() -> dict[str, int]:
    """Return the addresses of what compiled code calls, and of the search for first regimes.

    Each is compiled by itself: of one large function LLVM would optimize every part again in each
    that holds it, and keep nothing in registers.
    """
    return {
        "series": compile_called(_series, 3, _FOLDER),
        "take": compile_called(_take, 1, _FOLDER),
        "gauge": compile_called(_gauge, 4, _FOLDER),
        "change": compile_called(_change, 4, _FOLDER),
        "settle": compile_called(_settle, 1, _FOLDER),
        "forces": compile_called(_forces, 3, _FOLDER),
        "starts": compile_called(find_starts, 1, _FOLDER),
    }
