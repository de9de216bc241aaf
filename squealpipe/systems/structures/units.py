"""Units of length, mass and time of a file, and what makes its numbers SI's."""

from typing import Any, NamedTuple

from squealpipe.parameters import brief
from squealpipe.units import UnitError, in_si

KINDS = {"length": "m", "mass": "kg", "time": "s"}
"""What each word of units like ``mm-t-s`` measures → its SI unit."""


class Scales(NamedTuple):
    """Factors to SI units, of matrices whose degrees of freedom are displacements."""

    mass: float
    damping: float
    stiffness: float
    force: float
    speed: float


SI = Scales(1.0, 1.0, 1.0, 1.0, 1.0)


def scales_of(units: Any) -> Scales:
    """The factors of units like ``mm-t-s``.

    Raises:
        ValueError: they are not a length, a mass and a time.
    """
    words = str(units).split("-")
    needed = "units of length, mass and time are needed, like mm-t-s or m-kg-s"
    if len(words) != len(KINDS):
        raise ValueError(f"units = {brief(units)}: {needed}")
    factors = []
    for word, (kind, si) in zip(words, KINDS.items(), strict=True):
        try:
            factors.append(in_si(f"1 {word}", si))
        except UnitError as error:
            raise ValueError(
                f"units = {brief(units)}: {word!r} is no {kind}; {needed}"
            ) from error
    length, mass, time = factors
    return Scales(
        mass, mass / time, mass / time**2, mass * length / time**2, length / time
    )
