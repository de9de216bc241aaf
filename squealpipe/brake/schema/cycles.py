"""Datasets of limit cycles of the full model A1."""

from enum import IntEnum

from squealpipe.brake.schema.dynamics.runs import STATE_UNITS
from squealpipe.brake.schema.linear import angles_of_one_pair
from squealpipe.codes import Event
from squealpipe.parameters import Parameters
from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    flag,
    or_nan,
    outcome,
    text,
)
from squealpipe.systems.branch_labels import Label, Meeting
from squealpipe.systems.datasets.agreement import ComparedAs, Listing, RoundOff
from squealpipe.vibration.schema import regime_meanings


class Stability(IntEnum):
    """Fate of small disturbances of a cycle."""

    no = 0
    yes = 1


def _cycle_variables(*dims: str) -> dict[str, Variable]:
    """Return the variables of one cycle, over some dimensions."""

    def real(units: str, long_name: str) -> Variable:
        return or_nan(long_name, units, dims, rtol=1e-7, atol=1e-9)

    def multiplier(part: str) -> Variable:
        return or_nan(
            f"{part} part of the Floquet multipliers, the trivial one first",
            dims=(*dims, "multiplier"),
            rtol=1e-6,
            atol=1e-6,
        )

    return {
        "period": real("s", "period"),
        "x_min": real("m", "smallest x over the period"),
        "x_max": real("m", "largest x over the period"),
        "y_min": real("m", "smallest y over the period"),
        "y_max": real("m", "largest y over the period"),
        "contact_fraction": real("1", "share of the period in contact"),
        "stick_fraction": real("1", "share of the period in stick"),
        "least_contact_force": real(
            "N", "smallest contact force; 0 where contact is lost"
        ),
        "stable": flag(
            "whether small disturbances decay; no for a member of a family",
            Stability,
            *dims,
        ),
        "multiplier_real": multiplier("real"),
        "multiplier_imag": multiplier("imaginary"),
        "residual": real("1", "closing error over the extent of the cycle"),
        "outcome": outcome(*dims),
    }


multiplier_coordinate = count("number of the multiplier", "multiplier")

a1_limit_cycle_schema = DatasetSchema(
    name="limit_cycle",
    title="A periodic motion of model A1, events located, with its Floquet multipliers",
    coordinates={"multiplier": multiplier_coordinate},
    variables={
        **_cycle_variables(),
        "event_time": Variable(
            dims=("event",), units="s", long_name="instant of an event"
        ),
        "event_kind": flag("kind of the event", Event, "event"),
        **{
            f"event_{name}": Variable(f"{words} at the event", units, ("event",))
            for name, (units, words) in STATE_UNITS.items()
        },
        **{
            f"{name}_start": or_nan(f"{words} at time 0 of the cycle", units)
            for name, (units, words) in STATE_UNITS.items()
        },
        "time": Variable(dims=("sample",), units="s", long_name="instant of a sample"),
        **{
            f"{name}_path": Variable(f"{words} along the cycle", units, ("sample",))
            for name, (units, words) in STATE_UNITS.items()
        },
        "regime_path": flag("regime along the cycle", regime_meanings, "sample"),
        **angles_of_one_pair,
    },
)


def _followed() -> dict[str, Variable]:
    """Every quantity that a branch may be followed in, over the points."""
    table = {name: Parameters.units(name) for name in Parameters.__dataclass_fields__}
    return {
        name: Variable(
            f"{name} along the branch", units, ("point",), optional=True, rtol=1e-7
        )
        for name, units in {**table, "alpha1": "rad", "alpha2": "rad"}.items()
    }


a1_cycle_branch_schema = DatasetSchema(
    name="cycle_branch",
    title="A branch of periodic motions of model A1 in one parameter",
    lists={
        "point": Listing(
            kinds=("label",), position="x_max", fillers=(int(Label.regular),)
        )
    },
    coordinates={
        "multiplier": multiplier_coordinate,
        "point": count("point along the branch", "point"),
    },
    variables={
        **_cycle_variables("point"),
        "label": flag("what is special about the point", Label, "point"),
        "events": count(
            "events per period",
            "point",
            round_off=RoundOff(
                ComparedAs.most,
                "where a contact is just touched, round-off decides",
                share=0.5,
            ),
        ),
        **{
            f"{name}_start": or_nan(
                f"{words} at time 0 of the cycle",
                units,
                ("point",),
                round_off=RoundOff(
                    ComparedAs.unjudged,
                    "where on a cycle its description starts follows from the way on which it was "
                    "found",
                ),
            )
            for name, (units, words) in STATE_UNITS.items()
        },
        **_followed(),
        "end": outcome(),
    },
)

a1_cycle_curve_schema = DatasetSchema(
    name="cycle_curve",
    title="A curve of special periodic motions of model A1 in two parameters",
    coordinates={
        "point": count("point along the curve", "point"),
        "parameter": text("parameter that varies", "parameter"),
    },
    variables={
        **_followed(),
        "period": Variable("period", "s", ("point",), rtol=1e-7),
        "residual": Variable(
            "largest residual of the equations, without units",
            dims=("point",),
            rtol=1.0,
            atol=1e-8,
        ),
        "label": flag("what else happens at the point", Meeting, "point"),
        "events": count("events per period", "point"),
        "outcome": outcome(
            "side",
            among=(
                Outcome.converged,
                Outcome.point_limit,
                Outcome.branch_lost,
                Outcome.order_changes,
                Outcome.real_multipliers,
            ),
        ),
        "change": text(
            "what changes the order of the events where the curve ends", "side"
        ),
    },
)

settled_extremes_schema = DatasetSchema(
    name="settled_extremes",
    title="Largest displacement late in runs of model A1 from many starts",
    coordinates={
        "scene": text("scene", "scene"),
        "mu": Variable(dims=("mu",), long_name="friction coefficient"),
        "start": count("number of the start", "start"),
    },
    variables={
        "late_max_x": or_nan(
            "largest |x| in the last fifth of the run",
            "m",
            ("scene", "mu", "start"),
            rtol=1e-5,
        ),
        "outcome": outcome("scene", "mu", "start"),
        "t_end": Variable(units="s", long_name="length of the runs"),
    },
)
