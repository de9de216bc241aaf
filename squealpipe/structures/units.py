"""Units of length, mass and time of a file, and what makes its numbers SI's."""

from typing import Any, NamedTuple

from squealpipe.systems.inputs.units import UnitError, in_si
from squealpipe.systems.inputs.values import brief


class Scales(NamedTuple):
    """Factors to SI units, of matrices whose degrees of freedom are displacements."""

    mass: float
    damping: float
    stiffness: float
    force: float
    speed: float
    length: float = 1.0

    @property
    def rate(self) -> float:
        """Factor of what is per time."""
        return self.speed / self.length

    @property
    def pressure(self) -> float:
        """Factor of forces over areas."""
        return self.force / self.length**2

    @property
    def stiffness_per_area(self) -> float:
        """Factor of stiffnesses over areas."""
        return self.stiffness / self.length**2


SI = Scales(1.0, 1.0, 1.0, 1.0, 1.0)


def _is_force(word: str) -> bool:
    try:
        return in_si(f"1 {word}", "N") > 0
    except UnitError:
        return False


def scales_of(units: Any) -> Scales:
    """The factors of units like ``mm-t-s``.

    Raises:
        ValueError: they are not a length, a mass and a time.
    """
    words = str(units).split("-")
    needed = "units of length, mass and time are needed, like mm-t-s or m-kg-s"
    # quantity that each word of units like mm-t-s measures → its SI unit
    matrix_quantities = {"length": "m", "mass": "kg", "time": "s"}
    if len(words) != len(matrix_quantities):
        raise ValueError(f"units = {brief(units)}: {needed}")
    # a pound may be one of mass or of force, and only the user knows which
    pounds = ("lb", "lbs")
    if words[1].lower() in pounds:
        raise ValueError(
            f"units = {brief(units)}: {words[1]} is a mass or a force; write "
            f"{words[0]}-pound-{words[2]} if masses are in lb (and forces in lb "
            f"{words[0]}/{words[2]}²), {words[0]}-{'slug' if words[0] == 'ft' else 'slinch'}-"
            f"{words[2]} if forces are in lbf"
        )
    factors = []
    for word, (kind, si) in zip(words, matrix_quantities.items(), strict=True):
        try:
            # Abaqus's manual calls the tonne of mm, s and N so
            factors.append(in_si(f"1 {'t' if word.lower() == 'ton' else word}", si))
        except UnitError as error:
            force = (
                "; of units with one of force name that of mass, which is force times time² over "
                "length, like t with mm, s and N"
                if kind == "mass" and _is_force(word)
                else ""
            )
            raise ValueError(
                f"units = {brief(units)}: {word!r} is no {kind} ({error}); {needed}{force}"
            ) from error
    length, mass, time = factors
    return Scales(
        mass,
        mass / time,
        mass / time**2,
        mass * length / time**2,
        length / time,
        length,
    )
