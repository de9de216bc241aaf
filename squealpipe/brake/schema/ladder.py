"""The levels of the model ladder, one record each, and the dataset that compares them."""

from enum import IntEnum
from typing import Self

from squealpipe.brake.schema.linear import MAP, angle_coordinates
from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    flag,
    or_nan,
    outcome,
    text,
    whether,
)


class Level(IntEnum):
    """All levels, cheapest first; a level is one record.

    Its value is its number in files, whatever its place in the order. A level with a ``model`` is
    that model in time; A3 is the sum of its modes.

    Attributes:
        model: the model that it integrates in time; "" where it does not.
        share: part of the horizon that it integrates.
    """

    label: str
    colour: str
    model: str
    share: float

    a3 = 0, "A3 in contact", "light"
    a4 = 1, "A4", "blue", "A4", 1.0
    a1_linear_springs = 2, "A1, linear springs", "purple", "A1-linear-springs", 1.0
    a1_no_stick = 3, "A1 without stick", "green", "A1-no-stick", 1.0
    a1_short = 4, "A1, part of the horizon", "grey", "A1", 0.5
    a1 = 5, "A1", "black", "A1", 1.0

    def __new__(
        cls,
        number: int,
        label: str = "",
        colour: str = "",
        model: str = "",
        share: float = 0.0,
    ) -> Self:
        """A level from its record."""
        level = int.__new__(cls, number)
        level._value_, level.label, level.colour = number, label, colour
        level.model, level.share = model, share
        return level


QUESTIONS = ("contact_lost", "frequency", "peak_contact_force", "max_displacement")
"""Question that can be asked of a scene."""


model_ladder_schema = DatasetSchema(
    name="model_ladder",
    title="The cheapest adequate model over both spring angles",
    coordinates={
        **angle_coordinates,
        "question": text("question asked of a cell", "question"),
        "level": text("level of the ladder", "level"),
    },
    variables={
        "error": or_nan(
            "error of a level against A1, relative (0 or 1 for contact lost; inf: no answer)",
            dims=("question", "level", *MAP),
            rtol=1e-3,
            atol=1e-9,
        ),
        "cheapest": flag(
            "cheapest level within the tolerance that drops something that mattered",
            Level,
            *("question", *MAP),
        ),
        "chosen": flag("level that choose_model takes for contact lost", Level, *MAP),
        "chosen_wrong": whether("whether its answer is not A1's", *MAP),
        "always_cpu_time": Variable(
            "CPU time of A1 over the whole map, up to the first loss of contact",
            "s",
            volatile=True,
        ),
        "chosen_cpu_time": Variable(
            "CPU time of choose_model over the whole map", "s", volatile=True
        ),
        "belt_reached": whether(
            "whether the mass of A1 reaches belt speed in contact", *MAP
        ),
        "tolerance": Variable("error that is allowed"),
        "outcome": outcome(*MAP, among=(Outcome.converged,)),
    },
)
