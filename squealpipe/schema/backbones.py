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


class Special(IntEnum):
    """What happens at a special point of a branch."""

    period_doubling = 0
    index_two = 1
    fold = 2


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
        "special": Variable(
            dims=("special",), dtype="i4", long_name="located special point (exact branches)"
        ),
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
        "special_kind": Variable(
            dims=("special",), dtype="i1", flags=Special, long_name="kind of special point"
        ),
        "special_y_peak": Variable(
            dims=("special",), units="m", long_name="y_peak at which it lies", rtol=1e-8
        ),
        "special_omega": Variable(
            dims=("special",), units="rad s-1", long_name="angular frequency there", rtol=1e-8
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

SCENE = {"scene": Variable(dims=("scene",), dtype="U", long_name="scene and mode")}
_SWEEP = ("scene", "peak", "harmonics")


def _error(*dims: str, long_name: str, units: str = "rad s-1") -> Variable:
    return Variable(
        dims=dims, units=units, long_name=long_name, nan_allowed=True, rtol=0.05, atol=1e-11
    )


def _rate(*dims: str, long_name: str) -> Variable:
    return Variable(dims=dims, long_name=long_name, nan_allowed=True, rtol=0.05)


HARMONIC_SWEEP = DatasetSchema(
    name="harmonic_sweep",
    title="Errors of harmonic balance against exact orbits over N_h, N, sigma and amplitude",
    coordinates={
        **SCENE,
        "peak": Variable(dims=("peak",), long_name="y_peak over l_pre"),
        "harmonics": Variable(dims=("harmonics",), dtype="i4", long_name="harmonics N_h"),
        "samples": Variable(dims=("samples",), dtype="i4", long_name="samples N a period"),
        "sigma": Variable(dims=("sigma",), long_name="regularizing factor times l_pre"),
    },
    variables={
        "omega_error": _error(*_SWEEP, long_name="error of omega at equal y_peak"),
        "omega_error_first": _error(*_SWEEP, long_name="error of omega at equal first harmonic"),
        "waveform_error": _error(
            *_SWEEP, units="m", long_name="largest distance in (x, y) at equal y_peak and phase"
        ),
        "omega_error_samples": _error(
            "scene", "peak", "samples", long_name="error of omega with a sampled contact force"
        ),
        "omega_error_sigma": _error(
            "scene", "peak", "sigma", long_name="shift of omega by tanh smoothing"
        ),
        "omega_rate": _rate("scene", "peak", long_name="exponent p of omega error ~ N_h^-p"),
        "waveform_rate": _rate("scene", "peak", long_name="exponent p of waveform error ~ N_h^-p"),
        "sigma_rate": _rate("scene", "peak", long_name="exponent p of the shift ~ sigma^-p"),
        "n_harmonics_fixed": Variable(dtype="i4", long_name="N_h while N or sigma is varied"),
        "outcome": outcome(*_SWEEP),
    },
)


class Form(IntEnum):
    """Form of the paper's residuals."""

    mended = 0
    as_printed = 1


HARMONIC_FORMS = DatasetSchema(
    name="harmonic_forms",
    title="The paper's harmonic balance, mended and as printed, against exact orbits",
    coordinates={
        **SCENE,
        "form": Variable(dims=("form",), dtype="i4", flags=Form, long_name="Eq. (34)"),
        "samples": Variable(dims=("samples",), dtype="i4", long_name="samples N a period"),
    },
    variables={
        "omega": _error("scene", "form", long_name="angular frequency that was found"),
        "omega_exact": Variable(
            dims=("scene",), units="rad s-1", long_name="angular frequency of the exact orbit"
        ),
        "y_largest": _error("scene", "form", units="m", long_name="largest y of the series"),
        "y_peak": Variable(units="m", long_name="y_peak of the exact orbit it starts from"),
        "residual": Variable(
            dims=("scene", "form"), long_name="largest residual, scaled", rtol=1.0, atol=1e-9
        ),
        "rank_deficit": Variable(
            dims=("scene", "form"), dtype="i4", long_name="columns minus rank of the Jacobian"
        ),
        "outcome": outcome("scene", "form"),
        "n_harmonics": Variable(dtype="i4", long_name="harmonics N_h"),
        "fourier_columns": Variable(dtype="i4", long_name="columns of Gamma, 2 N_h + 1"),
        "fourier_rank": Variable(dims=("samples",), dtype="i4", long_name="rank of Gamma"),
        "phase_spread_y": _error(
            "samples", units="m", long_name="spread of the largest y over the phase of the start"
        ),
        "phase_spread_omega": _error(
            "samples", long_name="spread of omega over the phase of the start"
        ),
    },
)


A1_BESIDE_A4 = DatasetSchema(
    name="a1_beside_a4",
    title="Model A1 in time, started on periodic motions of A4, for springs of several lengths",
    coordinates={
        **SCENE,
        "length_ratio": Variable(dims=("length_ratio",), long_name="spring length over l_pre"),
        "period": Variable(dims=("period",), long_name="time over the period of A4"),
        "order": Variable(dims=("order",), long_name="frequency over omega of A4"),
    },
    variables={
        "omega": Variable(dims=("scene",), units="rad s-1", long_name="angular frequency of A4"),
        "y_a4": Variable(dims=("scene", "period"), units="m", long_name="y of A4"),
        "y_a1": Variable(
            dims=("scene", "length_ratio", "period"),
            units="m",
            long_name="y of A1",
            nan_allowed=True,
            rtol=1e-6,
        ),
        "spectrum_a4": Variable(
            dims=("scene", "order"), units="m", long_name="amplitude spectrum of y, A4", rtol=1e-6
        ),
        "spectrum_a1": Variable(
            dims=("scene", "length_ratio", "order"),
            units="m",
            long_name="amplitude spectrum of y, A1",
            nan_allowed=True,
            rtol=1e-3,
            atol=1e-6,
        ),
        "omega_a1": Variable(
            dims=("scene", "length_ratio"),
            units="rad s-1",
            long_name="angular frequency of the largest line of y near omega of A4, A1",
            nan_allowed=True,
            rtol=1e-4,
        ),
        "y_peak": Variable(units="m", long_name="y at the symmetric instant"),
        "outcome": outcome("scene", "length_ratio"),
    },
)
