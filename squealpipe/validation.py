"""The gate for arguments of the brake's tasks: angles, states and modes beside the common types."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, ParamSpec, TypeVar

import numpy as np
from pydantic import AfterValidator, BeforeValidator

from squealpipe.inputs import UNITS, with_units
from squealpipe.parameters import BEYOND_A_TURN, FULL_TURN
from squealpipe.systems.inputs import gate
from squealpipe.systems.inputs.gate import (
    AnyPath,
    Extended,
    Line,
    Natural,
    NotNegative,
    NotNegativeVector,
    Number,
    Positive,
    Seed,
    Several,
    Tolerance,
    Vector,
    Whole,
    Workers,
    one_of,
    real_array,
    reals,
)
from squealpipe.systems.inputs.values import is_whole_number

__all__ = [
    "Angle",
    "Angles",
    "AnyPath",
    "Extended",
    "Line",
    "Mode",
    "Natural",
    "NotNegative",
    "NotNegativeVector",
    "Number",
    "Positive",
    "Seed",
    "Several",
    "State",
    "Tolerance",
    "Vector",
    "Whole",
    "Workers",
    "checked",
    "one_of",
    "real_array",
    "state_of",
    "within_a_turn",
]

Given = ParamSpec("Given")
Result = TypeVar("Result")


def checked(
    function: Callable[Given, Result], units: Mapping[str, str] = UNITS
) -> Callable[Given, Result]:
    """Have a function check and convert its arguments by their annotations.

    Args:
        units: CF unit by name of the argument, for texts with a unit.

    Raises:
        ValueError: an argument that is not allowed; names it, its value and what is needed.
        TypeError: an argument is missing, unknown or given twice.
    """
    arguments = inspect.signature(function).parameters
    further = any(
        argument.kind == argument.VAR_KEYWORD for argument in arguments.values()
    )
    # keywords beyond the arguments are parameters where the function takes those of a brake
    more = units if further and "params" in arguments else ()

    def read(
        names: Sequence[str], args: Sequence[Any], kwargs: Mapping[str, Any]
    ) -> gate.Arguments:
        return with_units([*names, *more], args, kwargs, units)

    return gate.checked(function, read)


def _mode(value: Any) -> int:
    if not is_whole_number(value) or value not in (1, 2):
        raise ValueError(
            "the whole number 1 or 2 is needed, by ascending frequency in contact"
        )
    return int(value)


def state_of(value: Any) -> np.ndarray:
    """The array of a state x, y, vx, vy."""
    array = reals(value)
    if array.shape != (4,):
        raise ValueError("four finite numbers (x, y, vx, vy) are needed")
    return array


def within_a_turn(angles: Any) -> Any:
    """An angle or an array of them, rad."""
    if np.any(np.abs(angles) > FULL_TURN):
        raise ValueError(BEYOND_A_TURN)
    return angles


Mode = Annotated[int, BeforeValidator(_mode)]
"""1 or 2, by ascending frequency in contact."""


Angle = Annotated[Number, AfterValidator(within_a_turn)]
"""One angle, rad."""


Angles = Annotated[Vector, AfterValidator(within_a_turn)]
"""A 1-D array of angles, rad."""


State = Annotated[Any, BeforeValidator(state_of)]
"""x, y, vx, vy."""
