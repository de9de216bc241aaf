"""Dataset of the parameter inference: samples, the paper's statements, and their margins."""

from __future__ import annotations

import math

from squealpipe.schema import RUN_ENDS, DatasetSchema, Outcome, Variable, outcome

CONFIDENCE = 0.95
"""Confidence of every interval that is given for a share."""

SAMPLE = ("sample",)
STATEMENT = ("statement",)
BOTH = ("sample", "statement")
CONSEQUENCE = ("consequence",)


LITTLE = 0.1
"""F2e: spread of the contact force over three scenes, in preloads, that the inference takes for
"a minimal difference"; the paper gives no number."""


DAMPED_GRID = 181
"""Angles per axis at which instability is looked for where it has no closed form."""


def wilson_interval(count: int, size: int) -> tuple[float, float]:
    """Wilson's interval for the share count/size of a random sample; NaN without a sample."""
    if size == 0:
        return math.nan, math.nan
    # Importing it takes a second, and every job reads this schema.
    from scipy.stats import binomtest

    interval = binomtest(count, size).proportion_ci(CONFIDENCE, method="wilson")
    return float(interval.low), float(interval.high)


def _group(long_name: str) -> Variable:
    return Variable(long_name, dims=SAMPLE)


def _limit(side: str) -> Variable:
    return Variable(
        f"{side} end of the {CONFIDENCE:.0%} Wilson interval of feasible_share",
        dims=CONSEQUENCE,
        nan_allowed=True,
        optional=True,
    )


def _yes_no(dims: tuple[str, ...], long_name: str) -> Variable:
    return Variable(long_name, dims=dims, dtype="bool")


PARAMETER_INFERENCE = DatasetSchema(
    name="parameter_inference",
    title="Which parameters agree with the paper's statements",
    coordinates={
        "sample": Variable("number of the sample", dims=SAMPLE, dtype="i4"),
        "statement": Variable("id of the statement", dims=STATEMENT, dtype="U"),
        "consequence": Variable(
            "id of a statement that was not a constraint", dims=CONSEQUENCE, dtype="U"
        ),
    },
    variables={
        "kappa": _group("contact stiffness k3/k"),
        "mu": _group("friction coefficient"),
        "length_ratio": _group("free length of the springs over l_pre"),
        "speed_ratio": _group("belt speed over l_pre √(k/m)"),
        "direction": Variable(
            "direction of the belt", dims=SAMPLE, dtype="i1", flags={-1: "against_x", 1: "along_x"}
        ),
        "margin": Variable(
            "by how much the statement holds; negative where it fails",
            dims=BOTH,
            rtol=1e-6,
            atol=1e-6,
        ),
        "holds": _yes_no(BOTH, "the statement holds"),
        "feasible": _yes_no(SAMPLE, "all statements hold"),
        "outcome": outcome(
            *SAMPLE, among=(Outcome.converged, Outcome.unresolved, Outcome.infeasible)
        ),
        "baseline_kappa": Variable("k3/k1 of the study"),
        "baseline_mu": Variable("friction coefficient of the study"),
        "baseline_length_ratio": Variable("L1/l_pre of the study"),
        "baseline_speed_ratio": Variable("V/(l_pre √(k1/m)) of the study, signed"),
        "baseline_margin": Variable(
            "margin at the parameters of the study", dims=STATEMENT, rtol=1e-6, atol=1e-6
        ),
        "baseline_holds": _yes_no(STATEMENT, "the statement holds at the parameters of the study"),
        "baseline_outcome": Variable(
            "how that run ended",
            dims=STATEMENT,
            dtype="i1",
            flags=outcome(among=(*RUN_ENDS, Outcome.separated, Outcome.amplitude_reached)).flags,
        ),
        "criterion": Variable("what was checked", dims=STATEMENT, dtype="U"),
        "horizon": Variable(
            "horizon over √(m/k); NaN for statements without time", dims=STATEMENT, nan_allowed=True
        ),
        "share_holding": Variable(
            "share of the samples in which the statement holds", dims=STATEMENT
        ),
        "share_cut_alone": Variable(
            "share of the samples that this statement alone excludes", dims=STATEMENT
        ),
        "consequence_check": Variable(
            "what was checked of the consequence", dims=CONSEQUENCE, dtype="U"
        ),
        "feasible_count": Variable("number of feasible samples", dtype="i4"),
        "feasible_share": Variable(
            "share of the feasible samples in which the consequence holds; NaN where "
            "feasible_count is 0",
            dims=CONSEQUENCE,
            nan_allowed=True,
        ),
        "feasible_share_low": _limit("lower"),
        "feasible_share_high": _limit("upper"),
        "baseline_consequence": Variable(
            "the consequence holds at the parameters of the study",
            dims=CONSEQUENCE,
            dtype="bool",
            optional=True,
        ),
    },
)
