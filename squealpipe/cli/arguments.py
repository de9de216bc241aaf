"""What people type: angles, ranges, and the option types that every command shares."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Group, Parameter

from squealpipe.parameters import Parameters

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_PI = re.compile(
    rf"^(?P<sign>[+-])?(?P<head>{_NUMBER})?\s*\*?\s*(?:pi|π)(?:/(?P<below>{_NUMBER}))?$"
)
_DEGREES = re.compile(rf"^(?P<value>{_NUMBER})\s*(?:deg|°)$")
_RADIANS = re.compile(rf"^(?P<value>{_NUMBER})\s*(?:rad)?$")
ANGLE_FORMS = "write 0.4pi, 2pi/5, 72deg or radians"


def parse_angle(text: str) -> float:
    """An angle in rad from ``0.4pi``, ``2pi/5``, ``72deg`` or plain radians.

    Raises:
        ValueError: the text is none of these; the message lists them.
    """
    stripped = text.strip().lower()
    if match := _PI.match(stripped):
        head = float(match["head"] or 1) * (-1 if match["sign"] == "-" else 1)
        below = float(match["below"] or 1)
        if below:
            return head * math.pi / below
    elif match := _DEGREES.match(stripped):
        return math.radians(float(match["value"]))
    elif (match := _RADIANS.match(stripped)) and math.isfinite(float(match["value"])):
        return float(match["value"])
    raise ValueError(f"{text!r} is no angle; {ANGLE_FORMS}")


def parse_number(text: str) -> float:
    """A finite number.

    Raises:
        ValueError: it is something else.
    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is no number; write for instance 0.3 or 1e-3")
    return value


def parse_range(text: str, one: Callable[[str], float] = parse_number) -> list[float]:
    """Values from a list ``0.1,0.2,0.4``, a range ``0:pi:31`` or ``1:100:7:log`` (ends included).

    Args:
        text: what was typed.
        one: reads a single value, for instance :func:`parse_angle`.

    Raises:
        ValueError: the text is neither, with the form to use.
    """
    if ":" not in text:
        return [one(part) for part in text.split(",")]
    parts = text.split(":")
    spacing = parts.pop() if len(parts) == 4 else "linear"
    if len(parts) != 3 or spacing not in {"linear", "log"} or not parts[2].isdigit():
        raise ValueError(f"{text!r} is no range; write first:last:count or first:last:count:log")
    first, last, count = one(parts[0]), one(parts[1]), int(parts[2])
    if count < 2:
        raise ValueError(f"{text!r} asks for {count} values; ask for 2 or more, or give one value")
    steps = [index / (count - 1) for index in range(count)]
    if spacing == "linear":
        return [first + (last - first) * step for step in steps[:-1]] + [last]
    if not first * last > 0:
        raise ValueError(f"{text!r}: a log range needs two ends of one sign, neither 0")
    return [first * (last / first) ** step for step in steps[:-1]] + [last]


def _angle(_: Any, tokens: Sequence[Any]) -> float:
    return parse_angle(tokens[0].value)


def _angles(_: Any, tokens: Sequence[Any]) -> list[float]:
    return parse_range(tokens[0].value, parse_angle)


Angle = Annotated[
    float, Parameter(converter=_angle, metavar="ANGLE", allow_leading_hyphen=True, n_tokens=1)
]
AngleRange = Annotated[
    list[float],
    Parameter(
        converter=_angles,
        metavar="RANGE",
        allow_leading_hyphen=True,
        n_tokens=1,
        negative="",
        show_default="0:pi:61",
    ),
]
Physical = Annotated[
    Parameters, Parameter(name="*", group=Group("Physical parameters", sort_key=10))
]
Output = Annotated[Path, Parameter(name=["--output", "-o"])]
Picture = Annotated[Path | None, Parameter(name=["--picture", "-p"])]

PICTURES = (".png", ".svg", ".pdf")


def picture_beside(output: Path, picture: Path | None) -> Path:
    """Where the picture goes: as asked, or beside the output.

    Raises:
        ValueError: the two would be one file, or the picture is of no kind that can be written.
    """
    chosen = output.with_suffix(".png") if picture is None else picture
    if chosen.suffix not in PICTURES:
        raise ValueError(f"--picture {chosen}: end the name in {', '.join(PICTURES)}")
    if chosen == output:
        raise ValueError(f"--output {output}: the dataset needs another name than the picture")
    return chosen


BASELINE = Parameters()
FULL_RANGE = parse_range("0:pi:61", parse_angle)
"""Both spring angles from 0 to π."""
