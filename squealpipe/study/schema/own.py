"""Schemas of a user's own scenes, as configured and with one thing changed.

Studies of 1.0.0 hold it; ``assess`` answers in its place, and it is still read.
"""

from dataclasses import replace

from squealpipe.brake.schema.dynamics.runs import (
    first_return_force,
    largest_impact_speed,
)
from squealpipe.brake.schema.linear import angles_of_one_pair
from squealpipe.schema import RUN_ENDS, DatasetSchema, Variable, count, outcome, text


def _number(meaning: str, units: str = "1") -> Variable:
    return Variable(
        meaning, units, ("scene", "variant"), nan_allowed=True, rtol=1e-3, atol=1e-9
    )


own_scenes_schema = DatasetSchema(
    name="own_scenes",
    title="What the scenes of a study do, as configured and with one thing changed",
    coordinates={
        "scene": text("name of the scene", "scene"),
        "variant": text("what is changed", "variant"),
        "question": text("question asked of a scene", "question"),
        "peak": count("peak of the spectrum, by height", "peak"),
    },
    variables={
        "motion": text("kind of motion", "scene", "variant"),
        "first_separation_time": _number("time of the first loss of contact", "s"),
        "separated_fraction": _number("share of the time without contact"),
        "stick_fraction": _number("share of the time in stick"),
        "return_peak_contact_force": _number(first_return_force.long_name),
        "impact_speed": _number(
            largest_impact_speed.long_name, largest_impact_speed.units
        ),
        "largest_x": _number("largest |x|", "m"),
        "largest_y": _number("largest |y|", "m"),
        "predictability_horizon": _number("time to which a run can be computed", "s"),
        "dominant_frequency": Variable(
            "angular frequencies of the contact force",
            "rad s-1",
            ("scene", "variant", "peak"),
            nan_allowed=True,
            rtol=1e-3,
        ),
        "model": text("cheapest level that answers", "scene", "question"),
        **{
            name: replace(entry, dims=("scene",))
            for name, entry in angles_of_one_pair.items()
        },
        "t_end": Variable("end of the runs", "s", ("scene",)),
        "outcome": outcome("scene", "variant", among=RUN_ENDS),
    },
)
