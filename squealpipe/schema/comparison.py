"""Datasets that compare methods and models: speed against accuracy, failures, the model ladder."""

from __future__ import annotations

from enum import IntEnum

from squealpipe.schema import DatasetSchema, Variable, outcome
from squealpipe.schema.linear import ANGLES, MAP

RUN = ("run",)


class Role(IntEnum):
    """Whether a method is ours or a public one."""

    public = 0
    ours = 1
    our_setting = 2


def _text(long_name: str, *dims: str) -> Variable:
    return Variable(dims=dims, dtype="U64", long_name=long_name)


WORK_PRECISION = DatasetSchema(
    name="work_precision",
    title="Error of a method against its cost, one run a row",
    coordinates={"run": Variable(dims=RUN, dtype="i4", long_name="one method at one setting")},
    variables={
        "task": _text("kind of task", *RUN),
        "scene": _text("what is computed", *RUN),
        "method": _text("method", *RUN),
        "setting": _text("its setting", *RUN),
        "role": Variable(
            dims=RUN, dtype="i1", flags=Role, long_name="public method, ours, or our default"
        ),
        "error": Variable(
            dims=RUN,
            long_name="error against the reference, scaled to order one",
            nan_allowed=True,
            rtol=1e-3,
            atol=1e-12,
        ),
        "reference_error": Variable(
            dims=RUN, long_name="bound on the error of the reference", rtol=1.0
        ),
        "wrong_events": Variable(
            dims=RUN,
            dtype="i4",
            long_name="contact changes too many or too few, or cells decided wrongly; "
            "-1 where the method reports none",
        ),
        "boundary_distance": Variable(
            dims=RUN,
            units="rad",
            long_name="mean distance of a map's boundary from the reference's",
            nan_allowed=True,
            rtol=1e-3,
        ),
        "evaluations": Variable(
            dims=RUN,
            long_name="evaluations of the right-hand side (a Taylor step of order p counts p + 1), "
            "of the balance's equations, or eigenvalue problems",
            # The paper's Newton method has a Jacobian without full rank: from run to run round-off
            # alone changes its number of steps by a quarter.
            rtol=0.5,
        ),
        "wall_time": Variable(
            dims=RUN, units="s", long_name="median wall time of one solution", volatile=True
        ),
        "outcome": outcome(*RUN),
    },
)


class Verdict(IntEnum):
    """What a method's answer to a hard scene is worth."""

    not_applicable = 0
    right = 1
    flagged = 2
    silently_wrong = 3


SCENE_SOLVER = ("scene", "solver")

FAILURE_ATLAS = DatasetSchema(
    name="failure_atlas",
    title="Every method on every hard scene, judged by its error against a reference",
    coordinates={
        "scene": _text("hard scene", "scene"),
        "solver": _text("method (the name xarray keeps for itself)", "solver"),
    },
    variables={
        "verdict": Variable(
            dims=SCENE_SOLVER, dtype="i1", flags=Verdict, long_name="verdict on the answer"
        ),
        "error": Variable(
            dims=SCENE_SOLVER,
            long_name="largest error of the answer; infinite where there is none",
            nan_allowed=True,
            rtol=1e-2,
            atol=1e-9,
        ),
        "flagged": Variable(
            dims=SCENE_SOLVER, dtype="i1", flags={0: "no", 1: "yes"}, long_name="method warned"
        ),
        "message": _text("what the method said", *SCENE_SOLVER),
        "tolerance": Variable(dims=("scene",), long_name="largest error that counts as right"),
        "role": Variable(dims=("solver",), dtype="i1", flags=Role, long_name="whose method it is"),
    },
)


class Level(IntEnum):
    """Levels of the model ladder, cheapest first."""

    closed_form = 0
    a3_in_contact = 1
    a4_exact = 2
    a4_in_time = 3
    a1_linear_springs = 4
    a1_no_stick = 5
    a1_short = 6
    a1 = 7


QUESTIONS = ("contact_lost", "frequency", "peak_contact_force", "max_displacement")
"""What can be asked of a scene."""

_CELL = ("question", *MAP)

MODEL_LADDER = DatasetSchema(
    name="model_ladder",
    title="The cheapest adequate model over both spring angles",
    coordinates={
        **ANGLES,
        "question": _text("question asked of a cell", "question"),
        "level": _text("level of the ladder", "level"),
    },
    variables={
        "error": Variable(
            dims=("question", "level", *MAP),
            long_name="error of a level against A1, relative (0 or 1 for contact lost)",
            nan_allowed=True,
            rtol=1e-3,
            atol=1e-9,
        ),
        "cheapest": Variable(
            dims=_CELL, dtype="i1", flags=Level, long_name="cheapest level within the tolerance"
        ),
        "chosen": Variable(
            dims=_CELL, dtype="i1", flags=Level, long_name="level that choose_model takes"
        ),
        "chosen_error": Variable(
            dims=_CELL,
            long_name="error of the chosen answer against A1",
            nan_allowed=True,
            rtol=1e-3,
            atol=1e-9,
        ),
        "chosen_time": Variable(
            dims=("question",), units="s", long_name="time integrated by choose_model, all cells"
        ),
        "always_time": Variable(
            dims=("question",),
            units="s",
            long_name="time integrated by always A1 until the question is answered, all cells",
        ),
        "hindsight_time": Variable(
            dims=("question",),
            units="s",
            long_name="time integrated if the cheapest adequate level were known, all cells",
        ),
        "level_wall_time": Variable(
            dims=("level",),
            units="s",
            long_name="wall time of a level over the whole map",
            volatile=True,
        ),
        "always_wall_time": Variable(
            dims=("question",),
            units="s",
            long_name="wall time of always A1 over the whole map, stopped at the answer",
            volatile=True,
        ),
        "chosen_wall_time": Variable(
            dims=("question",),
            units="s",
            long_name="wall time of choose_model over the whole map",
            volatile=True,
        ),
        "tolerance": Variable(long_name="error that is allowed"),
        "outcome": outcome(*MAP),
    },
)
