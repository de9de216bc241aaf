"""The dataset that answers: verdict, cause, frequency, level, and what stops it."""

from enum import IntEnum

from squealpipe.brake.schema.dynamics.runs import REGIMES
from squealpipe.brake.schema.linear import ANGLES, MAP, MODES, ONE_PAIR
from squealpipe.codes import Verdict
from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    flag,
    or_nan,
    outcome,
    text,
    whether,
)

SAMPLES = 800
"""Instants of the settled motion that a dataset keeps."""
LINES = 3200
"""Lines of its spectrum."""
HARMONICS = 5
KICKS = ((0.0, 1.0), (-1.0, -0.5), (1.0, 2.0))
"""Velocities of strikes along and across the belt, over l_pre √((k1 + k2)/2m)."""


class Mechanism(IntEnum):
    """Why steady sliding is unstable."""

    none = 0
    falling_friction = 1
    flutter = 2
    divergence = 3
    no_sliding_state = 4


CURES = {
    "mu": "1",
    "k3": "N m-1",
    "k1": "N m-1",
    "k2": "N m-1",
    "alpha1": "rad",
    "alpha2": "rad",
    "damping": "1",
    "preload": "m",
    "belt_speed": "m s-1",
}
"""What is changed one at a time, and its unit."""
STARTS = {"": "steady sliding, pushed", "sudden_": "rest under the whole preload"}
"""Prefix of the scalars of a start, and that start."""

MEAN_SQUARES = ("velocity_rms_along", "velocity_rms_across")
MEANS = (*MEAN_SQUARES, "impact_rate", "separated_fraction", "stick_fraction")
WITH_ERROR = ("frequency", *MEANS)
"""Scalars of a settled motion that have a statistical error where it does not repeat."""


def error_of(name: str) -> str:
    """The variable that holds the statistical error of another one."""
    return f"{name}_error"


def _of_motion(prefix: str, start: str) -> dict[str, Variable]:
    """The scalars of what one start settles to."""

    def real(long_name: str, units: str = "1", rtol: float = 2e-2) -> Variable:
        return or_nan(f"{long_name}, from {start}", units, rtol=rtol, atol=1e-6)

    scalars = {
        "verdict": flag(f"what becomes of {start}", Verdict),
        "periodic": whether(f"whether the settled motion repeats, from {start}"),
        "frequency": real("strongest line of the velocity", "Hz", 1e-2),
        "velocity_rms_along": real("rms velocity along the belt", "m s-1"),
        "velocity_rms_across": real("rms velocity across the belt", "m s-1"),
        "displacement_peak": real("largest distance from the mean position", "m"),
        "peak_contact_force": real("largest contact force", "N"),
        "peak_contact_force_over_preload": real("largest contact force over preload"),
        "impact_speed": real("largest speed towards the belt at a return", "m s-1"),
        "impact_rate": real("returns to the belt per time", "s-1"),
        "separated_fraction": real("share of the time without contact"),
        "stick_fraction": real("share of the time in stick"),
        "settled_by": real("time by which the motion had settled", "s", 1e-6),
    }
    scalars |= {
        error_of(name): or_nan(
            f"statistical error (95 %, frequency: scatter) of {name}, from {start}; "
            "0 where the motion repeats",
            scalars[name].units,
            volatile=True,
            optional=True,
        )
        for name in WITH_ERROR
    }
    return {f"{prefix}{name}": entry for name, entry in scalars.items()}


def _path(long_name: str, units: str) -> Variable:
    return or_nan(
        f"{long_name} of the settled motion", units, ("sample",), volatile=True
    )


ASSESS = DatasetSchema(
    name="assess",
    title="Whether a brake squeals or hammers, why, how loud, and what stops it",
    coordinates={"cure": text("what is changed, by ascending change", "cure"), **MODES},
    variables={
        **_of_motion("", STARTS[""]),
        **_of_motion("sudden_", STARTS["sudden_"]),
        "mechanism": flag("why steady sliding is unstable", Mechanism),
        "quiet_unless_struck": whether(
            "quiet from steady sliding, but another motion exists beside it"
        ),
        "growth_rate": or_nan("growth rate of small motions by model A3", "s-1"),
        "mode_frequency": or_nan("frequencies of model A3", "Hz", ("mode",)),
        "sliding_growth_rate": or_nan(
            "growth rate of small motions of A1 about its steady sliding", "s-1"
        ),
        "x_sliding": or_nan("x of steady sliding", "m"),
        "y_sliding": or_nan("y of steady sliding", "m"),
        "sliding_force": or_nan("contact force of steady sliding", "N"),
        "frequency_resolution": or_nan("resolution of the spectrum", "Hz"),
        "harmonic_frequency": or_nan(
            "multiples of the strongest line", "Hz", ("harmonic",), rtol=1e-2
        ),
        "harmonic_velocity": or_nan(
            "velocity amplitude there", "m s-1", ("harmonic",), rtol=5e-2, atol=1e-3
        ),
        "line_frequency": or_nan("frequency of the spectrum", "Hz", ("line",)),
        "velocity_spectrum_along": or_nan(
            "amplitude of the velocity along the belt",
            "m s-1",
            ("line",),
            volatile=True,
        ),
        "velocity_spectrum_across": or_nan(
            "amplitude of the velocity across the belt",
            "m s-1",
            ("line",),
            volatile=True,
        ),
        "force_spectrum": or_nan(
            "amplitude of the contact force over preload", "1", ("line",), volatile=True
        ),
        "path_time": _path("time", "s"),
        "path_x": _path("displacement along the belt", "m"),
        "path_y": _path("displacement across the belt", "m"),
        "path_force": _path("contact force over preload", "1"),
        "path_regime": flag(
            "regime of the settled motion", REGIMES, "sample", volatile=True
        ),
        "value": or_nan(
            "present value (of mu: the coefficient at belt speed)", dims=("cure",)
        ),
        "unit": text("unit of the values", "cure"),
        "quiet_from": or_nan(
            "nearest value at which the verdict changes between quiet and not",
            dims=("cure",),
            rtol=2e-3,
        ),
        "quiet_from_any_start": or_nan(
            "the same, for the verdict from any start that was tried",
            dims=("cure",),
            rtol=2e-2,
        ),
        **{
            f"quiet_{end}": or_nan(
                f"{end}er end of each interval of values that are quiet after a push, the "
                "nearest first; the end of the range searched where quiet does not end there",
                dims=("cure", "interval"),
                rtol=2e-3,
                optional=True,
            )
            for end in ("low", "high")
        },
        "change": or_nan(
            "change from the present value to quiet_from, in per cent (angles: degrees)",
            dims=("cure",),
            rtol=2e-2,
        ),
        "change_any_start": or_nan(
            "change from the present value to quiet_from_any_start",
            dims=("cure",),
            rtol=5e-2,
        ),
        "quiet_alpha1": or_nan(
            "alpha1 of the nearest quiet pair of angles that was found",
            "rad",
            rtol=1e-2,
        ),
        "quiet_alpha2": or_nan("alpha2 of that pair", "rad", rtol=1e-2),
        "lowest_tried": or_nan(
            "lower end of the range that was searched", dims=("cure",)
        ),
        "highest_tried": or_nan("upper end of that range", dims=("cure",)),
        "snaps_from": or_nan(
            "nearest value at which steady sliding of a quiet brake snaps to another place",
            dims=("cure",),
            rtol=2e-3,
            optional=True,
        ),
        "snap_distance": or_nan(
            "distance between both places", "m", ("cure",), rtol=2e-2, optional=True
        ),
        **ONE_PAIR,
        "preload": Variable("precompression l_pre of the contact spring", "m"),
        "outcome": outcome(
            among=(Outcome.converged, Outcome.unresolved, Outcome.no_sliding_state)
        ),
    },
)

VERDICT_MAP = DatasetSchema(
    name="verdict_map",
    title="Whether a brake squeals or hammers, over both spring angles",
    coordinates=ANGLES,
    variables={
        "verdict": flag("what becomes of steady sliding, pushed", Verdict, *MAP),
        "mechanism": flag("why steady sliding is unstable", Mechanism, *MAP),
        "sliding_growth_rate": or_nan(
            "growth rate of small motions of A1 about its steady sliding", "s-1", MAP
        ),
        "outcome": outcome(
            *MAP,
            among=(Outcome.converged, Outcome.unresolved, Outcome.no_sliding_state),
        ),
    },
)

VERDICT_SHARES = DatasetSchema(
    name="verdict_shares",
    title="Shares of the verdicts over scattered parameters",
    coordinates={"kind": text("verdict", "kind")},
    variables={
        "share": Variable("share of the sample", dims=("kind",), rtol=2e-2, atol=1e-2),
        **{
            f"share_{end}": Variable(
                f"{end} end of its 95 % interval", dims=("kind",), rtol=5e-2
            )
            for end in ("low", "high")
        },
        "samples": count("brakes in the sample", dtype="i8"),
        **ONE_PAIR,
    },
)
