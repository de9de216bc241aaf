"""Taylor series of motions of contacts on a belt, by their matrices.

Idea: in every regime the motion is M⁻¹ times matrices that do not change, so the orders of its
series are matrix products: lifts nᵀq and sliding speeds tᵀq̇ of all contacts, forces by their
regimes, and back.

Cost: an order takes four products of n × c numbers.
"""

import math
from typing import Any

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.linear.contact_numbers import (
    contact_row,
    friction_of,
    is_stuck,
    line_of_press,
    press_knot,
    regime_value,
    time_unit,
)
from squealpipe.systems.linear.forces import slider_lag
from squealpipe.systems.linear.matrices import friction_number, regime_constant
from squealpipe.systems.linear.numbering import surface_number
from squealpipe.systems.linear.plan import mode_row, parameter_row
from squealpipe.systems.linear.products import (
    add_columns,
    add_listed,
    add_row,
    copy_numbers,
    dot,
    write_columns,
)
from squealpipe.systems.linear.sticking import add_stick, stick_forces
from squealpipe.systems.taylor.simd import ROW, fma, load, splat, store


@inline
def _list_forces(k: Any, rows: Any) -> None:
    """Note what the regimes make of each contact, and which contacts push and slip.

    A closed contact's spring is in the stiffness: it pushes at order 0 alone, by its preload, but
    for a piece of a table that is not as stiff.
    """
    opened, slipping = 0, 0
    for i in range(k.c):
        closed = regime_value(k, rows, i, regime_constant.is_closed) > 0.0
        direction = regime_value(k, rows, i, regime_constant.direction)
        mu, static, _ = friction_of(k, rows, i)
        k.by_contact[contact_row.closed, i], k.by_contact[contact_row.side, i] = (
            1.0 if closed else 0.0,
            direction,
        )
        k.by_contact[contact_row.limit, i] = static
        k.by_contact[contact_row.drag, i] = direction * mu if closed else 0.0
        if not closed:
            k.lists[0, opened] = i
            opened += 1
        else:
            if k.n_tables and k.press_counts[i] > 1:
                k.lists[0, opened] = i
                opened += 1
            if direction != 0.0 or k.sliders[i] >= 0:
                k.lists[1, slipping] = i
                slipping += 1
    k.counts[2], k.counts[3] = opened, slipping


@inline
def _forces_of_lifts(k: Any, preload: float, belt: float) -> None:
    """Compute forces and speeds of all contacts from lifts and slides, side by side in vectors."""
    work, width = k.by_contact.ctypes.data, 8 * k.by_contact.shape[1]
    springs, preloads = k.springs.ctypes.data, k.preloads.ctypes.data
    for place in range(0, width, ROW):
        at = work + place
        shut = load(at + contact_row.closed * width)
        force = load(springs + place) * load(at + contact_row.press * width)
        pushed = load(preloads + place) * preload
        pressing = pushed - force
        store(at + contact_row.press * width, pressing)
        store(at + contact_row.relieved * width, shut * pushed + (1.0 - shut) * force)
        store(
            at + contact_row.slip * width,
            load(at + contact_row.drag * width) * pressing,
        )
        carried = load(k.speeds.ctypes.data + place) * belt
        slide = carried - load(at + contact_row.lags * width)
        store(at + contact_row.lags * width, slide)
        store(
            at + contact_row.of_lag * width, load(at + contact_row.side * width) * slide
        )


@inline
def _contacts_at_order(k: Any, rows: Any, mem: Any, order: int, q: Any, v: Any) -> None:
    """Compute an order of the surfaces, outputs and forces of all contacts, but for stick.

    Args:
        q, v: this order of displacements and velocities.
    """
    n, c, row = k.n, k.c, mem[order]
    first_output = k.n_states + k.n_sorts * c
    pressing, slides = k.by_contact[contact_row.press], k.by_contact[contact_row.lags]
    lags, closed = k.by_contact[contact_row.of_lag], k.by_contact[contact_row.closed]
    write_columns(k.normals, q, pressing)
    write_columns(k.tangentials, v, slides)
    for a in range(k.n_tables):
        # a row of work that no series uses keeps what the next line overwrites
        k.by_contact[contact_row.of_press, k.with_tables[a]] = pressing[
            k.with_tables[a]
        ]
    _forces_of_lifts(
        k,
        rows[parameter_row.preload, 0] if order == 0 else 0.0,
        rows[parameter_row.belt, 0] if order == 0 else 0.0,
    )
    if k.n_tables:
        _tables_at_order(k, rows, order)
    at = k.n_states
    copy_numbers(pressing, row[at : at + c])
    copy_numbers(lags, row[at + c : at + 2 * c])
    margins, shown = row[at + 2 * c : at + 4 * c], row[first_output:]
    for i in range(2 * c):
        margins[i] = 0.0
    if k.n_sliders:
        _sliders_at_order(k, rows, mem, order, v)
    for i in range(c):
        shown[2 * i], shown[2 * i + 1] = closed[i] * pressing[i], slides[i]
    if k.curved:
        _curved_slip_at_order(k, rows, mem, order)
    if k.n_sorts > surface_number.before_end:
        _knots_at_order(k, rows, row, order)
    for shape in range(k.n_shapes):
        row[first_output + 2 * c + shape] = dot(k.shapes[shape], row[:n])


@part
def _tables_at_order(k: Any, rows: Any, order: int) -> None:
    """Compute an order of the forces of contacts with tables, by their pieces."""
    for a in range(k.n_tables):
        i = k.with_tables[a]
        lift = k.by_contact[contact_row.of_press, i]
        stiffness, at_rest = line_of_press(k, rows, i)
        if order:
            at_rest = 0.0
        force = at_rest - stiffness * lift
        k.by_contact[contact_row.press, i] = force
        k.by_contact[contact_row.slip, i] = k.by_contact[contact_row.drag, i] * force
        if k.by_contact[contact_row.closed, i] > 0.0:
            pushed = at_rest + (k.springs[i] - stiffness) * lift
            k.by_contact[contact_row.relieved, i] = pushed


@part
def _sliders_at_order(k: Any, rows: Any, mem: Any, order: int, v: Any) -> None:
    """Compute an order of stretches, forces and surfaces of contacts with tangential springs.

    A slider that sticks is carried by the belt, so that the spring stretches at the sliding speed;
    one that slips keeps its spring at μN.
    """
    c, first, row = k.c, k.n_states, mem[order]
    for a in range(k.n_sliders):
        i = k.with_sliders[a]
        place, spring = k.sliders[i], k.tangential_springs[i]
        if is_stuck(k, rows, i):
            if order:
                lag = mem[order - 1, first + k.n_sorts * c + 2 * i + 1]
                row[place] = time_unit(k, rows) / order * lag
            friction = spring * row[place]
            k.by_contact[contact_row.slip, i] = friction
            _, static, _ = friction_of(k, rows, i)
            limit = static * k.by_contact[contact_row.press, i]
            row[first + surface_number.margin * c + i] = limit - friction
            row[first + surface_number.margin_back * c + i] = limit + friction
        else:
            row[place] = k.by_contact[contact_row.slip, i] / spring
            if k.by_contact[contact_row.side, i] != 0.0:
                at = first + surface_number.lag * c + i
                row[at] = slider_lag(k, rows, i, row[at], v)


@part
def _curved_slip_at_order(k: Any, rows: Any, mem: Any, order: int) -> None:
    """Compute an order of the friction in slip of contacts whose law depends on the speed."""
    for a in range(k.counts[3]):
        i = k.lists[1, a]
        if k.laws[i]:
            slip = _slip_order(k, rows, mem, i, order)
            k.by_contact[contact_row.slip, i] = k.by_contact[contact_row.side, i] * slip


@part
def _knots_at_order(k: Any, rows: Any, row: Any, order: int) -> None:
    """Compute an order of how far speeds and forces are from the ends of their pieces."""
    c = k.c
    for i in range(c):
        _, _, reference = friction_of(k, rows, i)
        for which in range(2):
            knot = reference * regime_value(
                k, rows, i, regime_constant.first_of_piece + 1 - which
            )
            place = k.n_states + (surface_number.before_end + which) * c + i
            row[place] = row[k.n_states + surface_number.lag * c + i] - (
                knot if order == 0 else 0.0
            )
            if k.n_sorts > surface_number.press_end:
                place = k.n_states + (surface_number.press_end + which) * c + i
                row[place] = row[k.n_states + surface_number.pressing * c + i]
                if order == 0:
                    row[place] -= press_knot(k, rows, i, which)


@inline
def _stick_at_order(k: Any, row: Any) -> None:
    """Compute an order of the friction of the contacts that stick, and what it lacks to slip."""
    first, c = k.n_states, k.c
    stick_forces(k, k.by_mode[mode_row.base])
    add_stick(k, k.by_mode[mode_row.base])
    for a in range(k.counts[0]):
        i = k.stuck[a]
        limit = (
            k.by_contact[contact_row.limit, i]
            * row[first + surface_number.pressing * c + i]
        )
        row[first + surface_number.margin * c + i] = (
            limit - k.by_contact[contact_row.stick, i]
        )
        row[first + surface_number.margin_back * c + i] = (
            limit + k.by_contact[contact_row.stick, i]
        )


@inline
def _linear_rates(k: Any) -> None:
    """Compute accelerations by stiffness and damping alone."""
    at, width = k.by_mode.ctypes.data, 8 * k.by_mode.shape[1]
    pull, drag = k.pull_back.ctypes.data, k.drag_back.ctypes.data
    for place in range(0, width, ROW):
        rates = splat(0.0)
        if not k.full_stiffness:
            rates = load(pull + place) * load(at + mode_row.place * width + place)
        if not k.full_damping:
            speed = load(at + mode_row.speed * width + place)
            rates = fma(load(drag + place), speed, rates)
        store(at + mode_row.base * width + place, rates)
    if k.full_stiffness:
        add_columns(
            k.pull_back, k.by_mode[mode_row.place, : k.n], k.by_mode[mode_row.base]
        )
    if k.full_damping:
        add_columns(
            k.drag_back, k.by_mode[mode_row.speed, : k.n], k.by_mode[mode_row.base]
        )


@inline
def series(k: Any, rows: Any, mem: Any) -> None:
    """Compute the Taylor coefficients of states, surfaces and outputs, order after order.

    Args:
        mem: (orders, series): states, whose order 0 is given, surfaces and outputs.
    """
    terms, n, unit, base = (
        mem.shape[0],
        k.n,
        time_unit(k, rows),
        k.by_mode[mode_row.base],
    )
    q, v = k.by_mode[mode_row.place, :n], k.by_mode[mode_row.speed, :n]
    at, width = k.by_mode.ctypes.data, 8 * k.by_mode.shape[1]
    for j in range(n):
        q[j], v[j] = mem[0, j], mem[0, n + j]
    _list_forces(k, rows)
    for order in range(terms):
        _contacts_at_order(k, rows, mem, order, q, v)
        if order == terms - 1 and not k.counts[0]:
            return
        _linear_rates(k)
        if order == 0:
            add_row(k.load, rows[parameter_row.preload, 0] if k.balanced else 1.0, base)
            add_columns(k.push_rows, k.by_contact[contact_row.relieved], base)
        else:
            add_listed(
                k.push_rows,
                k.lists[0],
                k.counts[2],
                k.by_contact[contact_row.relieved],
                base,
            )
        add_listed(
            k.drag_rows, k.lists[1], k.counts[3], k.by_contact[contact_row.slip], base
        )
        if k.counts[0]:
            _stick_at_order(k, mem[order])
        if order < terms - 1:
            share, later = unit / (order + 1.0), mem[order + 1]
            for place in range(at, at + width, ROW):
                store(
                    place + mode_row.place * width,
                    load(place + mode_row.speed * width) * share,
                )
                store(
                    place + mode_row.speed * width,
                    load(place + mode_row.base * width) * share,
                )
            copy_numbers(q, later[:n])
            copy_numbers(v, later[n : 2 * n])


@part
def _slip_order(k: Any, rows: Any, mem: Any, i: int, order: int) -> Any:
    """Return an order of μ(|w|) N, of a law that depends on the speed."""
    mu, static, reference = friction_of(k, rows, i)
    lag, press, law = k.n_states + k.c + i, k.n_states + i, k.laws[i]
    s, inner = k.law_series[0], k.law_series[1]
    if law == friction_number.table:
        _cubic_order(k, rows, i, order, mem[order, lag] / reference)
        s[order, i] *= mu
    else:
        # of exp(−u) and of 1/(1 + u) each order follows from lower ones
        value, first = 0.0, mem[0, lag] / reference
        for j in range(1, order + 1):
            weight = float(j) if law == friction_number.exponential else 1.0
            value -= weight * mem[j, lag] / reference * inner[order - j, i]
        if order == 0:
            value = math.exp(-first) if law == friction_number.exponential else 1.0
        if law == friction_number.exponential:
            inner[order, i] = value / max(order, 1)
        else:
            inner[order, i] = value / (1.0 + first)
        s[order, i] = (static - mu) * inner[order, i]
        if order == 0:
            s[0, i] += mu
    value = 0.0
    for j in range(order + 1):
        value += s[j, i] * mem[order - j, press]
    return value


@part
def _cubic_order(k: Any, rows: Any, i: int, order: int, speed: float) -> None:
    """Write an order of a piece of a table, by two convolutions in nested form."""
    s, inner, middle, shifted = (
        k.law_series[0],
        k.law_series[1],
        k.law_series[2],
        k.law_series[3],
    )
    at, constant = regime_constant.first_of_piece, 1.0 if order == 0 else 0.0
    shifted[order, i] = speed - constant * regime_value(k, rows, i, at)
    inner[order, i] = regime_value(k, rows, i, at + 5) * shifted[order, i]
    inner[order, i] += constant * regime_value(k, rows, i, at + 4)
    value = constant * regime_value(k, rows, i, at + 3)
    for j in range(order + 1):
        value += shifted[j, i] * inner[order - j, i]
    middle[order, i] = value
    value = constant * regime_value(k, rows, i, at + 2)
    for j in range(order + 1):
        value += shifted[j, i] * middle[order - j, i]
    s[order, i] = value
