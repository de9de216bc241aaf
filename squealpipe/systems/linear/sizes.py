"""Values of surfaces and outputs at a state, with the sizes of the terms they are added from.

Round-off of a value is a share of these sizes: what is smaller is zero.
"""

from typing import Any

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.linear.contact_numbers import (
    contact_row,
    friction_of,
    is_stuck,
    line_of_press,
    press_knot,
    regime_value,
    stiffness_of,
    time_unit,
)
from squealpipe.systems.linear.forces import (
    slider_lag,
    state_forces,
    sticking_friction,
    stretch_per_force,
)
from squealpipe.systems.linear.matrices import FIRST_OF_PRESS, regime_constant
from squealpipe.systems.linear.numbering import OF_CONTACT, surface_number
from squealpipe.systems.linear.plan import mode_row, parameter_row
from squealpipe.systems.linear.products import add_sizes


@inline
def _sizes_of_contacts(
    k: Any, rows: Any, of_q: Any, of_v: Any, constant: float
) -> None:
    """Compute the sizes of what normal forces and sliding speeds are added up from.

    Args:
        of_q, of_v: sizes of displacements and velocities, or of their rates.
        constant: 1 where what does not change counts, 0 for rates.
    """
    press, lag = k.by_contact[contact_row.of_press], k.by_contact[contact_row.of_lag]
    for i in range(k.c):
        press[i], lag[i] = 0.0, 0.0
    add_sizes(k.normals, of_q, press)
    add_sizes(k.tangentials, of_v, lag)
    preload, belt = (
        constant * abs(rows[parameter_row.preload, 0]),
        constant * abs(rows[parameter_row.belt, 0]),
    )
    for i in range(k.c):
        if k.n_tables and k.press_counts[i] > 1:
            stiffness, _ = line_of_press(k, rows, i)
            at_rest = abs(rows[parameter_row.coefficients + OF_CONTACT * i + 3, 0])
            at_rest += abs(regime_value(k, rows, i, FIRST_OF_PRESS))
            fixed = (
                abs(regime_value(k, rows, i, FIRST_OF_PRESS + 2)) + stiffness * at_rest
            )
            press[i] = constant * fixed + stiffness * press[i]
        else:
            press[i] = abs(k.preloads[i]) * preload + k.springs[i] * press[i]
        lag[i] += abs(k.speeds[i]) * belt
    for a in range(k.n_sliders):
        i = k.with_sliders[a]
        if regime_value(k, rows, i, regime_constant.direction) != 0.0:
            size = 0.0
            for j in range(k.n):
                size += abs(k.normal_rows[i, j]) * of_v[j]
            lag[i] += stretch_per_force(k, rows, i) * stiffness_of(k, rows, i) * size


@part
def _sizes_of_products(matrix: Any, full: int, by: Any, total: Any) -> None:
    """Add the sizes of a matrix, or a diagonal, times a vector."""
    if full:
        add_sizes(matrix, by, total)
    else:
        for i in range(by.size):
            total[i] += abs(matrix[0, i]) * by[i]


@inline
def _sizes_of_rates(
    k: Any, rows: Any, of_q: Any, of_v: Any, constant: float, scale: Any
) -> None:
    """Compute the sizes of what accelerations, without those of stick, and stick are added from.

    Args:
        scale: (n,) gets the sizes of the accelerations.
    """
    preload = constant * abs(rows[parameter_row.preload, 0])
    press, force = (
        k.by_contact[contact_row.of_press],
        k.by_contact[contact_row.relieved],
    )
    for j in range(k.n):
        scale[j] = abs(k.load[j]) * (preload if k.balanced else constant)
    _sizes_of_products(k.pull_back, k.full_stiffness, of_q, scale)
    _sizes_of_products(k.drag_back, k.full_damping, of_v, scale)
    for i in range(k.c):
        closed = regime_value(k, rows, i, regime_constant.is_closed) > 0.0
        force[i] = abs(k.preloads[i]) * preload if closed else press[i]
        if k.n_tables and k.press_counts[i] > 1:
            stiffness, _ = line_of_press(k, rows, i)
            force[i] = press[i] * (1.0 + k.springs[i] / stiffness)
    add_sizes(k.push_rows, force, scale)
    for i in range(k.c):
        mu, static, _ = friction_of(k, rows, i)
        slips = regime_value(k, rows, i, regime_constant.direction) != 0.0
        force[i] = max(abs(mu), abs(static)) * press[i] if slips else 0.0
        force[i] += k.by_contact[contact_row.spring, i]
    add_sizes(k.drag_rows, force, scale)
    count, pulls, stick = (
        k.counts[0],
        k.by_contact[contact_row.relieved],
        k.by_contact[contact_row.of_stick],
    )
    for a in range(count):
        row, total = k.tangent_rows[k.stuck[a]], 0.0
        for j in range(k.n):
            total += abs(row[j]) * scale[j]
        pulls[a] = total
    for i in range(k.c):
        stick[i] = 0.0
    for a in range(count):
        for b in range(count):
            stick[k.stuck[a]] += abs(k.held[a, b]) * pulls[b]


@inline
def _values(k: Any, rows: Any, z: Any, out: Any) -> None:
    """Write the value of each surface, and the size of its terms."""
    c, lags = k.c, k.by_contact[contact_row.lags]
    state_forces(k, rows, z, k.by_contact[contact_row.press])
    for i in range(c):
        _, static, reference = friction_of(k, rows, i)
        direction = regime_value(k, rows, i, regime_constant.direction)
        pressing, lag = (k.by_contact[contact_row.press, i], direction * lags[i])
        of_press, of_lag = (
            k.by_contact[contact_row.of_press, i],
            k.by_contact[contact_row.of_lag, i],
        )
        if k.sliders[i] >= 0 and direction != 0.0:
            lag = slider_lag(k, rows, i, lag, z[k.n : 2 * k.n])
        at = 3 * (surface_number.pressing * c + i)
        out[at], out[at + 1] = pressing, of_press
        at = 3 * (surface_number.lag * c + i)
        out[at], out[at + 1] = lag, of_lag
        friction = sticking_friction(k, rows, i)
        of_friction = k.by_contact[contact_row.of_stick, i]
        of_friction += k.by_contact[contact_row.spring, i]
        for which in range(2):
            at, sign = 3 * ((surface_number.margin + which) * c + i), 1.0 - 2.0 * which
            out[at] = static * pressing - sign * friction
            out[at + 1] = abs(static) * of_press + of_friction
            if k.n_sorts > surface_number.before_end:
                knot = reference * regime_value(
                    k, rows, i, regime_constant.first_of_piece + 1 - which
                )
                at = 3 * ((surface_number.before_end + which) * c + i)
                out[at], out[at + 1] = lag - knot, of_lag + abs(knot)
            if k.n_sorts > surface_number.press_end:
                knot = press_knot(k, rows, i, which)
                at = 3 * ((surface_number.press_end + which) * c + i)
                out[at], out[at + 1] = pressing - knot, of_press + abs(knot)


@inline
def _output_values(k: Any, rows: Any, z: Any, sizes: Any, out: Any) -> None:
    """Write the value of each output, and the size of its terms."""
    n, c = k.n, k.c
    for i in range(c):
        closed = regime_value(k, rows, i, regime_constant.is_closed) > 0.0
        at = 6 * i
        out[at] = k.by_contact[contact_row.press, i] if closed else 0.0
        out[at + 1] = k.by_contact[contact_row.of_press, i]
        out[at + 3], out[at + 4] = (
            k.by_contact[contact_row.lags, i],
            k.by_contact[contact_row.of_lag, i],
        )
    for shape in range(k.n_shapes):
        value, size = 0.0, 0.0
        for j in range(n):
            value += k.shapes[shape, j] * z[j]
            size += abs(k.shapes[shape, j]) * sizes[j]
        out[6 * c + 3 * shape], out[6 * c + 3 * shape + 1] = value, size


@inline
def _sizes_of_springs(k: Any, rows: Any, sizes: Any, of_rates: bool) -> None:
    """Compute the sizes of friction by tangential springs in stick, or of its rates.

    Args:
        sizes: of the states.
    """
    for a in range(k.n_sliders):
        i = k.with_sliders[a]
        size = sizes[2 * k.n + a]
        if of_rates:
            size = time_unit(k, rows) * k.by_contact[contact_row.of_lag, i]
        size *= k.tangential_springs[i]
        k.by_contact[contact_row.spring, i] = size if is_stuck(k, rows, i) else 0.0


@inline
def gauge_state(k: Any, rows: Any, z: Any, sizes: Any, out: Any) -> None:
    """Write value, size of terms, and that of the rate's terms of each surface, then of outputs."""
    n, c, unit = k.n, k.c, time_unit(k, rows)
    n_surfaces = k.n_sorts * c
    of_q, of_v = sizes[:n], sizes[n : 2 * n]
    _sizes_of_contacts(k, rows, of_q, of_v, 1.0)
    _sizes_of_springs(k, rows, sizes, False)
    _sizes_of_rates(k, rows, of_q, of_v, 1.0, k.by_mode[mode_row.scale])
    _values(k, rows, z, out)
    _output_values(k, rows, z, sizes, out[3 * n_surfaces :])
    scale, rate = k.by_mode[mode_row.scale], k.by_mode[mode_row.rate]
    for a in range(k.counts[0]):
        i = k.stuck[a]
        for j in range(n):
            scale[j] += abs(k.drag_rows[i, j]) * k.by_contact[contact_row.of_stick, i]
    for j in range(n):
        rate[j], scale[j] = unit * of_v[j], unit * scale[j]
    _sizes_of_springs(k, rows, sizes, True)
    _sizes_of_contacts(k, rows, rate, scale, 0.0)
    if k.counts[0]:
        _sizes_of_rates(k, rows, rate, scale, 0.0, k.by_mode[mode_row.base])
    for i in range(c):
        _, static, _ = friction_of(k, rows, i)
        of_press, of_lag = (
            k.by_contact[contact_row.of_press, i],
            k.by_contact[contact_row.of_lag, i],
        )
        (
            out[3 * (surface_number.pressing * c + i) + 2],
            out[3 * (surface_number.lag * c + i) + 2],
        ) = of_press, of_lag
        for which in range(2):
            of_margin = abs(static) * of_press + k.by_contact[contact_row.of_stick, i]
            of_margin += k.by_contact[contact_row.spring, i]
            out[3 * ((surface_number.margin + which) * c + i) + 2] = of_margin
            if k.n_sorts > surface_number.before_end:
                out[3 * ((surface_number.before_end + which) * c + i) + 2] = of_lag
            if k.n_sorts > surface_number.press_end:
                out[3 * ((surface_number.press_end + which) * c + i) + 2] = of_press
