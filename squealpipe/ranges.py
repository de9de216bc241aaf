"""Angles, numbers, ranges and whole sweeps as people write them, on the command line and in YAML.

Both are read into one canonical form, so a sweep has one meaning wherever it stands.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from squealpipe.inputs import (
    ANGLES,
    FRICTION_KEYWORDS,
    UNITS,
    parse_angle,
    parse_number,
    reader,
)
from squealpipe.parameters import TABLE
from squealpipe.systems.inputs.units import UnitError, has_unit

PARAMETER_NAMES = tuple(TABLE)
NUMERIC_PARAMETERS = tuple(name for name, row in TABLE.items() if row.allowed != "law")
"""Parameters that are numbers, so that they can be swept."""


def parse_range(text: str, one: Callable[[str], float] = parse_number) -> list[float]:
    """Values from a list ``0.1,0.2``, a range ``0:pi:31`` or ``1:100:7:log``, ends included."""
    parts = text.split(":" if ":" in text else ",")
    ends = parts[:2] if ":" in text else parts
    if one is not parse_angle and len({*map(has_unit, ends)}) > 1:
        raise ValueError(
            f"{text!r}: give each value its unit, and write decimals with a point"
        )
    if ":" not in text:
        return [one(part) for part in parts]
    spacing = parts.pop() if len(parts) == 4 else "linear"
    if len(parts) != 3 or spacing not in {"linear", "log"} or not parts[2].isdigit():
        raise ValueError(
            f"{text!r} is not a range; write first:last:count or first:last:count:log"
        )
    first, last, count = one(parts[0]), one(parts[1]), int(parts[2])
    # a range of more values is a slip of the pen
    most_values = 100_000
    if not 2 <= count <= most_values:
        raise ValueError(
            f"{text!r} asks for {count} values; ask for 2 to {most_values}, or give one value"
        )
    steps = [index / (count - 1) for index in range(count)]
    if spacing == "linear":
        return [first + (last - first) * step for step in steps[:-1]] + [last]
    if not first * last > 0:
        raise ValueError(f"{text!r}: a log range needs two ends of one sign, neither 0")
    return [first * (last / first) ** step for step in steps[:-1]] + [last]


def units_of(task: str) -> Mapping[str, str]:
    """Name → CF unit of what a task takes; a system or structure has names of its own.

    A preload of a structure's sweep is a factor, not a length, and k1 of a system whatever it says.
    """
    names: tuple[str, ...]
    if is_structure(task):
        names = ("mu", "belt_speed", "frequency_max", *FRICTION_KEYWORDS)
    elif ":" in task:
        names = ("t_start", "t_end", "t_late", "tol")
    else:
        return UNITS
    return {name: UNITS[name] for name in names}


def read_values(name: str, given: object, task: str = "") -> list[float]:
    """Values over which a name is swept.

    Args:
        task: of the sweep; by default one of the brake.
    """
    units = units_of(task)
    if units is UNITS and name in TABLE and name not in NUMERIC_PARAMETERS:
        raise ValueError(
            f"{name} cannot be varied, for its values are words; sweep once for each, with {name} "
            "fixed, over mu_static or friction_speed"
        )
    one = reader(name, units)
    if isinstance(given, str):
        values = parse_range(given, one)
    else:
        items = given if isinstance(given, Sequence) else [given]
        values = [one(_as_text(item)) for item in items]
    # a mode is a whole number
    if name != "mode":
        return values
    broken = [value for value in values if not value.is_integer()]
    if broken:
        raise ValueError(f"{broken[0]!r} is not a whole number; {name} needs 1, 2, …")
    return [int(value) for value in values]


def read_fixed(name: str, given: object, task: str = "") -> Any:
    """A value that stays the same: an angle, a parameter, or an option of a task.

    Args:
        given: a value or text; an option may also be a range like ``0:20:50``, a list, a word or
            None.
        task: of the sweep; by default one of the brake.
    """
    units = units_of(task)
    one = reader(name, units)
    if not isinstance(given, str | int | float | Sequence | None):
        raise ValueError(  # noqa: TRY004
            f"{given!r} is not a value; write a number, a word or a list of numbers"
        )
    if units is UNITS and name in (*ANGLES, *NUMERIC_PARAMETERS) and given is not None:
        return one(_as_text(given))
    if isinstance(given, str):
        try:
            values = parse_range(given, one)
        except UnitError:
            raise
        except ValueError:
            return given
        given = values if len(values) > 1 else values[0]
    if isinstance(given, Sequence) and not isinstance(given, str):
        return [one(_as_text(item)) for item in given]
    if isinstance(given, float) and given.is_integer() and abs(given) < 2**53:
        return int(given)
    return given


def is_structure(task: str) -> bool:
    """Return whether a task belongs to a structure in a file, ``FILE.yaml:TASK``."""
    return task.rpartition(":")[0].endswith((".yaml", ".yml"))


def sweep_config(
    *,
    task: str,
    vary: Mapping[str, Sequence[float]],
    fixed: Mapping[str, Any],
    parameters: Mapping[str, float],
) -> dict[str, Any]:
    """The configuration of a sweep in its one form; no parameter that it names is a duplicate."""
    for name in sorted(set(vary) & set(fixed)):
        raise ValueError(f"{name} is both fixed and varied; keep one")
    named = {*vary, *fixed}
    if ":" in task:  # a system or structure in a file has parameters of its own
        parameters = {}
    return {
        "task": task,
        "parameters": {
            name: value for name, value in parameters.items() if name not in named
        },
        "vary": {name: list(values) for name, values in vary.items()},
        "fixed": dict(fixed),
    }


def longest(vary: Mapping[str, Sequence[float]]) -> str:
    """The varied name with the most values, the first of several."""
    return max(vary, key=lambda name: len(vary[name]))


def _as_text(given: object) -> str:
    """Numbers as text that reads as exactly them; true and false are not numbers."""
    return given if isinstance(given, str) else repr(given)
