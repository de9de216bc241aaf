"""Noise of a structure over operating points: pressure, speed and friction."""

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

POINT = ("pressure", "speed", "mu")
"""Dimensions of the map."""


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


OPERATING_MAP = DatasetSchema(
    name="operating_map",
    title="Which operating points of a structure are noisy, at which frequency, how loud",
    coordinates={
        "pressure": Variable("factor of all preloads", "1", ("pressure",)),
        "speed": Variable("belt speed, m/s, or of a rotation rad/s", "1", ("speed",)),
        "mu": Variable("coefficient of friction", "1", ("mu",)),
        "band": Variable("middle of a third octave", "Hz", ("band",)),
        "contact": text("name of the contact", "contact"),
    },
    variables={
        "verdict": flag("what steady sliding ends in after a push", Verdict, *POINT),
        "growth_rate": or_nan("largest growth rate of small motions", "s-1", POINT),
        "unstable_modes": count("modes of steady sliding that grow", *POINT),
        "frequency": or_nan("strongest line of the velocity", "Hz", POINT, rtol=1e-2),
        "velocity_rms": or_nan(
            "rms speed of vibration of all contacts", "m s-1", POINT, rtol=2e-2
        ),
        "separated_fraction": or_nan(
            "share of the time without contact, of the contact that has most",
            dims=POINT,
            rtol=2e-2,
            atol=1e-3,
        ),
        "occurrence": Variable(
            "share of the points that are noisy with their frequency in the band",
            dims=("band",),
            rtol=2e-2,
            atol=1e-2,
        ),
        "share_noisy": Variable("share of the points that are noisy", atol=1e-2),
        "share_undetermined": Variable("share of undetermined points", atol=1e-2),
        "measured_frequency": or_nan(
            "measured frequency, NaN where it was quiet",
            "Hz",
            ("noise",),
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
        "n_modes": count("modes in which the structure was run"),
        "outcome": outcome(
            *POINT,
            among=(Outcome.converged, Outcome.unresolved, Outcome.no_sliding_state),
        ),
    },
)
