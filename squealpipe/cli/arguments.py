"""The option types that every command shares."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Group, Parameter

from squealpipe.parameters import Parameters
from squealpipe.ranges import parse_angle, parse_range


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
