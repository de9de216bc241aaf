"""Forces of contacts on a belt and accelerations at one state, by matrices.

A contact with a tangential spring (Jenkins) has a massless slider in series: the spring's stretch
is a state, which grows at the sliding speed while the slider sticks, is μN over its stiffness while
it slips, and 0 while the contact is open. Its slider sticks and slips by itself, so that nothing is
factorized.
"""

import math
from typing import Any

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.linear.contact_numbers import (
    contact_row,
    friction_of,
    is_stuck,
    line_of_press,
    regime_value,
    stiffness_of,
    time_unit,
)
from squealpipe.systems.linear.matrices import friction_number, regime_constant
from squealpipe.systems.linear.numbering import surface_number
from squealpipe.systems.linear.plan import mode_row, parameter_row
from squealpipe.systems.linear.products import (
    add_columns,
    add_product,
    dot,
    write_columns,
)
from squealpipe.systems.linear.sticking import add_stick, stick_forces
from squealpipe.systems.taylor.lanes import call


@part
def coefficient(k: Any, rows: Any, i: int, speed: float) -> Any:
    """Return μ at a sliding speed of a contact in its regime."""
    mu, static, reference = friction_of(k, rows, i)
    lag = regime_value(k, rows, i, regime_constant.direction) * speed
    law = k.laws[i]
    if law == friction_number.exponential:
        return mu + (static - mu) * math.exp(-lag / reference)
    if law == friction_number.hyperbolic:
        return mu + (static - mu) * reference / (reference + lag)
    if law == friction_number.table:
        at = lag / reference - regime_value(k, rows, i, regime_constant.first_of_piece)
        value = 0.0
        for power in range(3, -1, -1):
            value = value * at + regime_value(
                k, rows, i, regime_constant.first_of_piece + 2 + power
            )
        return mu * value
    return mu


@part
def stretch_per_force(k: Any, rows: Any, i: int) -> Any:
    """Return by how much slip stretches a tangential spring for each newton of normal force."""
    mu, _, _ = friction_of(k, rows, i)
    return mu / k.tangential_springs[i]


@part
def rate_of_force(k: Any, rows: Any, i: int, v: Any) -> Any:
    """Return the rate of the normal force of a contact that is closed, N/s."""
    return -stiffness_of(k, rows, i) * dot(k.normal_rows[i], v)


@part
def slider_lag(k: Any, rows: Any, i: int, lag: float, v: Any) -> Any:
    """Return by how much the slider of a tangential spring lags behind the belt where it slips.

    The spring follows its force μN, so that the slider is faster than the contact by μṄ/k.

    Args:
        lag: that of the contact.
    """
    return lag - stretch_per_force(k, rows, i) * rate_of_force(k, rows, i, v)


@part
def sticking_friction(k: Any, rows: Any, i: int) -> Any:
    """Return the friction of a contact that sticks: what holds it, or its tangential spring."""
    if k.sliders[i] >= 0 and is_stuck(k, rows, i):
        return k.by_contact[contact_row.slip, i]
    return k.by_contact[contact_row.stick, i]


@inline
def state_forces(k: Any, rows: Any, z: Any, pressing: Any) -> None:
    """Call :func:`write_forces` by its address: LLVM would copy it into each of seven callers."""
    call(k.forces, (rows.ctypes.data, z.ctypes.data, pressing.ctypes.data))


@inline
def write_forces(k: Any, rows: Any, z: Any, pressing: Any) -> None:
    """Compute forces at a state: the work by contact, and accelerations without those of stick."""
    n, c = k.n, k.c
    q, v = z[:n], z[n : 2 * n]
    lags, base, preload = (
        k.by_contact[contact_row.lags],
        k.by_mode[mode_row.base],
        rows[parameter_row.preload, 0],
    )
    write_columns(k.normals, q, pressing)
    write_columns(k.tangentials, v, lags)
    for j in range(n):
        base[j] = k.load[j] * (preload if k.balanced else 1.0)
    add_product(k.pull_back, k.full_stiffness, q, base)
    add_product(k.drag_back, k.full_damping, v, base)
    relieved, slip = k.by_contact[contact_row.relieved], k.by_contact[contact_row.slip]
    for i in range(c):
        lift = pressing[i]
        pressing[i] = k.preloads[i] * preload - k.springs[i] * lift
        lags[i] = k.speeds[i] * rows[parameter_row.belt, 0] - lags[i]
        closed = regime_value(k, rows, i, regime_constant.is_closed) > 0.0
        relieved[i] = k.preloads[i] * preload if closed else k.springs[i] * lift
        if k.n_tables and k.press_counts[i] > 1:
            stiffness, at_rest = line_of_press(k, rows, i)
            pressing[i] = at_rest - stiffness * lift
            if closed:
                relieved[i] = at_rest + (k.springs[i] - stiffness) * lift
        direction, slip[i] = regime_value(k, rows, i, regime_constant.direction), 0.0
        if closed and direction != 0.0:
            slip[i] = direction * pressing[i] * coefficient(k, rows, i, lags[i])
        if k.sliders[i] >= 0 and is_stuck(k, rows, i):
            slip[i] = k.tangential_springs[i] * z[k.sliders[i]]
    add_columns(k.push_rows, relieved, base)
    add_columns(k.drag_rows, slip, base)
    stick_forces(k, base)


@part
def exact_ends(k: Any, rows: Any, z: Any, exact: Any) -> None:
    """Write rates, surfaces and outputs at a state, where friction depends on the speed."""
    n, c, unit = k.n, k.c, time_unit(k, rows)
    pressing = k.by_contact[contact_row.of_press]
    state_forces(k, rows, z, pressing)
    for i in range(c):
        _, static, _ = friction_of(k, rows, i)
        limit, friction = static * pressing[i], sticking_friction(k, rows, i)
        exact[k.n_states + surface_number.margin * c + i, 0] = limit - friction
        exact[k.n_states + surface_number.margin_back * c + i, 0] = limit + friction
    add_stick(k, k.by_mode[mode_row.base])
    for j in range(n):
        exact[n + j, 0] = unit * k.by_mode[mode_row.base, j]
