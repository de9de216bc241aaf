"""Datasets of the long runs: the size of the whirl, and how long the bounded motion lasts."""

from dataclasses import replace

from squealpipe.brake.schema.dynamics.runs import motion_label, motion_label_changes
from squealpipe.schema import (
    RUN_ENDS,
    DatasetSchema,
    Outcome,
    Variable,
    count,
    or_nan,
    outcome,
    whether,
)
from squealpipe.systems.datasets.agreement import ComparedAs, RoundOff

_IRREGULAR = (
    "one long run, irregular where the belt is slow: the last bit of the belt speed, which the "
    "vector instructions of the processor decide, changes when each extreme is reached"
)
_long_run_round_off = RoundOff(ComparedAs.sample, _IRREGULAR, sample="belt_speed")

whirl_schema = DatasetSchema(
    name="whirl",
    title="Where the growth at (0.4 pi, 0.6 pi) ends, over belt speed",
    coordinates={"belt_speed": Variable("belt speed V", "m s-1", ("belt_speed",))},
    variables={
        "amplitude": Variable(
            "largest |x| in the last fifth of the run",
            "m",
            ("belt_speed",),
            round_off=RoundOff(ComparedAs.magnitude, _IRREGULAR, factor=1.1),
        ),
        "stick_fraction": Variable(
            "share of the time sticking to the belt",
            dims=("belt_speed",),
            round_off=_long_run_round_off,
        ),
        "motion": replace(
            motion_label, dims=("belt_speed",), round_off=_long_run_round_off
        ),
        "motion_changed": replace(
            motion_label_changes, dims=("belt_speed",), round_off=_long_run_round_off
        ),
        "fitted": whether("whether the speed is in the fit", "belt_speed"),
        "slope": or_nan(
            "fitted growth of the amplitude with |V| (NaN: too few whirl)", "s"
        ),
        "offset": or_nan("fitted amplitude at V = 0", "m"),
        "fit_range": or_nan(
            "speed of the slowest and of the fastest belt in the fit", "m s-1", ("end",)
        ),
        "energy_slope": Variable(
            "sqrt(m/(k1 + k2)): the slope if the top speed were V", "s"
        ),
        "energy_offset": Variable(
            "far end of the unstretched springs: the offset if so", "m"
        ),
        "t_end": Variable("end of each run", "s"),
        "outcome": outcome("belt_speed", among=(*RUN_ENDS, Outcome.amplitude_reached)),
    },
)

_transient_round_off = RoundOff(
    ComparedAs.sample,
    "a chaotic transient multiplies round-off by e many times over before it ends: only the "
    "distribution of its lifetimes is a result",
    sample="sample",
)
transient_schema = DatasetSchema(
    name="transient",
    title="How long the bounded motion at (0.2 pi, 0.8 pi) lasts",
    coordinates={"sample": count("number of the perturbation", "sample")},
    variables={
        "lifetime": or_nan(
            "time of the tenth net turn around both fixed ends (NaN: not before t_end)",
            "s",
            ("sample",),
            round_off=_transient_round_off,
        ),
        "belt_speed": Variable("belt speed V", "m s-1"),
        "t_end": Variable("end of each run", "s"),
        "outcome": replace(
            outcome("sample", among=(*RUN_ENDS, Outcome.amplitude_reached)),
            round_off=_transient_round_off,
        ),
    },
)
