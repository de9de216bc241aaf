"""Units of length, mass and time of a file, and what makes its numbers SI's."""

from __future__ import annotations

from typing import Any, NamedTuple

from squealpipe.parameters import brief

DIMENSIONS = ("[length]", "[mass]", "[time]")


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
    import pint

    words = str(units).split("-")
    needed = "units of length, mass and time are needed, like mm-t-s or m-kg-s"
    if len(words) != len(DIMENSIONS):
        raise ValueError(f"units = {brief(units)}: {needed}")
    registry: Any = pint.UnitRegistry()
    factors = []
    for word, dimension in zip(words, DIMENSIONS, strict=True):
        try:
            unit = registry.Quantity(1.0, registry.Unit(word))
        except (pint.errors.PintError, ValueError, AttributeError) as error:
            raise ValueError(
                f"units = {brief(units)}: {word!r} is no unit; {needed}"
            ) from error
        if unit.dimensionality != {dimension: 1}:
            raise ValueError(
                f"units = {brief(units)}: {word!r} is no {dimension.strip('[]')}; {needed}"
            )
        factors.append(float(unit.to_base_units().magnitude))
    length, mass, time = factors
    return Scales(
        mass, mass / time, mass / time**2, mass * length / time**2, length / time
    )
