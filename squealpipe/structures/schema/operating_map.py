"""Noise of a structure over operating points: pressure, speed and friction."""

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
        "n_modes": count("modes in which the structure was run"),
        "outcome": outcome(
            *POINT,
            among=(Outcome.converged, Outcome.unresolved, Outcome.no_sliding_state),
        ),
    },
)
