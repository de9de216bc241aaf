"""Equations of motion of contacts on a belt by their matrices, at one state or as Taylor series.

Idea: in every regime the motion is M⁻¹ times matrices that do not change, so the orders of its
series are matrix products: lifts nᵀq and sliding speeds tᵀq̇ of all contacts, forces by their
regimes, and back. Friction in stick is T_S = −(t_Sᵀ M⁻¹ t_S)⁺ t_Sᵀ M⁻¹ (all other forces); the
inverse over the contacts S that stick is computed where a regime is entered. A contact with a
tangential spring (Jenkins) has a massless slider in series: the spring's stretch is a state, which
grows at the sliding speed while the slider sticks, is μN over its stiffness while it slips, and 0
while the contact is open. Its slider sticks and slips by itself, so that nothing is factorized.

Invariant: the sticking points move with the belt to round-off, whatever S is. Where directions are
dependent the motion is still unique, and the forces are those of the least norm.

Cost: an order takes four products of n × c numbers; a switch that changes S takes |S|³.
"""

import math
from typing import Any, NamedTuple

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.linear.matrices import (
    FIRST_OF_PRESS,
    friction_number,
    regime_constant,
)
from squealpipe.systems.linear.numbering import (
    OF_CONTACT,
    event_number,
    surface_number,
    switch_number,
)
from squealpipe.systems.linear.plan import mode_row, parameter_row
from squealpipe.systems.taylor.simd import ROW, fma, load, splat, store


class ContactRows(NamedTuple):
    """Rows of the work by contact."""

    lags: int = 0
    relieved: int = 1
    slip: int = 2
    stick: int = 3
    of_press: int = 4
    of_lag: int = 5
    of_stick: int = 6
    closed: int = 7
    side: int = 8
    limit: int = 9
    drag: int = 10
    press: int = 11
    spring: int = 12


contact_row = ContactRows()

DEPENDENT = 1e-13
"""Share of its own mobility that a sticking direction must add to those before it.

Below it round-off decides; doubling it merges directions 1.4 times as far apart in angle.
"""


@inline
def _constant(k: Any, rows: Any, contact: int, which: int) -> Any:
    """Return a constant of a contact's regime."""
    return rows[
        parameter_row.coefficients + OF_CONTACT * k.c + 1 + contact * k.width + which, 0
    ]


@inline
def is_stuck(k: Any, rows: Any, contact: int) -> Any:
    """Tell whether a contact, or the slider of its tangential spring, moves with the belt."""
    return _constant(k, rows, contact, regime_constant.is_stuck) > 0.0


@part
def _coefficients(k: Any, rows: Any, i: int) -> Any:
    """Return μ, the coefficient of static friction and the reference speed of a contact."""
    at = parameter_row.coefficients + OF_CONTACT * i
    return rows[at, 0], rows[at + 1, 0], rows[at + 2, 0]


@inline
def _unit(k: Any, rows: Any) -> Any:
    """Return the unit of time."""
    return rows[parameter_row.coefficients + OF_CONTACT * k.c, 0]


@part
def _line(k: Any, rows: Any, i: int) -> Any:
    """Return the stiffness of a contact's piece of a table, and the piece's force where nᵀq = 0."""
    start, c0 = (
        _constant(k, rows, i, FIRST_OF_PRESS),
        _constant(k, rows, i, FIRST_OF_PRESS + 2),
    )
    stiffness = _constant(k, rows, i, FIRST_OF_PRESS + 3)
    at_rest = rows[parameter_row.coefficients + OF_CONTACT * i + 3, 0]
    return stiffness, c0 + stiffness * (at_rest - start)


@part
def _press_knot(k: Any, rows: Any, i: int, which: int) -> Any:
    """Return the force at the end (0) or the start (1) of a contact's piece of a table."""
    start, end = (
        _constant(k, rows, i, FIRST_OF_PRESS),
        _constant(k, rows, i, FIRST_OF_PRESS + 1),
    )
    c0 = _constant(k, rows, i, FIRST_OF_PRESS + 2)
    if which:
        return c0
    return c0 + _constant(k, rows, i, FIRST_OF_PRESS + 3) * (end - start)


@part
def regimes_of_press(k: Any, i: int) -> Any:
    """Return the number of regimes of a contact in one piece of its table of contact."""
    return (k.first[0, i + 1] - k.first[0, i] - 1) // k.press_counts[i]


@part
def press_of_force(k: Any, i: int, force: float) -> Any:
    """Return the piece of a table of contact, by the force that its first piece would have."""
    count, piece = k.press_counts[i], 0
    if count == 1:
        return 0
    first, step = k.first[0, i], regimes_of_press(k, i)
    compression = force / k.table[first, FIRST_OF_PRESS + 3]
    while (
        piece + 1 < count
        and k.table[first + (piece + 1) * step, FIRST_OF_PRESS] <= compression
    ):
        piece += 1
    return piece


@part
def _press_of_regime(k: Any, rows: Any, i: int) -> Any:
    """Return the piece of a table of contact in which a contact is."""
    count, piece = k.press_counts[i], 0
    if count == 1:
        return 0
    first, step = k.first[0, i], regimes_of_press(k, i)
    start = _constant(k, rows, i, FIRST_OF_PRESS)
    while piece + 1 < count and k.table[first + piece * step, FIRST_OF_PRESS] != start:
        piece += 1
    return piece


@part
def _write_columns(matrix: Any, by: Any, total: Any) -> None:
    """Write Σ_j matrix[j] by[j], sixteen columns at a time in registers, in a fixed order.

    Args:
        matrix: (rows, padded columns), aligned as in :mod:`.plan`.
        total: (padded columns), aligned.
    """
    to = total.ctypes.data
    for place in range(0, 8 * matrix.shape[1], ROW):
        store(to + place, _sum_of_rows(matrix, by, place))


@part
def _add_columns(matrix: Any, by: Any, total: Any) -> None:
    """Add the same."""
    to = total.ctypes.data
    for place in range(0, 8 * matrix.shape[1], ROW):
        store(to + place, load(to + place) + _sum_of_rows(matrix, by, place))


@inline
def _sum_of_rows(matrix: Any, by: Any, place: int) -> Any:
    """Return Σ_j matrix[j] by[j] of some columns, by the offset of their first in bytes."""
    count, width = matrix.shape
    row, stride = matrix.ctypes.data + place, 8 * width
    # two sums, so that one addition need not wait for the other
    even, odd = splat(0.0), splat(0.0)
    for j in range(0, count - 1, 2):
        even = fma(load(row), splat(by[j]), even)
        odd = fma(load(row + stride), splat(by[j + 1]), odd)
        row += 2 * stride
    if count % 2:
        even = fma(load(row), splat(by[count - 1]), even)
    return even + odd


@part
def _add_listed(matrix: Any, places: Any, count: int, by: Any, total: Any) -> None:
    """Add Σ_a matrix[places[a]] by[places[a]], likewise."""
    at, to, stride = matrix.ctypes.data, total.ctypes.data, 8 * matrix.shape[1]
    for place in range(0, stride, ROW):
        even, odd = load(to + place), splat(0.0)
        for a in range(0, count - 1, 2):
            i, j = places[a], places[a + 1]
            even = fma(load(at + i * stride + place), splat(by[i]), even)
            odd = fma(load(at + j * stride + place), splat(by[j]), odd)
        if count % 2:
            i = places[count - 1]
            even = fma(load(at + i * stride + place), splat(by[i]), even)
        store(to + place, even + odd)


@inline
def _copy(numbers: Any, to: Any) -> None:
    """Write numbers into an array; places that are sums would be looked at for a sign each."""
    for i in range(to.size):
        to[i] = numbers[i]


@part
def _add_row(row: Any, factor: float, total: Any) -> None:
    for j in range(row.size):
        total[j] += row[j] * factor


@part
def _add_sizes(matrix: Any, by: Any, total: Any) -> None:
    """Add Σ_j |matrix[j]| by[j], four rows at a time."""
    n, c = matrix.shape
    j = 0
    while j + 4 <= n:
        a, b, d, e = matrix[j], matrix[j + 1], matrix[j + 2], matrix[j + 3]
        x, y, z, w = by[j], by[j + 1], by[j + 2], by[j + 3]
        for i in range(c):
            total[i] += (abs(a[i]) * x + abs(b[i]) * y) + (
                abs(d[i]) * z + abs(e[i]) * w
            )
        j += 4
    while j < n:
        a, x = matrix[j], by[j]
        for i in range(c):
            total[i] += abs(a[i]) * x
        j += 1


@part
def dot(a: Any, b: Any) -> Any:
    """Return a scalar product over the length of the first, its four sums in a fixed order."""
    n = a.size
    s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0
    j = 0
    while j + 4 <= n:
        s0 += a[j] * b[j]
        s1 += a[j + 1] * b[j + 1]
        s2 += a[j + 2] * b[j + 2]
        s3 += a[j + 3] * b[j + 3]
        j += 4
    while j < n:
        s0 += a[j] * b[j]
        j += 1
    return (s0 + s1) + (s2 + s3)


@part
def _add_product(matrix: Any, full: int, by: Any, total: Any) -> None:
    """Add a product with a matrix, which is transposed, or with a diagonal."""
    if full:
        _add_columns(matrix, by, total)
    else:
        diagonal = matrix[0]
        for i in range(by.size):
            total[i] += diagonal[i] * by[i]


@part
def coefficient(k: Any, rows: Any, i: int, speed: float) -> Any:
    """Return μ at a sliding speed of a contact in its regime."""
    mu, static, reference = _coefficients(k, rows, i)
    lag = _constant(k, rows, i, regime_constant.direction) * speed
    law = k.laws[i]
    if law == friction_number.exponential:
        return mu + (static - mu) * math.exp(-lag / reference)
    if law == friction_number.hyperbolic:
        return mu + (static - mu) * reference / (reference + lag)
    if law == friction_number.table:
        at = lag / reference - _constant(k, rows, i, regime_constant.first_of_piece)
        value = 0.0
        for power in range(3, -1, -1):
            value = value * at + _constant(
                k, rows, i, regime_constant.first_of_piece + 2 + power
            )
        return mu * value
    return mu


@part
def _stiffness(k: Any, rows: Any, i: int) -> Any:
    """Return the stiffness of a contact in its piece of a table."""
    stiffness = k.springs[i]
    if k.n_tables and k.press_counts[i] > 1:
        stiffness, _ = _line(k, rows, i)
    return stiffness


@part
def _spring_per_force(k: Any, rows: Any, i: int) -> Any:
    """Return by how much slip stretches a tangential spring for each newton of normal force."""
    mu, _, _ = _coefficients(k, rows, i)
    return mu / k.tangential_springs[i]


@part
def rate_of_force(k: Any, rows: Any, i: int, v: Any) -> Any:
    """Return the rate of the normal force of a contact that is closed, N/s."""
    return -_stiffness(k, rows, i) * dot(k.normal_rows[i], v)


@part
def slider_lag(k: Any, rows: Any, i: int, lag: float, v: Any) -> Any:
    """Return by how much the slider of a tangential spring lags behind the belt where it slips.

    The spring follows its force μN, so that the slider is faster than the contact by μṄ/k.

    Args:
        lag: that of the contact.
    """
    return lag - _spring_per_force(k, rows, i) * rate_of_force(k, rows, i, v)


@part
def _sticking_friction(k: Any, rows: Any, i: int) -> Any:
    """Return the friction of a contact that sticks: what holds it, or its tangential spring."""
    if k.sliders[i] >= 0 and is_stuck(k, rows, i):
        return k.by_contact[contact_row.slip, i]
    return k.by_contact[contact_row.stick, i]


@part
def settle_stick(k: Any, rows: Any) -> None:
    """Factorize the mobility of the contacts that stick, where they are others than before."""
    count, same = 0, True
    for i in range(k.c):
        if k.sliders[i] < 0 and is_stuck(k, rows, i):
            same = same and count < k.counts[0] and k.stuck[count] == i
            k.stuck[count] = i
            count += 1
    if same and count == k.counts[0]:
        return
    k.counts[0] = count
    lower, gram, half = k.factor[0], k.factor[1], k.factor[2]
    for a in range(count):
        for b in range(count):
            gram[a, b] = k.mobility[k.stuck[a], k.stuck[b]]
    rank = _pivoted_cholesky(gram, lower, count)
    k.counts[1] = count - rank
    if rank == count:
        _inverse_of(lower, half, k.held, count)
        return
    # G⁺ = L (LᵀL)⁻² Lᵀ for G = L Lᵀ with L of full column rank
    _multiply(lower, lower, gram, count, rank, rank, True)
    _pivoted_cholesky(gram, half, rank)
    _inverse_of(half, k.held, gram, rank)
    _multiply(lower, gram, half, rank, count, rank, False)
    for i in range(count):
        for j in range(count):
            k.held[i, j] = dot(half[i, :rank], half[j, :rank])


@part
def _multiply(
    a: Any, b: Any, product: Any, inner: int, rows: int, columns: int, turned: bool
) -> None:
    """Write a b, or aᵀb, of the first rows and columns."""
    for i in range(rows):
        product[i, :columns] = 0.0
        for m in range(inner):
            factor = a[m, i] if turned else a[i, m]
            for j in range(columns):
                product[i, j] += factor * b[m, j]


@part
def _pivoted_cholesky(matrix: Any, lower: Any, size: int) -> Any:
    """Factorize a semidefinite matrix L Lᵀ, the largest of what is left first; return the rank.

    Rows of L stay in the order of the matrix, whose diagonal and columns are used up.
    """
    for i in range(size):
        lower[i, :size] = 0.0
    for rank in range(size):
        pivot, best = -1, DEPENDENT
        for i in range(size):
            used = 0.0
            for a in range(rank):
                used += lower[i, a] ** 2
            whole = matrix[i, i]
            if whole > 0.0 and (whole - used) / whole > best:
                pivot, best = i, (whole - used) / whole
        if pivot < 0:
            return rank
        root = math.sqrt(best * matrix[pivot, pivot])
        for i in range(size):
            value = matrix[i, pivot]
            for a in range(rank):
                value -= lower[i, a] * lower[pivot, a]
            lower[i, rank] = value / root
        # rows that went before stay as they are: theirs is round-off
    return size


@part
def _inverse_of(lower: Any, work: Any, inverse: Any, size: int) -> None:
    """Invert L Lᵀ of full rank; L is a triangle whose rows are permuted."""
    for i in range(size):
        for j in range(size):
            work[i, j], inverse[i, j] = lower[i, j], 1.0 if i == j else 0.0
    for column in range(size):
        _eliminate(work, inverse, column, size)
    # (L Lᵀ)⁻¹ = L⁻ᵀ L⁻¹
    for i in range(size):
        for j in range(size):
            work[i, j] = inverse[i, j]
    _multiply(work, work, inverse, size, size, size, True)


@part
def _eliminate(work: Any, inverse: Any, column: int, size: int) -> None:
    """Do a step of Gauss and Jordan, by the largest entry of a column that is left."""
    pivot = column
    for i in range(column + 1, size):
        if abs(work[i, column]) > abs(work[pivot, column]):
            pivot = i
    scale = 1.0 / work[pivot, column]
    for j in range(size):
        first, other = work[column, j], inverse[column, j]
        work[column, j], inverse[column, j] = (
            scale * work[pivot, j],
            scale * inverse[pivot, j],
        )
        if pivot != column:
            work[pivot, j], inverse[pivot, j] = first, other
    for i in range(size):
        factor = work[i, column]
        if i != column and factor != 0.0:
            for j in range(size):
                work[i, j] -= factor * work[column, j]
                inverse[i, j] -= factor * inverse[column, j]


@part
def state_forces(k: Any, rows: Any, z: Any, pressing: Any) -> None:
    """Compute forces at a state: the work by contact, and accelerations without those of stick."""
    n, c = k.n, k.c
    q, v = z[:n], z[n : 2 * n]
    lags, base, preload = (
        k.by_contact[contact_row.lags],
        k.by_mode[mode_row.base],
        rows[parameter_row.preload, 0],
    )
    _write_columns(k.normals, q, pressing)
    _write_columns(k.tangentials, v, lags)
    for j in range(n):
        base[j] = k.load[j] * (preload if k.balanced else 1.0)
    _add_product(k.pull_back, k.full_stiffness, q, base)
    _add_product(k.drag_back, k.full_damping, v, base)
    relieved, slip = k.by_contact[contact_row.relieved], k.by_contact[contact_row.slip]
    for i in range(c):
        lift = pressing[i]
        pressing[i] = k.preloads[i] * preload - k.springs[i] * lift
        lags[i] = k.speeds[i] * rows[parameter_row.belt, 0] - lags[i]
        closed = _constant(k, rows, i, regime_constant.is_closed) > 0.0
        relieved[i] = k.preloads[i] * preload if closed else k.springs[i] * lift
        if k.n_tables and k.press_counts[i] > 1:
            stiffness, at_rest = _line(k, rows, i)
            pressing[i] = at_rest - stiffness * lift
            if closed:
                relieved[i] = at_rest + (k.springs[i] - stiffness) * lift
        direction, slip[i] = _constant(k, rows, i, regime_constant.direction), 0.0
        if closed and direction != 0.0:
            slip[i] = direction * pressing[i] * coefficient(k, rows, i, lags[i])
        if k.sliders[i] >= 0 and is_stuck(k, rows, i):
            slip[i] = k.tangential_springs[i] * z[k.sliders[i]]
    _add_columns(k.push_rows, relieved, base)
    _add_columns(k.drag_rows, slip, base)
    _stick_forces(k, base)


@part
def _stick_forces(k: Any, base: Any) -> None:
    """Compute the friction of the contacts that stick from all other accelerations."""
    count, stick, pulls = (
        k.counts[0],
        k.by_contact[contact_row.stick],
        k.by_contact[contact_row.relieved],
    )
    for a in range(count):
        pulls[a] = dot(k.tangent_rows[k.stuck[a]], base)
    for i in range(k.c):
        stick[i] = 0.0
    for a in range(count):
        stick[k.stuck[a]] = -dot(k.held[a, :count], pulls[:count])


@part
def add_stick(k: Any, base: Any) -> None:
    """Add the accelerations by the friction of the contacts that stick."""
    for a in range(k.counts[0]):
        i = k.stuck[a]
        _add_row(k.drag_rows[i], k.by_contact[contact_row.stick, i], base)


@part
def holding(k: Any, i: int) -> Any:
    """Return the friction that would keep a contact on the belt, others staying as they are.

    Forces at the state must have been computed. What slip friction lacks to it is the acceleration
    that is left, over the mobility with the contacts held that stick. A direction that these hold
    already needs no friction more.
    """
    count, held = k.counts[0], k.by_contact[contact_row.relieved]
    friction = k.by_contact[contact_row.slip, i] + k.by_contact[contact_row.stick, i]
    for a in range(count):
        if k.stuck[a] == i:
            return friction
    whole = k.mobility[i, i]
    mobility, acceleration = whole, dot(k.tangent_rows[i], k.by_mode[mode_row.base])
    for a in range(count):
        held[a] = k.mobility[i, k.stuck[a]]
    for a in range(count):
        mobility -= held[a] * dot(k.held[a, :count], held[:count])
        acceleration += held[a] * k.by_contact[contact_row.stick, k.stuck[a]]
    if mobility <= DEPENDENT * whole:
        return friction
    return friction - acceleration / mobility


@part
def holds(k: Any, rows: Any, i: int, pressing: float) -> Any:
    """Tell whether friction can keep a contact on the belt."""
    _, static, _ = _coefficients(k, rows, i)
    return limit_left(static * pressing, holding(k, i), k.hidden[0]) >= 0.0


@inline
def limit_left(limit: Any, friction: Any, hidden: Any) -> Any:
    """Return the square that the limit of friction leaves above what holds a contact, N².

    Args:
        hidden: friction force that round-off hides, N.
    """
    # where another contact has just slipped, the friction that is needed may be the limit itself:
    # without a share for round-off such a contact would turn back for ever in one instant
    return ((1.0 + 1e-13) * limit) ** 2 + hidden**2 - friction**2


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
    _add_sizes(k.normals, of_q, press)
    _add_sizes(k.tangentials, of_v, lag)
    preload, belt = (
        constant * abs(rows[parameter_row.preload, 0]),
        constant * abs(rows[parameter_row.belt, 0]),
    )
    for i in range(k.c):
        if k.n_tables and k.press_counts[i] > 1:
            stiffness, _ = _line(k, rows, i)
            at_rest = abs(rows[parameter_row.coefficients + OF_CONTACT * i + 3, 0])
            at_rest += abs(_constant(k, rows, i, FIRST_OF_PRESS))
            fixed = abs(_constant(k, rows, i, FIRST_OF_PRESS + 2)) + stiffness * at_rest
            press[i] = constant * fixed + stiffness * press[i]
        else:
            press[i] = abs(k.preloads[i]) * preload + k.springs[i] * press[i]
        lag[i] += abs(k.speeds[i]) * belt
    for a in range(k.n_sliders):
        i = k.with_sliders[a]
        if _constant(k, rows, i, regime_constant.direction) != 0.0:
            size = 0.0
            for j in range(k.n):
                size += abs(k.normal_rows[i, j]) * of_v[j]
            lag[i] += _spring_per_force(k, rows, i) * _stiffness(k, rows, i) * size


@part
def _sizes_of_products(matrix: Any, full: int, by: Any, total: Any) -> None:
    """Add the sizes of a matrix, or a diagonal, times a vector."""
    if full:
        _add_sizes(matrix, by, total)
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
        closed = _constant(k, rows, i, regime_constant.is_closed) > 0.0
        force[i] = abs(k.preloads[i]) * preload if closed else press[i]
        if k.n_tables and k.press_counts[i] > 1:
            stiffness, _ = _line(k, rows, i)
            force[i] = press[i] * (1.0 + k.springs[i] / stiffness)
    _add_sizes(k.push_rows, force, scale)
    for i in range(k.c):
        mu, static, _ = _coefficients(k, rows, i)
        slips = _constant(k, rows, i, regime_constant.direction) != 0.0
        force[i] = max(abs(mu), abs(static)) * press[i] if slips else 0.0
        force[i] += k.by_contact[contact_row.spring, i]
    _add_sizes(k.drag_rows, force, scale)
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
        _, static, reference = _coefficients(k, rows, i)
        direction = _constant(k, rows, i, regime_constant.direction)
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
        friction = _sticking_friction(k, rows, i)
        of_friction = k.by_contact[contact_row.of_stick, i]
        of_friction += k.by_contact[contact_row.spring, i]
        for which in range(2):
            at, sign = 3 * ((surface_number.margin + which) * c + i), 1.0 - 2.0 * which
            out[at] = static * pressing - sign * friction
            out[at + 1] = abs(static) * of_press + of_friction
            if k.n_sorts > surface_number.before_end:
                knot = reference * _constant(
                    k, rows, i, regime_constant.first_of_piece + 1 - which
                )
                at = 3 * ((surface_number.before_end + which) * c + i)
                out[at], out[at + 1] = lag - knot, of_lag + abs(knot)
            if k.n_sorts > surface_number.press_end:
                knot = _press_knot(k, rows, i, which)
                at = 3 * ((surface_number.press_end + which) * c + i)
                out[at], out[at + 1] = pressing - knot, of_press + abs(knot)


@inline
def _output_values(k: Any, rows: Any, z: Any, sizes: Any, out: Any) -> None:
    """Write the value of each output, and the size of its terms."""
    n, c = k.n, k.c
    for i in range(c):
        closed = _constant(k, rows, i, regime_constant.is_closed) > 0.0
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
            size = _unit(k, rows) * k.by_contact[contact_row.of_lag, i]
        size *= k.tangential_springs[i]
        k.by_contact[contact_row.spring, i] = size if is_stuck(k, rows, i) else 0.0


@inline
def gauge_state(k: Any, rows: Any, z: Any, sizes: Any, out: Any) -> None:
    """Write value, size of terms, and that of the rate's terms of each surface, then of outputs."""
    n, c, unit = k.n, k.c, _unit(k, rows)
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
        _, static, _ = _coefficients(k, rows, i)
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


@part
def slip_regime(k: Any, rows: Any, i: int, speed: float, press: int) -> Any:
    """Return the regime of slip, among those of a contact, by the sliding speed.

    Args:
        press: piece of its table of contact.
    """
    _, _, reference = _coefficients(k, rows, i)
    side, count = 0 if speed >= 0.0 else 1, regimes_of_press(k, i)
    first = k.first[0, i] + press * count
    piece = count // 2 - 1
    while (
        piece > 0
        and abs(speed)
        - reference * k.table[first + 2 * piece, regime_constant.first_of_piece]
        < 0.0
    ):
        piece -= 1
    return press * count + 2 * piece + side


@part
def _change_slider(k: Any, rows: Any, which: int, z: Any, block: int) -> Any:
    """Return regime, kind of the event, and stretch after a switch of a contact with a slider.

    What slips has a spring at its limit of friction, what lands has a relaxed one.

    Args:
        block: first regime of the contact's piece of its table of contact.
    """
    what, i = k.switches[which, 0], k.switches[which, 1]
    spring, stick = k.tangential_springs[i], regimes_of_press(k, i) - 1
    if what == switch_number.separation:
        return k.first[0, i + 1] - k.first[0, i] - 1, event_number.separates, 0.0
    if what == switch_number.reversal:
        return block + stick, event_number.sticks, z[k.sliders[i]]
    pressing, v = k.by_contact[contact_row.of_press], z[k.n : 2 * k.n]
    state_forces(k, rows, z, pressing)
    if what == switch_number.contact:
        # just after, forces grow in proportion to the time; the static limit is not passed before
        lag = k.by_contact[contact_row.lags, i]
        _, static, _ = _coefficients(k, rows, i)
        if spring * abs(lag) <= static * rate_of_force(k, rows, i, v):
            return stick, event_number.lands, 0.0
        return slip_regime(k, rows, i, lag, 0), event_number.lands, 0.0
    back = what == switch_number.slips_back
    limit = _spring_per_force(k, rows, i) * pressing[i]
    return block + back, event_number.slips_away, -limit if back else limit


@inline
def change_state(k: Any, rows: Any, which: int, z: Any, out: Any) -> None:
    """Write the regime that a switch enters, the kind of the event, and the state after it."""
    what, i, target = k.switches[which, 0], k.switches[which, 1], k.switches[which, 2]
    n, first = k.n, k.first[0, i]
    count = regimes_of_press(k, i)
    block = count * _press_of_regime(k, rows, i)
    after = out[2 : 2 + k.n_states]
    for j in range(k.n_states):
        after[j] = z[j]
    if k.sliders[i] >= 0 and what != switch_number.knot:
        regime, kind, after[k.sliders[i]] = _change_slider(k, rows, which, z, block)
        out[0], out[1] = float(first + regime), float(k.first[1, i] + kind)
        return
    regime, kind = 0, event_number.lands
    if what == switch_number.separation:
        regime, kind = k.first[0, i + 1] - first - 1, event_number.separates
    elif what == switch_number.knot:
        regime, kind = target - first, event_number.passes
    elif what == switch_number.slips or (
        what != switch_number.contact and what != switch_number.reversal
    ):
        regime, kind = (
            block + (0 if what == switch_number.slips else 1),
            event_number.slips_away,
        )
    else:
        # values go where nothing is read any more
        pressing = k.by_contact[contact_row.of_press]
        state_forces(k, rows, z, pressing)
        speed = k.by_contact[contact_row.lags, i]
        if what == switch_number.contact:
            regime = slip_regime(k, rows, i, speed, 0)
        else:
            for j in range(n):
                after[n + j] += k.drag_rows[i, j] / k.mobility[i, i] * speed
            regime, kind = block, event_number.reverses
            if holds(k, rows, i, pressing[i]):
                regime, kind = block + count - 1, event_number.sticks
            elif _constant(k, rows, i, regime_constant.direction) >= 0.0:
                regime = block + 1
    out[0], out[1] = float(first + regime), float(k.first[1, i] + kind)


@inline
def _list_forces(k: Any, rows: Any) -> None:
    """Note what the regimes make of each contact, and which contacts push and slip.

    A closed contact's spring is in the stiffness: it pushes at order 0 alone, by its preload, but
    for a piece of a table that is not as stiff.
    """
    opened, slipping = 0, 0
    for i in range(k.c):
        closed = _constant(k, rows, i, regime_constant.is_closed) > 0.0
        direction = _constant(k, rows, i, regime_constant.direction)
        mu, static, _ = _coefficients(k, rows, i)
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
    _write_columns(k.normals, q, pressing)
    _write_columns(k.tangentials, v, slides)
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
    _copy(pressing, row[at : at + c])
    _copy(lags, row[at + c : at + 2 * c])
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
        stiffness, at_rest = _line(k, rows, i)
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
                row[place] = _unit(k, rows) / order * lag
            friction = spring * row[place]
            k.by_contact[contact_row.slip, i] = friction
            _, static, _ = _coefficients(k, rows, i)
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
        _, _, reference = _coefficients(k, rows, i)
        for which in range(2):
            knot = reference * _constant(
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
                    row[place] -= _press_knot(k, rows, i, which)


@inline
def _stick_at_order(k: Any, row: Any) -> None:
    """Compute an order of the friction of the contacts that stick, and what it lacks to slip."""
    first, c = k.n_states, k.c
    _stick_forces(k, k.by_mode[mode_row.base])
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
        _add_columns(
            k.pull_back, k.by_mode[mode_row.place, : k.n], k.by_mode[mode_row.base]
        )
    if k.full_damping:
        _add_columns(
            k.drag_back, k.by_mode[mode_row.speed, : k.n], k.by_mode[mode_row.base]
        )


@inline
def series(k: Any, rows: Any, mem: Any) -> None:
    """Compute the Taylor coefficients of states, surfaces and outputs, order after order.

    Args:
        mem: (orders, series): states, whose order 0 is given, surfaces and outputs.
    """
    terms, n, unit, base = mem.shape[0], k.n, _unit(k, rows), k.by_mode[mode_row.base]
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
            _add_row(
                k.load, rows[parameter_row.preload, 0] if k.balanced else 1.0, base
            )
            _add_columns(k.push_rows, k.by_contact[contact_row.relieved], base)
        else:
            _add_listed(
                k.push_rows,
                k.lists[0],
                k.counts[2],
                k.by_contact[contact_row.relieved],
                base,
            )
        _add_listed(
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
            _copy(q, later[:n])
            _copy(v, later[n : 2 * n])


@part
def _slip_order(k: Any, rows: Any, mem: Any, i: int, order: int) -> Any:
    """Return an order of μ(|w|) N, of a law that depends on the speed."""
    mu, static, reference = _coefficients(k, rows, i)
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
    shifted[order, i] = speed - constant * _constant(k, rows, i, at)
    inner[order, i] = _constant(k, rows, i, at + 5) * shifted[order, i]
    inner[order, i] += constant * _constant(k, rows, i, at + 4)
    value = constant * _constant(k, rows, i, at + 3)
    for j in range(order + 1):
        value += shifted[j, i] * inner[order - j, i]
    middle[order, i] = value
    value = constant * _constant(k, rows, i, at + 2)
    for j in range(order + 1):
        value += shifted[j, i] * middle[order - j, i]
    s[order, i] = value


@part
def exact_ends(k: Any, rows: Any, z: Any, exact: Any) -> None:
    """Write rates, surfaces and outputs at a state, where friction depends on the speed."""
    n, c, unit = k.n, k.c, _unit(k, rows)
    pressing = k.by_contact[contact_row.of_press]
    state_forces(k, rows, z, pressing)
    for i in range(c):
        _, static, _ = _coefficients(k, rows, i)
        limit, friction = static * pressing[i], _sticking_friction(k, rows, i)
        exact[k.n_states + surface_number.margin * c + i, 0] = limit - friction
        exact[k.n_states + surface_number.margin_back * c + i, 0] = limit + friction
    add_stick(k, k.by_mode[mode_row.base])
    for j in range(n):
        exact[n + j, 0] = unit * k.by_mode[mode_row.base, j]
