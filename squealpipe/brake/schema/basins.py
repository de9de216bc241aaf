"""Schemas of A1 from other starts than rest: ``basin_map_…`` and ``smallest_disturbance``."""

from dataclasses import replace
from enum import IntEnum

from squealpipe.brake.schema.dynamics.runs import IN_MAP, STATE_UNITS, MotionFlag
from squealpipe.brake.schema.linear import angles_of_one_pair
from squealpipe.codes import LinearRegime
from squealpipe.schema import (
    RUN_ENDS,
    DatasetSchema,
    Outcome,
    Variable,
    count,
    flag,
    or_nan,
    outcome,
    whether,
)

start_variables = {
    f"{name}0": Variable(f"{words} at the start", units)
    for name, (units, words) in STATE_UNITS.items()
}


def basin_schema(swept: tuple[str, ...]) -> DatasetSchema:
    """Return the schema of a basin map whose dimensions are the ``swept`` names, as x0 and vx0."""

    def real(units: str, long_name: str) -> Variable:
        return or_nan(long_name, units, swept, **IN_MAP)

    return DatasetSchema(
        name="basin_map" + "".join(f"_{name}" for name in swept),
        title="Kind of motion of model A1 over its starts",
        coordinates={
            name: replace(start_variables[name], dims=(name,)) for name in swept
        },
        variables={
            "motion": flag(
                "kind of motion in the second half of the run; unsettled: its quarters disagree",
                MotionFlag,
                *swept,
                **IN_MAP,
            ),
            "late_max_x": real("m", "largest |x| from t_late on"),
            "late_max_vx": real(
                "m s-1", "largest velocity along the belt, |x'|, from t_late on"
            ),
            "separates": whether("whether contact is lost before t_end", *swept),
            "first_separation_time": real(
                "s", "first loss of contact (NaN: none before t_end)"
            ),
            "peak_contact_force": real("1", "largest contact force over k3 l_pre"),
            "lyapunov_exponent": real(
                "s-1", "rate of growth of a perturbation over the run"
            ),
            "predictability_horizon": or_nan(
                "time at which an error of the tolerance has grown to l_pre/1000, or the end",
                "s",
                swept,
                rtol=1e-6,
            ),
            "outcome": outcome(*swept, among=(*RUN_ENDS, Outcome.beyond_horizon)),
            **{
                name: start_variables[name]
                for name in start_variables
                if name not in swept
            },
            **angles_of_one_pair,
            "t_end": Variable("end of each run", "s"),
        },
    )


basin_map_schemas = tuple(
    basin_schema(
        tuple(name for i, name in enumerate(start_variables) if chosen >> i & 1)
    )
    for chosen in range(16)
)
"""One schema for each choice of dimensions."""


class LeadsTo(IntEnum):
    """Result that a disturbance of steady sliding leads to."""

    contact_lost = 0
    whirl = 1


def _distance(dim: str, long_name: str) -> Variable:
    return or_nan(long_name, dims=(dim,), rtol=1e-6)


smallest_disturbance_schema = DatasetSchema(
    name="smallest_disturbance",
    title="Smallest disturbance of steady sliding that leads to contact loss, or to the whirl",
    coordinates={
        "directions": count("number of random directions", "directions"),
        "improved": count("rank of the direction that was improved", "improved"),
    },
    variables={
        "leads_to": flag("what it leads to", LeadsTo),
        "x_rest": or_nan("x of steady sliding", "m"),
        "y_rest": or_nan("y of steady sliding", "m"),
        "growth_rate": or_nan("largest real part of small motions about it", "s-1"),
        "regime_linear": flag("stability regime of model A3", LinearRegime),
        "rest_distance": or_nan("norm of the start at rest at r = 0"),
        "linear_distance": or_nan(
            "smallest norm with which the linear motion loses contact"
        ),
        "distance": or_nan("smallest norm found, an upper bound", rtol=1e-6),
        **{
            f"{name}_disturbance": or_nan(f"its {words}", units, rtol=1e-4)
            for name, units, words in (
                ("x", "m", "part along the belt"),
                ("y", "m", "part away from the belt"),
                ("vx", "m s-1", "velocity along the belt"),
                ("vy", "m s-1", "velocity away from the belt"),
            )
        },
        "distance_by_number": _distance(
            "directions", "smallest norm along the first directions"
        ),
        "improved_distance": _distance(
            "improved", "norm after the local search from a direction"
        ),
        "share_below": or_nan(
            "most of all directions that can have a smaller norm than those tried, 95 %"
        ),
        "reached": count(
            "number of directions along which it happens within the bound"
        ),
        "unfinished": count("number of runs that did not reach their end"),
        "outcome": outcome(
            among=(
                Outcome.converged,
                Outcome.not_reached,
                Outcome.already_unstable,
                Outcome.no_sliding_state,
            )
        ),
        **angles_of_one_pair,
        "t_end": Variable("end of each run", "s"),
        "bound": Variable("largest norm tried"),
    },
)
