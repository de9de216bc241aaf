"""Single values: what counts as a number, and how a message shows it."""

import math
import reprlib
from collections.abc import Mapping
from numbers import Integral, Real
from typing import Any

from squealpipe.systems.inputs.units import number_of


def numbers_in_si(
    name: str, value: Any, units: str, keys: Mapping[str, str] | None = None
) -> Any:
    """A number, list, array or matrix in SI where it has units; else the value as it is.

    Args:
        name: of the argument, for messages.
        units: CF unit of the result, or that of a state.
        keys: names and CF units of other inputs, to say which takes what was written.

    Raises:
        ValueError: a unit of another kind; names argument and value.
    """
    try:
        return number_of(value, units, keys)
    except ValueError as error:
        raise ValueError(f"{name} = {brief(value)}: {error}") from error


def is_finite_number(value: object) -> bool:
    """Return whether a value is a real number that a double holds; no truth value or text."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(float(value))
    except (OverflowError, TypeError):  # NumPy takes a duration for an integer
        return False


def is_whole_number(value: object) -> bool:
    """Return whether a value is an integer; truth values and floats are not."""
    return isinstance(value, Integral) and is_finite_number(value)


def brief(value: object) -> str:
    """A value as an error message shows it: long ones are cut."""
    if isinstance(value, int) and value.bit_length() > 64:
        return f"an integer of {value.bit_length()} bits"
    return reprlib.repr(value)
