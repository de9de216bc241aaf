"""Schemas of the noise of a structure over pressure, speed and friction or temperature."""

from enum import IntEnum

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
)
from squealpipe.vibration.schema import error_of

QUANTITIES = ("pressure", "speed", "mu", "temperature")
"""Quantities that an operating point may have."""


class Match(IntEnum):
    """Agreement of a measured operating point with the predicted one."""

    hit = 0
    """noisy in both, at one frequency"""
    miss = 1
    """noisy, predicted quiet or at another frequency"""
    false_alarm = 2
    """quiet, predicted noisy"""
    both_quiet = 3
    undetermined = 4
    outside = 5
    """beyond the range of the map"""


def _map_over(name: str, last: str, coordinate: Variable) -> DatasetSchema:
    """Return the schema of a map whose last dimension is friction or temperature."""
    point = ("pressure", "speed", last)
    return DatasetSchema(
        name=name,
        title="Which operating points of a structure are noisy, at which frequency, how loud",
        coordinates={
            "pressure": Variable("factor of all preloads", "1", ("pressure",)),
            "speed": Variable(
                "belt speed, m/s, or of a rotation rad/s", "1", ("speed",)
            ),
            last: coordinate,
            "band": Variable("middle of a band of frequencies", "Hz", ("band",)),
            "contact": text("name of the contact", "contact"),
        },
        variables={
            "verdict": flag(
                "what steady sliding ends in after a push", Verdict, *point
            ),
            "growth_rate": or_nan("largest growth rate of small motions", "s-1", point),
            "leading_frequency": or_nan(
                "frequency of the mode that grows fastest or decays slowest",
                "Hz",
                point,
                optional=True,
            ),
            "unstable_modes": count("modes of steady sliding that grow", *point),
            "frequency": or_nan(
                "strongest line of the velocity", "Hz", point, rtol=1e-2
            ),
            "velocity_rms": or_nan(
                "rms speed of vibration of all contacts", "m s-1", point, rtol=2e-2
            ),
            **{
                error_of(name): or_nan(
                    f"statistical error ({error}) of {name}; 0 where the motion repeats",
                    unit,
                    point,
                    volatile=True,
                )
                for name, error, unit in (
                    ("frequency", "scatter", "Hz"),
                    ("velocity_rms", "95 %", "m s-1"),
                )
            },
            "velocity_level": or_nan(
                "velocity level in decibels re 5e-8 m/s, NaN where it is quiet",
                "1",
                point,
                atol=0.2,
            ),
            "friction": or_nan(
                "coefficient of friction of the contacts without one of their own",
                "1",
                point,
            ),
            "separated_fraction": or_nan(
                "share of the time without contact, of the contact that has most",
                dims=point,
                rtol=2e-2,
                atol=1e-3,
            ),
            "occurrence": Variable(
                "share of the points that are noisy with their frequency in the band",
                dims=("band",),
                rtol=2e-2,
                atol=1e-2,
            ),
            "band_low": Variable("lower edge of the band", "Hz", ("band",)),
            "band_high": Variable("upper edge of the band", "Hz", ("band",)),
            "share_noisy": Variable("share of the points that are noisy", atol=1e-2),
            "share_undetermined": Variable("share of undetermined points", atol=1e-2),
            "measured_frequency": or_nan(
                "measured frequency, NaN where it was quiet",
                "Hz",
                ("noise",),
                optional=True,
            ),
            "measured_occurrence": Variable(
                "share of the lines of the list that are noises in the band",
                dims=("band",),
                optional=True,
            ),
            "measured_level": or_nan(
                "measured level as it is listed, NaN where none is",
                "1",
                ("noise",),
                optional=True,
            ),
            "predicted_frequency": or_nan(
                "predicted frequency nearest to it, NaN where none is",
                "Hz",
                ("noise",),
                optional=True,
                rtol=1e-2,
            ),
            "match": flag(
                "agreement of measured and predicted", Match, "noise", optional=True
            ),
            "hits": count(
                "measured noises that are predicted within the band", optional=True
            ),
            "misses": count("measured noises that are not", optional=True),
            "false_alarms": count(
                "measured quiet points that are predicted noisy", optional=True
            ),
            "quiet_agreed": count("points that are quiet in both", optional=True),
            "frequency_band": or_nan(
                "largest difference of frequencies of one noise, over the measured one",
                optional=True,
            ),
            "mean_pressure": or_nan(
                "mean pressure of all faces at the factor 1, NaN without faces", "Pa"
            ),
            "n_modes": count("modes in which the structure was run"),
            "outcome": outcome(
                *point,
                among=(
                    Outcome.converged,
                    Outcome.unresolved,
                    Outcome.not_finite,
                    Outcome.no_sliding_state,
                ),
            ),
        },
    )


operating_map_schema = _map_over(
    "operating_map",
    "mu",
    Variable("coefficient of friction, with tables a factor of it", "1", ("mu",)),
)
over_temperature_schema = _map_over(
    "operating_map over temperature",
    "temperature",
    Variable("temperature", "degC", ("temperature",)),
)
