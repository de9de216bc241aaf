"""Readings of the paper's sign of friction: the belt direction that each model takes.

Eq. (4) as printed, with μ(V_r) = μ sgn(V_r) and V_r = ẋ − V, pushes a mass slower than the belt
along −x. Eqs. (6)–(20), from which the linear models and A4 follow, drag it along +x. A study
computes the paper's figures in one of three readings and, beside it, the corrected physics, which
has one sign throughout. While |ẋ| < V, Eq. (4) as printed equals a belt along −x: so the correction
that keeps A1's figures lets the belt run that way in all models.

With a negative ``belt_speed`` all of it is mirrored.
"""

from typing import NamedTuple

from squealpipe.parameters import Parameters
from squealpipe.systems.inputs.words import suggestion


class Reading(NamedTuple):
    """One reading of the sign of friction.

    Attributes:
        direction: of the belt along x. The linear models are dragged along it, and so is A1 but for
            its model that is as printed.
        corrected: the reading that is the corrected physics beside it.
    """

    meaning: str
    a1_model: str
    direction: int
    corrected: str


READINGS: dict[str, Reading] = {
    "as_printed": Reading(
        "A1 by Eq. (4) as printed, the linear models by Eqs. (6)–(20)",
        "A1-as-printed",
        1,
        "along_minus_x",
    ),
    "along_plus_x": Reading(
        "friction drags along +x in all models", "A1", 1, "along_plus_x"
    ),
    "along_minus_x": Reading(
        "friction drags along −x in all models", "A1", -1, "along_minus_x"
    ),
}


def reading_of(name: str) -> Reading:
    """The reading of that name."""
    if name not in READINGS:
        raise ValueError(f"reading = {name!r}: unknown; {suggestion(name, READINGS)}")
    return READINGS[name]


def for_linear(params: Parameters, reading: str) -> Parameters:
    """Parameters that A2, A3, A4 and the natural frequencies are computed with."""
    return params.with_(belt_speed=reading_of(reading).direction * params.belt_speed)


def corrected(params: Parameters, reading: str) -> Parameters:
    """Parameters of the corrected physics beside a reading, for all models."""
    return for_linear(params, reading_of(reading).corrected)
