"""Datasets of periodic motions of model A4: single orbits and backbones."""

from enum import IntEnum

from squealpipe.codes import SpecialPoint
from squealpipe.schema import (
    ORBIT_ENDS,
    RUN_ENDS,
    DatasetSchema,
    Outcome,
    Variable,
    count,
    flag,
    or_nan,
    outcome,
    text,
)
from squealpipe.systems.datasets.agreement import Listing


class Assumption(IntEnum):
    """Validity of A4's assumption that ẋ stays below the belt speed V."""

    broken = 0
    holds = 1


def _orbit_variables(*dims: str) -> dict[str, Variable]:
    """Return the variables of one periodic orbit, over some dimensions."""

    def real(units: str, long_name: str, **kwargs: object) -> Variable:
        return or_nan(dims=dims, units=units, long_name=long_name, **kwargs)  # type: ignore[arg-type]

    return {
        "omega": real("rad s-1", "angular frequency of the periodic motion"),
        "x_at_peak": real("m", "x at the symmetric instant with the larger y"),
        "x_amplitude": real("m", "half of the peak-to-peak of x over a period"),
        "y_amplitude": real("m", "half of the peak-to-peak of y over a period"),
        "largest_speed": real(
            "m s-1", "largest speed of the mass along the belt, |x'|"
        ),
        "sliding_assumption": flag(
            "whether x' stays below belt speed", Assumption, *dims
        ),
        "stability_index": real(
            "1", "trace of the monodromy matrix minus 2", atol=1e-7
        ),
        "outcome": outcome(*dims, among=ORBIT_ENDS),
    }


periodic_orbit_schema = DatasetSchema(
    name="periodic_orbit",
    title="An exact symmetric periodic motion of model A4",
    lists={"switch": Listing()},
    coordinates={"switch": count("switch of contact, in order", "switch")},
    variables={
        **_orbit_variables(),
        "y_peak": Variable("y at the symmetric instant", "m"),
        "mode": count("mode, by ascending frequency in contact"),
        "switching_times": Variable(
            "times in the half period after the peak at which contact begins or ends",
            "s",
            ("switch",),
        ),
        "time": Variable(
            "instant of a sample of the half period after the peak", "s", ("sample",)
        ),
        "x_path": Variable(
            "displacement along the belt from the peak on", "m", ("sample",)
        ),
        "y_path": Variable(
            "displacement away from the belt from the peak on", "m", ("sample",)
        ),
        "residual": or_nan(
            "largest velocity after half a period, over l_pre and the frequency unit",
            atol=1e-13,
        ),
    },
)

backbone_schema = DatasetSchema(
    name="backbone",
    title="A backbone of model A4: a family of free periodic motions",
    lists={
        "point": Listing(
            kinds=("outcome",), position="y_peak", fillers=(int(Outcome.converged),)
        ),
        "special": Listing(kinds=("special_kind",), position="special_y_peak"),
    },
    coordinates={
        "point": count("point along the branch", "point"),
        "special": count("located special point (exact branches)", "special"),
        "harmonic": count("harmonic of the motion", "harmonic", optional=True),
    },
    variables={
        **_orbit_variables("point"),
        "y_peak": Variable(
            "y at the symmetric instant with the larger y", "m", ("point",)
        ),
        "switches": count("switches of contact in half a period", "point"),
        "residual": or_nan(
            "residual of the method's equations, scaled", "1", ("point",), atol=1e-9
        ),
        "x_cosine": Variable(
            "cosine coefficients of x", "m", ("point", "harmonic"), optional=True
        ),
        "y_cosine": Variable(
            "cosine coefficients of y", "m", ("point", "harmonic"), optional=True
        ),
        "omega_exact": or_nan(
            "angular frequency of the exact orbit of equal y_peak",
            "rad s-1",
            ("point",),
            optional=True,
        ),
        "waveform_error": or_nan(
            "largest distance in (x, y) from the exact orbit of equal y_peak, at equal phase",
            "m",
            ("point",),
            optional=True,
            rtol=1e-4,
        ),
        "integration_error": or_nan(
            "largest distance in (x, y) from A4 integrated in time over one period from "
            "the peak of the series",
            "m",
            ("point",),
            optional=True,
            rtol=1e-4,
        ),
        "special_kind": flag("kind of special point", SpecialPoint, "special"),
        "special_y_peak": Variable(
            "y_peak at which it lies", "m", ("special",), rtol=1e-8
        ),
        "special_omega": Variable(
            "angular frequency there", "rad s-1", ("special",), rtol=1e-8
        ),
        "end": flag("why the branch ends", outcome(among=ORBIT_ENDS).flags),
    },
)

doubled_branch_schema = DatasetSchema(
    name="doubled_branch",
    title="Periodic motions of model A4 of doubled period, from a period doubling on",
    lists=backbone_schema.lists,
    coordinates={
        name: backbone_schema.coordinates[name] for name in ("point", "special")
    },
    variables={
        **{
            name: entry
            for name, entry in backbone_schema.variables.items()
            if not entry.optional
        },
        "end": flag(
            "why the branch ends",
            outcome(among=(*ORBIT_ENDS, Outcome.no_doubling)).flags,
        ),
        "y_largest": Variable("largest y over a period", "m", ("point",)),
        "first_integral": Variable(
            "first integral H of model A4", "N J m-1", ("point",)
        ),
        "doubling_omega": or_nan(
            "angular frequency of the simple orbit at the doubling", "rad s-1"
        ),
    },
)

scene_coordinate = {"scene": text("scene and mode", "scene")}


def _error(*dims: str, long_name: str, units: str = "rad s-1") -> Variable:
    return or_nan(long_name, units, dims, rtol=0.05, atol=1e-11)


class Form(IntEnum):
    """Form of the paper's residuals."""

    mended = 0
    as_printed = 1


harmonic_forms_schema = DatasetSchema(
    name="harmonic_forms",
    title="The paper's harmonic balance, corrected and as printed, against exact orbits",
    coordinates={
        **scene_coordinate,
        "form": Variable("Eq. (34)", dims=("form",), dtype="i4", flags=Form),
        "samples": count("samples N a period", "samples"),
    },
    variables={
        "omega": _error("scene", "form", long_name="angular frequency that was found"),
        "omega_exact": Variable(
            "angular frequency of the exact orbit", "rad s-1", ("scene",)
        ),
        "rank_deficit": count("columns minus rank of the Jacobian", "scene", "form"),
        "outcome": outcome(
            "scene", "form", among=(Outcome.converged, Outcome.no_convergence)
        ),
        "n_harmonics": count("harmonics N_h"),
        "fourier_columns": count("columns of Gamma, 2 N_h + 1"),
        "fourier_rank": count("rank of Gamma", "samples"),
        "phase_spread_y": _error(
            "samples",
            units="m",
            long_name="spread of the largest y over the phase of the start",
        ),
        "phase_spread_omega": _error(
            "samples", long_name="spread of omega over the phase of the start"
        ),
    },
)


a1_beside_a4_schema = DatasetSchema(
    name="a1_beside_a4",
    title="Model A1 in time, started on periodic motions of A4, for springs of several lengths",
    coordinates={
        **scene_coordinate,
        "length_ratio": Variable("spring length over l_pre", dims=("length_ratio",)),
        "period": Variable("time over the period of A4", dims=("period",)),
        "order": Variable("frequency over omega of A4", dims=("order",)),
    },
    variables={
        "omega": Variable("angular frequency of A4", "rad s-1", ("scene",)),
        "y_a4": Variable("y of A4", "m", ("scene", "period")),
        "y_a1": or_nan("y of A1", "m", ("scene", "length_ratio", "period"), rtol=1e-6),
        "spectrum_a4": Variable(
            "amplitude spectrum of y, A4", "m", ("scene", "order"), rtol=1e-6
        ),
        "spectrum_a1": or_nan(
            "amplitude spectrum of y, A1",
            "m",
            ("scene", "length_ratio", "order"),
            rtol=1e-3,
            atol=1e-6,
        ),
        "omega_a1": or_nan(
            "angular frequency of the largest line of y near omega of A4, A1",
            "rad s-1",
            ("scene", "length_ratio"),
            rtol=1e-4,
        ),
        "outcome": outcome("scene", "length_ratio", among=RUN_ENDS),
    },
)
