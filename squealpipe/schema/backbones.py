"""Datasets of periodic motions of model A4: single orbits, backbones, the atlas."""

from __future__ import annotations

from enum import IntEnum

from squealpipe.schema import DatasetSchema, Variable, outcome
from squealpipe.schema.linear import ANGLES, MAP, MODES


class Assumption(IntEnum):
    """Whether ẋ stays below the belt speed V, as A4 needs."""

    broken = 0
    holds = 1


class Route(IntEnum):
    """How the orbit of an atlas cell was reached."""

    none = 0
    linear_mode = 1
    neighbour = 2


def _orbit_variables(*dims: str) -> dict[str, Variable]:
    """What one periodic orbit carries, over some dimensions."""

    def real(units: str, long_name: str, **kwargs: object) -> Variable:
        return Variable(dims=dims, units=units, long_name=long_name, nan_allowed=True, **kwargs)  # type: ignore[arg-type]

    return {
        "omega": real("rad s-1", "angular frequency of the periodic motion"),
        "x_at_peak": real("m", "x at the symmetric instant with the larger y"),
        "x_amplitude": real("m", "half of the peak-to-peak of x over a period"),
        "y_amplitude": real("m", "half of the peak-to-peak of y over a period"),
        "largest_speed": real("m s-1", "largest speed of the mass along the belt, |x'|"),
        "sliding_assumption": Variable(
            dims=dims, dtype="i1", flags=Assumption, long_name="whether x' stays below belt speed"
        ),
        "stability_index": real("1", "trace of the monodromy matrix minus 2", atol=1e-7),
        "outcome": outcome(*dims),
    }


PERIODIC_ORBIT = DatasetSchema(
    name="periodic_orbit",
    title="An exact symmetric periodic motion of model A4",
    coordinates={
        "switch": Variable(dims=("switch",), dtype="i4", long_name="switch of contact, in order")
    },
    variables={
        **_orbit_variables(),
        "y_peak": Variable(units="m", long_name="y at the symmetric instant"),
        "mode": Variable(dtype="i4", long_name="mode, by ascending frequency in contact"),
        "switching_times": Variable(
            dims=("switch",),
            units="s",
            long_name="times in the half period after the peak at which contact begins or ends",
        ),
        "residual": Variable(
            units="1",
            long_name="largest velocity after half a period, over l_pre and the frequency unit",
            nan_allowed=True,
            atol=1e-13,
        ),
    },
)

BACKBONE = DatasetSchema(
    name="backbone",
    title="A backbone of model A4: a family of free periodic motions",
    coordinates={
        "point": Variable(dims=("point",), dtype="i4", long_name="point along the branch"),
        "harmonic": Variable(
            dims=("harmonic",), dtype="i4", long_name="harmonic of the motion", optional=True
        ),
    },
    variables={
        **_orbit_variables("point"),
        "y_peak": Variable(
            dims=("point",), units="m", long_name="y at the symmetric instant with the larger y"
        ),
        "switches": Variable(
            dims=("point",), dtype="i4", long_name="switches of contact in half a period"
        ),
        "residual": Variable(
            dims=("point",),
            units="1",
            long_name="residual of the method's equations, scaled",
            nan_allowed=True,
            atol=1e-9,
        ),
        "x_cosine": Variable(
            dims=("point", "harmonic"),
            units="m",
            long_name="cosine coefficients of x",
            optional=True,
        ),
        "y_cosine": Variable(
            dims=("point", "harmonic"),
            units="m",
            long_name="cosine coefficients of y",
            optional=True,
        ),
        "omega_exact": Variable(
            dims=("point",),
            units="rad s-1",
            long_name="angular frequency of the exact orbit of equal y_peak",
            nan_allowed=True,
            optional=True,
        ),
        "waveform_error": Variable(
            dims=("point",),
            units="m",
            long_name="largest distance in (x, y) from the exact orbit of equal y_peak, "
            "at equal phase",
            nan_allowed=True,
            optional=True,
            rtol=1e-4,
        ),
        "integration_error": Variable(
            dims=("point",),
            units="m",
            long_name="largest distance in (x, y) from A4 integrated in time over one period from "
            "the peak of the series",
            nan_allowed=True,
            optional=True,
            rtol=1e-4,
        ),
        "end": Variable(dtype="i1", flags=outcome().flags, long_name="why the branch ends"),
    },
)

ORBIT_ATLAS = DatasetSchema(
    name="orbit_atlas",
    title="Angular frequency of both modes at one y_peak over both spring angles",
    coordinates={**ANGLES, **MODES},
    variables={
        "omega": Variable(
            dims=(*MAP, "mode"),
            units="rad s-1",
            long_name="angular frequency of the periodic motion",
            nan_allowed=True,
        ),
        "stability_index": Variable(
            dims=(*MAP, "mode"),
            long_name="trace of the monodromy matrix minus 2",
            nan_allowed=True,
            atol=1e-7,
        ),
        "outcome": outcome(*MAP, "mode"),
        "route": Variable(
            dims=(*MAP, "mode"),
            dtype="i1",
            flags=Route,
            long_name="whether the branch leads here or a neighbouring cell's orbit",
        ),
        "y_peak": Variable(units="m", long_name="y at the symmetric instant"),
    },
)
