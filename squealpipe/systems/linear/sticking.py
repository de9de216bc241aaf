"""Friction of contacts that stick, T_S = −(t_Sᵀ M⁻¹ t_S)⁺ t_Sᵀ M⁻¹ (all other forces).

Invariant: the sticking points move with the belt to round-off, whatever S is. Where directions are
dependent the motion is still unique, and the forces are those of the least norm.

Cost: the inverse over the contacts S that stick is computed where a regime is entered; a switch
that changes S takes |S|³.
"""

import math
from typing import Any

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.linear.contact_numbers import contact_row, friction_of, is_stuck
from squealpipe.systems.linear.plan import mode_row
from squealpipe.systems.linear.products import add_row, dot

DEPENDENT = 1e-13
"""Share of its own mobility that a sticking direction must add to those before it.

Below it round-off decides; doubling it merges directions 1.4 times as far apart in angle.
"""


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
def stick_forces(k: Any, base: Any) -> None:
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
        add_row(k.drag_rows[i], k.by_contact[contact_row.stick, i], base)


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
    _, static, _ = friction_of(k, rows, i)
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
