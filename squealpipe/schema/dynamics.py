"""Datasets of the nonlinear models A1 and A4 in time."""

from __future__ import annotations

from enum import IntEnum

from squealpipe.schema import DatasetSchema, Variable, outcome
from squealpipe.schema.linear import ANGLES, MAP, REGIME_LINEAR


class RegimeFlag(IntEnum):
    """Meaning of regime."""

    slip_slower = 0
    slip_faster = 1
    stick = 2
    separated = 3
    not_reached = -1


class EventFlag(IntEnum):
    """Meaning of event_kind."""

    separation = 0
    contact = 1
    stick = 2
    slip = 3
    reversal = 4


class MotionFlag(IntEnum):
    """Meaning of motion."""

    perpetual_contact = 0
    stick_slip = 1
    periodic_hammering = 2
    irregular_hammering = 3
    whirl = 4


def _series(units: str, long_name: str, **more: object) -> Variable:
    return Variable(dims=("time",), units=units, long_name=long_name, nan_allowed=True, **more)  # type: ignore[arg-type]


TIME = Variable(dims=("time",), units="s", long_name="time")

SIMULATION = DatasetSchema(
    name="simulation",
    title="One nonlinear run from given initial conditions, events located",
    coordinates={"time": TIME},
    variables={
        "x": _series("m", "displacement along the belt"),
        "y": _series("m", "displacement away from the belt"),
        "vx": _series("m s-1", "velocity along the belt"),
        "vy": _series("m s-1", "velocity away from the belt"),
        "normal_force": _series("N", "contact force"),
        "normalized_contact_force": _series("1", "contact force over k3 l_pre"),
        "regime": Variable(dims=("time",), dtype="i1", flags=RegimeFlag, long_name="regime"),
        "event_time": Variable(dims=("event",), units="s", long_name="instant of a regime change"),
        "event_kind": Variable(
            dims=("event",), dtype="i1", flags=EventFlag, long_name="kind of regime change"
        ),
        "alpha1": Variable(units="rad", long_name="angle of spring 1"),
        "alpha2": Variable(units="rad", long_name="angle of spring 2"),
        "preload": Variable(units="m", long_name="precompression l_pre of the contact spring"),
        "length1": Variable(units="m", long_name="free length L1 of spring 1"),
        "length2": Variable(units="m", long_name="free length L2 of spring 2"),
        "time_reached": Variable(units="s", long_name="time at which the run ended"),
        "n_steps": Variable(dtype="i8", long_name="Taylor steps of the run"),
        "outcome": outcome(),
    },
)

VALIDITY_MAP = DatasetSchema(
    name="validity_map",
    title="Where model A1 keeps contact, and the regime of the linear model A3",
    coordinates=ANGLES,
    variables={
        "first_separation_time": Variable(
            dims=MAP,
            units="s",
            long_name="first loss of contact from rest (NaN: none before t_end)",
            nan_allowed=True,
        ),
        "separates": Variable(
            dims=MAP, dtype="bool", long_name="whether contact is lost before t_end"
        ),
        "regime_linear": REGIME_LINEAR,
        "response_growth": Variable(
            dims=MAP,
            long_name="largest |x| of the second half of a run over that of the first "
            "(NaN: separated)",
            nan_allowed=True,
        ),
        "t_end": Variable(units="s", long_name="end of each run"),
        "outcome": outcome(*MAP),
    },
)

HAMMERING_MAP = DatasetSchema(
    name="hammering_map",
    title="Impacts, forces and kind of motion of model A1 over both spring angles",
    coordinates=ANGLES,
    variables={
        "impact_rate": Variable(
            dims=MAP, units="s-1", long_name="returns to the belt per unit of time"
        ),
        "separated_fraction": Variable(dims=MAP, long_name="share of the time off the belt"),
        "peak_contact_force": Variable(
            dims=MAP, long_name="largest contact force over the preload k3 l_pre"
        ),
        "stick_fraction": Variable(dims=MAP, long_name="share of the time sticking to the belt"),
        "max_displacement": Variable(
            dims=MAP, units="m", long_name="largest distance from the start position"
        ),
        "turns": Variable(dims=MAP, long_name="net turns around both fixed ends"),
        "lyapunov_exponent": Variable(
            dims=MAP, units="s-1", long_name="finite-time growth rate of a small perturbation"
        ),
        "predictability_horizon": Variable(
            dims=MAP,
            units="s",
            long_name="time at which an error of tol has grown to l_pre/1000 (t_end: not before)",
        ),
        "motion": Variable(dims=MAP, dtype="i1", flags=MotionFlag, long_name="kind of motion"),
        "t_end": Variable(units="s", long_name="end of each run"),
        "outcome": outcome(*MAP),
    },
)

REFINED_VALIDITY_MAP = DatasetSchema(
    name="refined_validity_map",
    title="Where model A1 keeps contact, computed only where the answer changes",
    coordinates=ANGLES,
    variables={
        "separates": Variable(
            dims=MAP, dtype="bool", long_name="whether contact is lost before t_end"
        ),
        "first_separation_time": Variable(
            dims=MAP,
            units="s",
            long_name="first loss of contact from rest (NaN: none before t_end, or not computed)",
            nan_allowed=True,
        ),
        "computed": Variable(
            dims=MAP, dtype="bool", long_name="whether the cell was run, not inherited"
        ),
        "t_end": Variable(units="s", long_name="end of each run"),
        "outcome": outcome(*MAP),
    },
)

REFINEMENT_CHECK = DatasetSchema(
    name="refinement_check",
    title="The refined map against uniform ones: runs and cells",
    coordinates={
        "points": Variable(dims=("points",), dtype="i4", long_name="points a side, uniform map")
    },
    variables={
        "runs": Variable(dims=("points",), dtype="i8", long_name="runs of the uniform map"),
        "different_cells": Variable(
            dims=("points",),
            dtype="i8",
            long_name="cells of the uniform map that the refined one labels otherwise",
        ),
        "missed_regions": Variable(
            dims=("points",),
            dtype="i8",
            long_name="connected regions of the uniform map that the refined one lacks",
        ),
        "wrong_share": Variable(
            dims=("points",),
            long_name="share of the refined cells that the nearest uniform cell labels otherwise",
        ),
        "refined_runs": Variable(dtype="i8", long_name="runs of the refined map"),
        "refined_points": Variable(dtype="i4", long_name="points a side, refined map"),
    },
)

WHIRL = DatasetSchema(
    name="whirl",
    title="Where the growth at (0.4 pi, 0.6 pi) ends, over belt speed",
    coordinates={
        "belt_speed": Variable(dims=("belt_speed",), units="m s-1", long_name="belt speed V")
    },
    variables={
        "amplitude": Variable(
            dims=("belt_speed",), units="m", long_name="largest |x| in the last fifth of the run"
        ),
        "amplitude_before": Variable(
            dims=("belt_speed",), units="m", long_name="largest |x| before the last fifth"
        ),
        "max_vx": Variable(
            dims=("belt_speed",), units="m s-1", long_name="largest velocity along the belt"
        ),
        "turn_rate": Variable(
            dims=("belt_speed",), units="s-1", long_name="net turns around both fixed ends a time"
        ),
        "stick_fraction": Variable(
            dims=("belt_speed",), long_name="share of the time sticking to the belt"
        ),
        "motion": Variable(
            dims=("belt_speed",), dtype="i1", flags=MotionFlag, long_name="kind of motion"
        ),
        "fitted": Variable(
            dims=("belt_speed",), dtype="bool", long_name="whether the speed is in the fit"
        ),
        "slope": Variable(
            units="s", long_name="fitted growth of the amplitude with V", nan_allowed=True
        ),
        "offset": Variable(units="m", long_name="fitted amplitude at V = 0", nan_allowed=True),
        "fit_outcome": outcome(),
        "energy_slope": Variable(
            units="s", long_name="sqrt(m/(k1 + k2)): the slope if the top speed were V"
        ),
        "energy_offset": Variable(
            units="m", long_name="far end of the unstretched springs: the offset if so"
        ),
        "t_end": Variable(units="s", long_name="end of each run"),
        "outcome": outcome("belt_speed"),
    },
)

_ESCAPE = ("belt_speed", "sample")
TRANSIENT = DatasetSchema(
    name="transient",
    title="How long the bounded motion at (0.2 pi, 0.8 pi) lasts",
    coordinates={
        "belt_speed": Variable(dims=("belt_speed",), units="m s-1", long_name="belt speed V"),
        "sample": Variable(dims=("sample",), dtype="i4", long_name="number of the perturbation"),
    },
    variables={
        "start_x": Variable(dims=("sample",), units="m", long_name="x at the start"),
        "lifetime": Variable(
            dims=_ESCAPE,
            units="s",
            long_name="time of the tenth net turn around both fixed ends (NaN: not before t_end)",
            nan_allowed=True,
        ),
        "max_displacement": Variable(
            dims=_ESCAPE, units="m", long_name="largest distance from the start position until then"
        ),
        "shown_start_x": Variable(
            dims=("shown_sample",), units="m", long_name="x at the start, at the speed shown"
        ),
        "shown_lifetime": Variable(
            dims=("shown_sample",),
            units="s",
            long_name="lifetimes at the study's own belt speed (NaN: not before t_end)",
            nan_allowed=True,
        ),
        "shown_belt_speed": Variable(units="m s-1", long_name="the study's own belt speed"),
        "t_end": Variable(units="s", long_name="end of each run"),
        "outcome": outcome(*_ESCAPE),
        "shown_outcome": outcome("shown_sample"),
    },
)
