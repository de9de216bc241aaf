"""Numbers as people write them, by the name of what they are for: 0.4pi, 20 ms, 7.2 km/h."""

import functools
import inspect
import math
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, ParamSpec, TypeVar

from squealpipe.parameters import (
    BEYOND_A_TURN,
    FULL_TURN,
    KEYS_THAT_TAKE,
    UNITS_OF_INPUTS,
    brief,
)
from squealpipe.units import UnitError, has_unit, in_si, number_of

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_IN_PI = re.compile(rf"([+-]?)({_NUMBER})?\s*\*?\s*(?:pi|π)(?:/({_NUMBER}))?")
_IN_UNITS = re.compile(rf"({_NUMBER})\s*(deg|°|rad)?")
ANGLE_FORMS = "write 0.4pi, 2pi/5, 72deg or radians"
ANGLES = ("alpha1", "alpha2")
UNITS = UNITS_OF_INPUTS | {
    **dict.fromkeys(("t_end", "t_late", "t_settle", "times", "last"), "s"),
    **dict.fromkeys(("x", "y", "x0", "y0", "y_peak"), "m"),
    **dict.fromkeys(("y_peak_max", "x_amplitude_max"), "m"),
    **dict.fromkeys(("vx", "vy", "vx0", "vy0"), "m s-1"),
    "frequency_max": "Hz",
    "tol": "1",
}
"""CF units of parameters and of the options of tasks, whose values may be texts with a unit."""
STATE, STATES = ("x", "y", "vx", "vy"), ("initial_state", "guess", "start")
"""What a state consists of, and the arguments that are states."""
_OF_PARTS = frozenset({"distributions", *STATES, *ANGLES})
"""Further arguments that may hold texts with units."""


def parse_angle(text: str) -> float:
    """An angle in rad from ``0.4pi``, ``2pi/5``, ``72deg`` or plain radians."""
    value = _angle_in(text.strip().lower())
    if value is None and has_unit(text):  # 0.4 mrad, or a wrong kind, which is named
        try:
            value = in_si(text, "rad", KEYS_THAT_TAKE)
        except UnitError as error:
            raise UnitError(f"{text!r}: {error}; or {ANGLE_FORMS}") from None
    if value is None or not math.isfinite(value):
        raise ValueError(f"{text!r} is not a valid angle; {ANGLE_FORMS}")
    if abs(value) > FULL_TURN:
        raise ValueError(
            f"{text.strip()}: {BEYOND_A_TURN}; degrees are written like 72deg"
        )
    return value


def _angle_in(text: str) -> float | None:
    if match := _IN_PI.fullmatch(text):
        sign, head, below = match.groups("1")
        above = float(head) * (-1 if sign == "-" else 1) * math.pi
        return above / float(below) if float(below) else None
    if not (match := _IN_UNITS.fullmatch(text)):
        return None
    value = float(match[1])
    return math.radians(value) if match[2] in {"deg", "°"} else value


def parse_number(text: str, units: str | None = None) -> float:
    """A finite number, or a text with a unit where CF units are given."""
    if units is not None and has_unit(text):
        try:
            return in_si(text, units, KEYS_THAT_TAKE)
        except UnitError as error:
            raise UnitError(f"{text!r}: {error}") from None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is not a number; write for instance 0.3 or 1e-3")
    return value


def reader(name: str) -> Callable[[str], float]:
    """What reads a text as a value of a parameter, an angle or an option."""
    if name in ANGLES:
        return parse_angle
    return partial(parse_number, units=UNITS.get(name))


def read_distribution(name: str, numbers: Mapping[str, Any]) -> dict[str, Any]:
    """A distribution whose numbers may be texts with the unit of its parameter or an angle."""
    one = reader(name)
    return {
        key: one(value)
        if isinstance(value, str) and key not in {"distribution", "log_std"}
        else value
        for key, value in numbers.items()
    }


Given = ParamSpec("Given")
Result = TypeVar("Result")


def takes_units(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Have a function read its arguments, and friction, by :func:`with_units`."""
    names = [*inspect.signature(function).parameters, "mu_static", "friction_speed"]

    @functools.wraps(function)
    def run(*args: Given.args, **kwargs: Given.kwargs) -> Result:
        read, named = with_units(names, args, kwargs)
        return function(*read, **named)  # type: ignore[arg-type]

    return run


def with_units(
    names: Sequence[str],
    args: Sequence[Any],
    kwargs: Mapping[str, Any],
    units: Mapping[str, str] = UNITS,
) -> tuple[list[Any], dict[str, Any]]:
    """Arguments of a function with texts and quantities of pint as numbers in SI.

    Args:
        names: of the function's arguments, in their order. Further keywords have names of the
            user's own system, or are factors: they are left as they are.
        units: CF unit by name.

    Raises:
        ValueError: a quantity of another kind; names the argument and what takes it.
    """
    about = dict(zip(names, args, strict=False)) | dict(kwargs)
    positional = [
        _argument(name, value, about, units)
        for name, value in zip(names, args, strict=False)
    ]
    return [*positional, *args[len(positional) :]], {
        name: _argument(name, value, about, units) if name in names else value
        for name, value in kwargs.items()
    }


def _argument(
    name: str, value: Any, about: Mapping[str, Any], units: Mapping[str, str]
) -> Any:
    is_end = name == "to" and "parameter" in about and "system" not in about
    name_of_unit = str(about["parameter"]) if is_end else name
    if name_of_unit not in units and name_of_unit not in _OF_PARTS:
        return value
    try:
        if name == "distributions" and isinstance(value, Mapping):
            return {
                key: read_distribution(key, numbers)
                if isinstance(numbers, Mapping)
                else numbers
                for key, numbers in value.items()
            }
        if isinstance(value, list | tuple):
            if not any(map(_may_have_unit, value)):
                return value
            if name in STATES and len(value) == len(STATE):
                return [
                    _quantity(part, one, units)
                    for part, one in zip(STATE, value, strict=True)
                ]
            return [_quantity(name_of_unit, one, units) for one in value]
        return _quantity(name_of_unit, value, units)
    except ValueError as error:
        reason = str(error).removeprefix(f"{value!r}: ")
        raise ValueError(f"{name} = {brief(value)}: {reason}") from None


def _may_have_unit(value: Any) -> bool:
    quantity = hasattr(value, "dimensionality") and hasattr(value, "magnitude")
    return isinstance(value, str) or quantity


def _quantity(name: str, value: Any, units: Mapping[str, str]) -> Any:
    """A value in SI; one that is no text with a unit is left for others to judge."""
    unit = "rad" if name in ANGLES else units.get(name)
    if unit is None or not _may_have_unit(value):
        return value
    if isinstance(value, str) and unit == "rad":
        written = has_unit(value) or re.search("pi|π", value, re.IGNORECASE)
        return parse_angle(value) if written else value
    if isinstance(value, str) or not getattr(value.magnitude, "shape", ()):
        return number_of(value, unit, KEYS_THAT_TAKE)
    return value.magnitude * in_si(f"1 {value.units:D}", unit, KEYS_THAT_TAKE)
