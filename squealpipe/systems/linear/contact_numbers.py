"""Numbers of each contact: what its regime, its law and its piece of a table say."""

from typing import Any, NamedTuple

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.linear.matrices import FIRST_OF_PRESS, regime_constant
from squealpipe.systems.linear.numbering import OF_CONTACT
from squealpipe.systems.linear.plan import parameter_row


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


@inline
def regime_value(k: Any, rows: Any, contact: int, which: int) -> Any:
    """Return a constant of a contact's regime."""
    return rows[
        parameter_row.coefficients + OF_CONTACT * k.c + 1 + contact * k.width + which, 0
    ]


@inline
def is_stuck(k: Any, rows: Any, contact: int) -> Any:
    """Tell whether a contact, or the slider of its tangential spring, moves with the belt."""
    return regime_value(k, rows, contact, regime_constant.is_stuck) > 0.0


@part
def friction_of(k: Any, rows: Any, i: int) -> Any:
    """Return μ, the coefficient of static friction and the reference speed of a contact."""
    at = parameter_row.coefficients + OF_CONTACT * i
    return rows[at, 0], rows[at + 1, 0], rows[at + 2, 0]


@inline
def time_unit(k: Any, rows: Any) -> Any:
    """Return the unit of time."""
    return rows[parameter_row.coefficients + OF_CONTACT * k.c, 0]


@inline
def _press_at(k: Any, rows: Any, i: int, compression: float) -> Any:
    """Return the force of a contact's piece of a table at a compression."""
    start = regime_value(k, rows, i, FIRST_OF_PRESS)
    stiffness = regime_value(k, rows, i, FIRST_OF_PRESS + 3)
    return regime_value(k, rows, i, FIRST_OF_PRESS + 2) + stiffness * (
        compression - start
    )


@part
def line_of_press(k: Any, rows: Any, i: int) -> Any:
    """Return the stiffness of a contact's piece of a table, and the piece's force where nᵀq = 0."""
    stiffness = regime_value(k, rows, i, FIRST_OF_PRESS + 3)
    at_rest = rows[parameter_row.coefficients + OF_CONTACT * i + 3, 0]
    return stiffness, _press_at(k, rows, i, at_rest)


@part
def press_knot(k: Any, rows: Any, i: int, which: int) -> Any:
    """Return the force at the end (0) or the start (1) of a contact's piece of a table."""
    if which:
        return regime_value(k, rows, i, FIRST_OF_PRESS + 2)
    return _press_at(k, rows, i, regime_value(k, rows, i, FIRST_OF_PRESS + 1))


@part
def stiffness_of(k: Any, rows: Any, i: int) -> Any:
    """Return the stiffness of a contact in its piece of a table."""
    stiffness = k.springs[i]
    if k.n_tables and k.press_counts[i] > 1:
        stiffness, _ = line_of_press(k, rows, i)
    return stiffness


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
def press_of_regime(k: Any, rows: Any, i: int) -> Any:
    """Return the piece of a table of contact in which a contact is."""
    count, piece = k.press_counts[i], 0
    if count == 1:
        return 0
    first, step = k.first[0, i], regimes_of_press(k, i)
    start = regime_value(k, rows, i, FIRST_OF_PRESS)
    while piece + 1 < count and k.table[first + piece * step, FIRST_OF_PRESS] != start:
        piece += 1
    return piece


@part
def slip_regime(k: Any, rows: Any, i: int, speed: float, press: int) -> Any:
    """Return the regime of slip, among those of a contact, by the sliding speed.

    Args:
        press: piece of its table of contact.
    """
    _, _, reference = friction_of(k, rows, i)
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
