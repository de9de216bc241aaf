"""The dataset that answers for pads and structures: verdict, cause, frequency, level, cures."""

from dataclasses import replace
from enum import IntEnum
from typing import Any

from squealpipe.codes import Regime, Verdict
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

LINES = 3200
"""Lines of its spectrum."""
regime_meanings = {**{int(each): each.name for each in Regime}, -1: "not_reached"}
"""Meaning of regime."""


class Mechanism(IntEnum):
    """Cause of an instability of steady sliding."""

    none = 0
    falling_friction = 1
    flutter = 2
    divergence = 3
    no_sliding_state = 4


STARTS = {"": "steady sliding, pushed", "sudden_": "rest under the whole preload"}
"""The two starts: the prefix of their variables, and what they are in words."""

MEAN_SQUARES = ("velocity_rms_along", "velocity_rms_across")
MEANS = (*MEAN_SQUARES, "impact_rate", "separated_fraction", "stick_fraction")
WITH_ERROR = ("frequency", *MEANS)
"""Scalars of a settled motion that have a statistical error where it does not repeat."""


def error_of(name: str) -> str:
    """Return the name of the variable that holds the statistical error of another one."""
    return f"{name}_error"


def _of_motion(prefix: str, start: str) -> dict[str, Variable]:
    """Return the scalars of the motion that one start settles on."""

    def real(long_name: str, units: str = "1", rtol: float = 2e-2) -> Variable:
        return or_nan(f"{long_name}, from {start}", units, rtol=rtol, atol=1e-6)

    scalars = {
        "verdict": flag(f"verdict on the settled motion, from {start}", Verdict),
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
        )
        for name in WITH_ERROR
    }
    return {f"{prefix}{name}": entry for name, entry in scalars.items()}


def _path(long_name: str, units: str) -> Variable:
    return or_nan(
        f"{long_name} of the settled motion", units, ("sample",), volatile=True
    )


def _spectrum(what: str, units: str) -> Variable:
    return or_nan(f"amplitude of the {what}", units, ("line",), volatile=True)


def _of_cure(long_name: str, units: str = "1", **further: Any) -> Variable:
    return or_nan(long_name, units, ("cure",), **further)


def _optional(
    long_name: str, units: str = "1", *dims: str, rtol: float = 1e-9
) -> Variable:
    return or_nan(long_name, units, dims, optional=True, rtol=rtol)


_pad_variables = {
    "growth_rate": _optional("growth rate of small motions by model A3", "s-1"),
    "x_sliding": _optional("x of steady sliding", "m"),
    "y_sliding": _optional("y of steady sliding", "m"),
    "sliding_force": _optional("contact force of steady sliding", "N"),
    "quiet_alpha1": _optional(
        "alpha1 of the nearest quiet pair of angles that was found", "rad", rtol=1e-2
    ),
    "quiet_alpha2": _optional(
        "alpha2 of the nearest quiet pair of angles that was found", "rad", rtol=1e-2
    ),
    "alpha1": _optional("angle of spring 1", "rad"),
    "alpha2": _optional("angle of spring 2", "rad"),
    "preload": _optional("precompression l_pre of the contact spring", "m"),
}
"""Variables of pads on two springs alone."""
_LEVEL = 2e-2
_structure_variables = {
    "contact_velocity_rms": _optional(
        "rms velocity of each contact", "m s-1", "contact", "direction", rtol=_LEVEL
    ),
    "contact_separated_fraction": _optional(
        "share of the time without contact", "1", "contact", rtol=_LEVEL
    ),
    "contact_stick_fraction": _optional(
        "share of the time in stick", "1", "contact", rtol=_LEVEL
    ),
    "contact_peak_force": _optional("largest force", "N", "contact", rtol=_LEVEL),
    "contact_sliding_force": _optional(
        "force in steady sliding, 0 where the contact is open", "N", "contact"
    ),
    "leading_frequency": _optional(
        "frequency of the small motion that grows fastest or decays slowest", "Hz"
    ),
    "random_starts": count(
        "random starts that were tried beside those that are told", optional=True
    ),
    "random_starts_noisy": count("how many of them end in a vibration", optional=True),
    "degrees_of_freedom": count("of the whole structure", optional=True),
    "is_undamped": whether("whether nothing damps the structure", optional=True),
    "n_modes": count("modes in which it was run", optional=True),
    "refined_n_modes": count(
        "modes in which it was run on, to see how its level changes; 0: none",
        optional=True,
    ),
    "refined_velocity_rms": _optional(
        "rms speed of vibration, all contacts, in refined_n_modes modes; NaN: not known",
        "m s-1",
        rtol=_LEVEL,
    ),
    "refined_verdict": flag(
        "what is heard in refined_n_modes modes", Verdict, optional=True
    ),
}
"""Variables of structures alone."""


_ENDS = {
    "low": "lower end of its 95 % interval",
    "high": "upper end of its 95 % interval",
}


def share_variables(long_name: str, dim: str) -> dict[str, Variable]:
    """Return a share of a sample, and both ends of its interval."""
    return {"share": Variable(long_name, dims=(dim,))} | {
        f"share_{end}": Variable(words, dims=(dim,)) for end, words in _ENDS.items()
    }


def sobol_variables(*dims: str) -> dict[str, Variable]:
    """Return the Sobol indices of first order and the total ones, with their intervals."""
    ends = {"": ""} | {f"_{end}": f", {words}" for end, words in _ENDS.items()}
    return {
        f"{order}{end}": or_nan(f"Sobol index, {name}{words}", dims=dims, rtol=1e-6)
        for order, name in (("first_order", "first order"), ("total_order", "total"))
        for end, words in ends.items()
    }


assess_schema = DatasetSchema(
    name="assess",
    title="Whether it squeals or hammers, why, how loud, and what stops it",
    coordinates={
        "cure": text("quantity that is changed, the smallest change first", "cure"),
        "mode": count("mode, by ascending frequency", "mode"),
        "contact": replace(text("name of the contact", "contact"), optional=True),
        "direction": replace(
            text("direction of a velocity", "direction"), optional=True
        ),
    },
    variables={
        **_of_motion("", STARTS[""]),
        **_of_motion("sudden_", STARTS["sudden_"]),
        "mechanism": flag("why steady sliding is unstable", Mechanism),
        "quiet_unless_struck": whether(
            "whether steady sliding is quiet, but another motion exists, which a strike may start"
        ),
        "mode_frequency": or_nan(
            "frequencies of small motions (of a pad: of model A3)", "Hz", ("mode",)
        ),
        "sliding_growth_rate": or_nan(
            "growth rate of small motions about steady sliding", "s-1"
        ),
        "frequency_resolution": or_nan("resolution of the spectrum", "Hz"),
        "harmonic_frequency": or_nan(
            "multiples of the strongest line", "Hz", ("harmonic",), rtol=1e-2
        ),
        "harmonic_velocity": or_nan(
            "velocity amplitude at these multiples",
            "m s-1",
            ("harmonic",),
            rtol=5e-2,
            atol=1e-3,
        ),
        "line_frequency": or_nan("frequency of the spectrum", "Hz", ("line",)),
        "velocity_spectrum_along": _spectrum("velocity along the belt", "m s-1"),
        "velocity_spectrum_across": _spectrum("velocity across the belt", "m s-1"),
        "force_spectrum": _spectrum("contact force over preload", "1"),
        "path_time": _path("time", "s"),
        "path_x": _path("displacement along the belt", "m"),
        "path_y": _path("displacement across the belt", "m"),
        "path_force": _path("contact force over preload", "1"),
        "path_regime": flag(
            "regime of the settled motion", regime_meanings, "sample", volatile=True
        ),
        "value": _of_cure(
            "present value (for mu the friction coefficient at belt speed)"
        ),
        "unit": text("unit of the values", "cure"),
        "quiet_from": _of_cure(
            "nearest value at which the verdict changes between quiet and not",
            rtol=2e-3,
        ),
        "quiet_from_any_start": _of_cure(
            "nearest value at which the verdict from any of the tried starts changes",
            rtol=2e-2,
        ),
        **{
            f"quiet_{end}": or_nan(
                f"{end}er end of each interval of values that are quiet after a push, the "
                "nearest first; the end of the range searched where quiet does not end there",
                dims=("cure", "interval"),
                rtol=2e-3,
            )
            for end in ("low", "high")
        },
        "change": _of_cure(
            "change from the present value to quiet_from, in per cent (angles: degrees; of "
            "what is 0 now: of the largest value tried)",
            rtol=2e-2,
        ),
        "change_any_start": _of_cure(
            "change from the present value to quiet_from_any_start", rtol=5e-2
        ),
        "cure_is_run": whether(
            "whether runs from other starts than a push tell where its verdict changes; where they "
            "would take long only those of the smallest changes do",
            "cure",
        ),
        "lowest_tried": _of_cure("lower end of the range that was searched"),
        "highest_tried": _of_cure("upper end of the range that was searched"),
        "snaps_from": _of_cure(
            "nearest value at which steady sliding of a quiet brake jumps to another equilibrium",
            rtol=2e-3,
            optional=True,
        ),
        "snap_distance": _of_cure(
            "distance between both equilibria", "m", rtol=2e-2, optional=True
        ),
        **_pad_variables,
        **_structure_variables,
        "outcome": outcome(
            among=(
                Outcome.converged,
                Outcome.not_finite,
                Outcome.unresolved,
                Outcome.no_sliding_state,
            )
        ),
    },
)
