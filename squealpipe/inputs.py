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
)
from squealpipe.systems.inputs.units import (
    UnitError,
    has_unit,
    holds_units,
    in_si,
    is_quantity,
    number_of,
)
from squealpipe.systems.inputs.values import brief
from squealpipe.systems.inputs.words import as_number

ANGLES = ("alpha1", "alpha2")
UNITS = UNITS_OF_INPUTS | {
    **dict.fromkeys(("t_start", "t_end", "t_late", "t_settle", "times", "last"), "s"),
    **dict.fromkeys(("x", "y", "x0", "y0", "y_peak"), "m"),
    **dict.fromkeys(("y_peak_max", "x_amplitude_max"), "m"),
    **dict.fromkeys(("vx", "vy", "vx0", "vy0"), "m s-1"),
    "time_scale": "s",
    "frequency_max": "Hz",
    **dict.fromkeys(("tol", "smoothed_tol", "spring_correlation", "bound"), "1"),
    **dict.fromkeys(("kappa", "lambda_", "length_ratio", "speed_ratio"), "1"),
    "modal_damping": "1",
}
"""CF units of parameters and of the options of tasks, whose values may be texts with a unit."""
STATE_NAMES, STATES = ("x", "y", "vx", "vy"), ("initial_state", "guess", "start")
"""Components of a state, and the arguments that are states."""
BY_NAME = ("distributions", "design", "to", "vary", "fixed")
"""Arguments that may be mappings from names of parameters to values."""


def parse_angle(text: str) -> float:
    """An angle in rad from ``0.4pi``, ``2pi/5``, ``72deg`` or plain radians."""
    value = _angle_in(text.strip().lower())
    forms = "write 0.4pi, 2pi/5, 72deg or radians"
    if value is None and has_unit(text):  # 0.4 mrad, or a wrong kind, which is named
        try:
            value = in_si(text, "rad", KEYS_THAT_TAKE)
        except UnitError as error:
            raise UnitError(f"{text!r}: {error}; or {forms}") from None
    if value is None or not math.isfinite(value):
        raise ValueError(f"{text!r} is not a valid angle; {forms}")
    if abs(value) > FULL_TURN:
        raise ValueError(
            f"{text.strip()}: {BEYOND_A_TURN}; degrees are written like 72deg"
        )
    return value


def _angle_in(text: str) -> float | None:
    # 0.4pi, 2π/5, pi
    number = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
    if match := re.fullmatch(
        rf"([+-]?)({number})?\s*\*?\s*(?:pi|π)(?:/({number}))?", text
    ):
        sign, head, below = match.groups("1")
        above = float(head) * (-1 if sign == "-" else 1) * math.pi
        return above / float(below) if float(below) else None
    # 72deg, 72°, 1.2 rad, 1.2
    if not (match := re.fullmatch(rf"({number})\s*(deg|°|rad)?", text)):
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
    value = as_number(text)
    if not math.isfinite(value):
        of_none = ", and no unit is declared for it" if has_unit(text) else ""
        raise ValueError(
            f"{text!r} is not a number{of_none}; write for instance 0.3 or 1e-3"
        )
    return value


def reader(name: str, units: Mapping[str, str] = UNITS) -> Callable[[str], float]:
    """Return the function that reads a text as a parameter, an angle or an option.

    Args:
        units: CF unit by name; other names have no unit.
    """
    if name in ANGLES and units is UNITS:
        return parse_angle
    return partial(parse_number, units=units.get(name))


def read_distribution(name: str, numbers: Mapping[str, Any]) -> dict[str, Any]:
    """A distribution whose numbers may have the unit of its parameter, or be angles."""
    return {
        key: value
        if key in {"distribution", "log_std"}
        else reader(name)(value)
        if isinstance(value, str)
        else _quantity(name, value, UNITS)
        for key, value in numbers.items()
    }


FRICTION_KEYWORDS = ("mu_static", "friction_speed", "modal_damping")
"""Further keywords of a structure's verbs that are no factors."""
Given = ParamSpec("Given")
Result = TypeVar("Result")


def takes_units(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Have a function read its arguments, and friction, by :func:`with_units`."""
    names = [*inspect.signature(function).parameters, *FRICTION_KEYWORDS]

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
    is_end = name == "to" and "parameter" in about
    if name == "to" and "system" in about:
        return value  # of a parameter that has no declared unit
    name_of_unit = str(about["parameter"]) if is_end else name
    # These arguments hold further values, which may be texts with units
    of_parts = frozenset({*BY_NAME, *STATES, *ANGLES})
    if name_of_unit not in units and name_of_unit not in of_parts:
        return value
    try:
        return _read(name_of_unit, value, units)
    except ValueError as error:
        reason = str(error).removeprefix(f"{value!r}: ")
        raise ValueError(f"{name} = {brief(value)}: {reason}") from None


def _read(name: str, value: Any, units: Mapping[str, str]) -> Any:
    """A value in SI, or each of several; what has no unit is as it was."""
    if isinstance(value, Mapping):
        if name not in BY_NAME:
            return value
        if name == "distributions":
            return {
                key: read_distribution(key, numbers)
                if isinstance(numbers, Mapping)
                else numbers
                for key, numbers in value.items()
            }
        return {key: _read(str(key), each, units) for key, each in value.items()}
    if not isinstance(value, list | tuple):
        return _quantity(name, value, units)
    if not any(isinstance(each, str) or holds_units(each) for each in value):
        return value
    of_state = name in STATES and len(value) == len(STATE_NAMES)
    parts = STATE_NAMES if of_state else [name] * len(value)
    read = (_read(part, each, units) for part, each in zip(parts, value, strict=True))
    return tuple(read) if isinstance(value, tuple) else list(read)


def _quantity(name: str, value: Any, units: Mapping[str, str]) -> Any:
    """A value in SI; one that has no unit is left for others to judge."""
    unit = "rad" if name in ANGLES else units.get(name)
    if unit is None:
        return value
    if isinstance(value, str) and unit == "rad":
        written = has_unit(value) or re.search("pi|π", value, re.IGNORECASE)
        return parse_angle(value) if written else value
    if unit == "rad" and is_quantity(value) and str(value.units) == "degree":
        degrees = number_of(value, "deg")
        # as of a text: radians of the double, though those of the decimal may be another
        several = getattr(degrees, "tolist", lambda: degrees)()
        return _radians(several)
    return number_of(value, unit, KEYS_THAT_TAKE)


def _radians(degrees: Any) -> Any:
    if isinstance(degrees, list):
        return [_radians(degree) for degree in degrees]
    return math.radians(degrees)
