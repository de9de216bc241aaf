"""Datasets on what the model levels take for granted (Table 1 and section 6 of the paper)."""

from squealpipe.brake.schema.linear import MAP, angle_coordinates
from squealpipe.schema import (
    RUN_ENDS,
    DatasetSchema,
    Outcome,
    Variable,
    flag,
    or_nan,
    outcome,
    text,
)


def _largest(meaning: str) -> Variable:
    return or_nan(meaning, "m", ("level", "scene"), rtol=1e-6)


assumptions_schema = DatasetSchema(
    name="assumptions",
    title="Which assumptions held along the motion that each model level computes for each scene",
    coordinates={
        "level": text("model level", "level"),
        "scene": text("scene of the paper", "scene"),
        "assumption": text("assumption", "assumption"),
    },
    variables={
        "needed": flag(
            "whether the level makes the assumption",
            {0: "no", 1: "yes"},
            "level",
            "assumption",
        ),
        "measure": or_nan(
            "the number that decides", dims=("level", "scene", "assumption"), rtol=1e-6
        ),
        "limit": Variable("limit of the measure", dims=("assumption",)),
        "held": flag(
            "whether the assumption held along the whole motion",
            {0: "no", 1: "yes"},
            "level",
            "scene",
            "assumption",
        ),
        "largest_x": _largest("largest |x|"),
        "largest_y": _largest("largest y"),
        "max_displacement": _largest("largest distance from the start position"),
        "t_end": Variable("end of the motion", "s", ("scene",)),
        "outcome": outcome(
            "level",
            "scene",
            among=(*RUN_ENDS, Outcome.separated, Outcome.singular_static_state),
        ),
    },
)

linear_pull_schema = DatasetSchema(
    name="linear_pull",
    title="How far the linear model lets the contact spring pull, from rest",
    coordinates=angle_coordinates,
    variables={
        "lowest_contact_force": Variable(
            "lowest contact force over k3 l_pre; negative: the spring pulls", dims=MAP
        ),
        "pulling_fraction": Variable(
            "fraction of the time during which the spring pulls", dims=MAP
        ),
        "t_end": Variable("end of the motion", "s"),
        "outcome": outcome(*MAP, among=(Outcome.converged, Outcome.separated)),
    },
)
