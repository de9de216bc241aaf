"""Datasets of the nonlinear models A1 and A4 in time."""

from dataclasses import replace
from enum import IntEnum
from typing import Any

from squealpipe.brake.schema.dynamics.extremes import EXTREMES
from squealpipe.brake.schema.linear import (
    MAP,
    angle_coordinates,
    angles_of_one_pair,
    linear_regime_of_map,
)
from squealpipe.codes import Event
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
from squealpipe.systems.datasets.agreement import ComparedAs, Listing, RoundOff
from squealpipe.vibration.schema import regime_meanings


class MotionFlag(IntEnum):
    """Kind of motion, judged from the second half of the run."""

    contact_kept = 0
    stick_slip = 1
    periodic_hammering = 2
    irregular_hammering = 3
    whirl = 4
    undetermined = 5
    quasi_periodic_hammering = 6
    at_rest = 7
    hammered_then_contact = 8
    unsettled = 9


_grown_round_off = RoundOff(
    ComparedAs.grown, "an error of the last digit grows along the run", by="growth"
)

IN_MAP: dict[str, Any] = {
    "rtol": 1e-5,
    "atol": 1e-7,
    "round_off": RoundOff(
        ComparedAs.beyond_horizon,
        "beyond its predictability horizon a run follows the last digits of its start, which "
        "differ from machine to machine",
        by="outcome",
    ),
}
"""Up to the horizon an error of the last digit may have grown to nearly l_pre/1000."""


STATE_UNITS = {
    "x": ("m", "x"),
    "y": ("m", "y"),
    "vx": ("m s-1", "velocity along the belt"),
    "vy": ("m s-1", "velocity away from the belt"),
}
"""Unit of each state and words for it."""
motion_label = flag("kind of motion in the second half of the run", MotionFlag)
motion_label_changes = whether("whether the quarters of that half have other labels")
first_return_force = or_nan(
    "largest contact force after the first return to the belt, over k3 l_pre (NaN: no return)"
)
largest_impact_speed = or_nan(
    "largest speed towards the belt at a return to it (NaN: no return)", "m s-1"
)


def _series(units: str, long_name: str) -> Variable:
    return or_nan(long_name, units, ("time",), round_off=_grown_round_off)


def _extremes_between() -> dict[str, Variable]:
    """Extremes between the instants, which files of version 1.0.0 have not."""
    units = {"x": "m", "y": "m", "vx": "m s-1", "normalized_contact_force": "1"}
    return {
        f"{name}_{end}": or_nan(
            f"{words} {name} since the instant before, by the integrator's series",
            units[name],
            ("time",),
            optional=True,
            round_off=_grown_round_off,
        )
        for name in EXTREMES
        for end, words in (("min", "smallest"), ("max", "largest"))
    }


time_coordinate = Variable("time", "s", ("time",))
angular_frequency_coordinate = Variable("angular frequency", "rad s-1", ("frequency",))

simulation_schema = DatasetSchema(
    name="simulation",
    title="One nonlinear run from given initial conditions, events located",
    lists={"event": Listing(kinds=("event_kind",))},
    coordinates={"time": time_coordinate},
    variables={
        "x": _series("m", "displacement along the belt"),
        "y": _series("m", "displacement away from the belt"),
        "vx": _series("m s-1", "velocity along the belt"),
        "vy": _series("m s-1", "velocity away from the belt"),
        "normal_force": _series("N", "contact force"),
        "normalized_contact_force": _series("1", "contact force over k3 l_pre"),
        **_extremes_between(),
        "regime": flag("regime", regime_meanings, "time"),
        "event_time": Variable(
            "instant of a regime change", "s", ("event",), round_off=_grown_round_off
        ),
        "event_kind": flag("kind of regime change", Event, "event"),
        **angles_of_one_pair,
        "preload": Variable("precompression l_pre of the contact spring", "m"),
        "length1": Variable("free length L1 of spring 1", "m"),
        "length2": Variable("free length L2 of spring 2", "m"),
        "time_reached": Variable("time at which the run ended", "s"),
        "n_steps": count("Taylor steps of the run", dtype="i8"),
        "return_peak_contact_force": replace(
            first_return_force, round_off=_grown_round_off
        ),
        "impact_speed": replace(largest_impact_speed, round_off=_grown_round_off),
        "max_displacement": Variable(
            "largest distance from the origin",
            "m",
            optional=True,
            round_off=_grown_round_off,
        ),
        "growth": or_nan(
            "factor by which a small perturbation of the start has grown at the end",
            optional=True,
            round_off=RoundOff(
                ComparedAs.magnitude,
                "at the end of a long run it is itself a result of errors",
            ),
        ),
        "outcome": outcome(among=RUN_ENDS),
    },
)

run_summary_schema = DatasetSchema(
    name="run_summary",
    title="Summary of one run",
    lists={"peak": Listing()},
    coordinates={
        "frequency": angular_frequency_coordinate,
        "peak": count("peak of the spectrum, by height", "peak"),
    },
    variables={
        "first_separation_time": or_nan("time of the first loss of contact", "s"),
        "impact_rate": Variable("contacts regained per time", "s-1"),
        "separated_fraction": Variable("share of the time without contact"),
        "stick_fraction": Variable("share of the time in stick"),
        "peak_contact_force": Variable("largest contact force over k3 l_pre"),
        "return_peak_contact_force": first_return_force,
        "impact_speed": largest_impact_speed,
        "largest_x": Variable("largest |x|", "m"),
        "largest_y": Variable("largest |y|", "m"),
        "force_spectrum": Variable(
            "amplitude spectrum of the normalized contact force", dims=("frequency",)
        ),
        "dominant_frequency": Variable(
            "angular frequencies of its highest peaks", "rad s-1", ("peak",)
        ),
        "dominant_amplitude": Variable("heights of these peaks", dims=("peak",)),
        "outcome": outcome(among=RUN_ENDS),
    },
)

spectrum_schema = DatasetSchema(
    name="spectrum",
    title="Amplitude spectra of one run",
    lists={"peak": Listing()},
    coordinates={
        "frequency": Variable("frequency", "Hz", ("frequency",)),
        "peak": count("line of the contact force, by height", "peak"),
    },
    variables={
        "velocity_along": Variable(
            "amplitude of the velocity along the belt", "m s-1", ("frequency",)
        ),
        "velocity_across": Variable(
            "amplitude of the velocity away from the belt", "m s-1", ("frequency",)
        ),
        "contact_force": Variable(
            "amplitude of the contact force", "N", ("frequency",)
        ),
        "peak_frequency": Variable("frequency of a line", "Hz", ("peak",)),
        "peak_force": Variable("its height", "N", ("peak",)),
        "resolution": Variable(
            "smallest distance between lines that can be told apart", "Hz"
        ),
        "outcome": outcome(among=RUN_ENDS),
    },
)


validity_map_schema = DatasetSchema(
    name="validity_map",
    title="Where model A1 keeps contact, and the regime of the linear model A3",
    coordinates=angle_coordinates,
    variables={
        "first_separation_time": or_nan(
            "first loss of contact from rest (NaN: none before t_end)", "s", MAP
        ),
        "separates": whether("whether contact is lost before t_end", *MAP),
        "regime_linear": linear_regime_of_map,
        "response_growth": or_nan(
            "largest |x| of the second half of a run over that of the first (NaN: separated)",
            dims=MAP,
        ),
        "t_end": Variable("end of each run", "s"),
        "outcome": outcome(*MAP, among=(*RUN_ENDS, Outcome.separated)),
    },
)


hammering_map_schema = DatasetSchema(
    name="hammering_map",
    title="Impacts, forces and kind of motion of model A1 over both spring angles",
    coordinates=angle_coordinates,
    variables={
        "impact_rate": Variable(
            "returns to the belt per unit of time", "s-1", MAP, **IN_MAP
        ),
        "separated_fraction": Variable(
            "share of the time off the belt", dims=MAP, **IN_MAP
        ),
        "peak_contact_force": Variable(
            "largest contact force over the preload k3 l_pre", dims=MAP, **IN_MAP
        ),
        "return_peak_contact_force": replace(first_return_force, dims=MAP, **IN_MAP),
        "impact_speed": replace(largest_impact_speed, dims=MAP, **IN_MAP),
        "stick_fraction": Variable(
            "share of the time sticking to the belt", dims=MAP, **IN_MAP
        ),
        "max_displacement": Variable(
            "largest distance from the start position", "m", MAP, **IN_MAP
        ),
        "turns": Variable("net turns around both fixed ends", dims=MAP, **IN_MAP),
        "lyapunov_exponent": or_nan(
            "finite-time growth rate of a small perturbation", "s-1", MAP, **IN_MAP
        ),
        "predictability_horizon": Variable(
            "time at which an error of tol has grown to l_pre/1000 (t_end: not before)",
            "s",
            MAP,
            rtol=1e-6,
        ),
        "motion": replace(motion_label, dims=MAP, **IN_MAP),
        "motion_changed": replace(motion_label_changes, dims=MAP, **IN_MAP),
        "t_end": Variable("end of each run", "s"),
        "outcome": outcome(*MAP, among=(*RUN_ENDS, Outcome.beyond_horizon)),
    },
)

refined_validity_map_schema = DatasetSchema(
    name="refined_validity_map",
    title="Where model A1 keeps contact, computed only where the answer changes",
    coordinates=angle_coordinates,
    variables={
        "separates": whether("whether contact is lost before t_end", *MAP),
        "first_separation_time": or_nan(
            "first loss of contact from rest (NaN: none before t_end, or not computed)",
            "s",
            MAP,
        ),
        "computed": whether("whether the cell was run, not inherited", *MAP),
        "inherited_checked": count(
            "inherited cells of a random sample that were run", dtype="i8"
        ),
        "inherited_wrong": count(
            "of these, cells that were wrong (put right since)", dtype="i8"
        ),
        "inherited_error_interval": or_nan(
            "95 % Wilson interval of the share of inherited cells that are wrong (NaN: no sample)",
            dims=("end",),
        ),
        "t_end": Variable("end of each run", "s"),
        "outcome": outcome(
            *MAP, among=(*RUN_ENDS, Outcome.separated, Outcome.inherited)
        ),
    },
)
