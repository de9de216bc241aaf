"""Dataset of the parameter inference: samples, the paper's statements, and their margins."""

import re
from dataclasses import dataclass
from enum import IntEnum

import xarray as xr

from squealpipe.reading import READINGS
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
from squealpipe.systems.datasets.agreement import ComparedAs, RoundOff
from squealpipe.vibration.shares import CONFIDENCE


class Holds(IntEnum):
    """Verdict on a statement at one parameter set, as stored."""

    no = 0
    yes = 1
    undecided = 2
    not_judged = 3


SHORT_STATEMENTS = {
    "F2a": "contact kept in (a)",
    "F2b": "contact kept in (b)",
    "F2c": "contact kept in (c)",
    "F2d": "contact lost in (d)",
    "F2e": "(a) to (c) differ little",
    "F3": "|x| grows",
    "F4": "|x| stays bounded",
    "F5a": "both forces identical",
    "F5b": "mass jumps again and again",
    "F6d": "linearly stable at Fig. 3's angles",
    "F6b_printed": "unstable only where Eq. (11) forbids",
    "F6b": "unstable only where R ≤ 0",
    "F7a": "contact lost in most cells",
    "F7_black": "kept and unstable somewhere",
    "F8c": "ω₁ largest on lines, in contact",
    "F8c_separated": "ω₁ largest on lines, separated",
    "F13": "modes switched",
    "S3": "modes couple",
}
"""Statements in few words, for figures, in the paper's order."""


def in_words(statement: str) -> str:
    """A statement by the paper's figure, and in few words: ``Fig. 3: |x| grows``."""
    figure = re.match(r"F(\d+)", statement)
    return (f"Fig. {figure[1]}: " if figure else "") + SHORT_STATEMENTS[statement]


def in_order(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset over statements, in the paper's order."""
    return dataset.sel(
        statement=[name for name in SHORT_STATEMENTS if name in dataset.statement]
    )


@dataclass(frozen=True)
class WordsInNumbers:
    """Numbers that stand for words of the paper."""

    minimal_difference: float = 0.1
    """F2e: spread of the contact force over three scenes, in preloads, that is taken for "a minimal
    difference"; the paper gives no number."""
    same_force: float = 1e-10
    """F5a: difference of normalized contact forces that two identical runs may show."""
    again_and_again: int = 3
    """F5b: how many separations count as "again and again"."""
    bounded_within: float = 2.0
    """F3, F4: |x| over the longer free length up to which the motion is a pendulum's on its
    springs."""
    large_region: float = 0.5
    """F7a: share of the angle map from which a region is called large."""
    alone: float = 1e-9
    """F10 to F13: amplitude over the other one's below which a direction takes no part."""
    vanishing: float = 1e-6
    """F8: share of the largest ω1 below which ω1 is zero."""
    small_share: float = 0.1
    """F8: share of the largest ω1 that bounds "the region where ω1 vanishes"."""
    near_largest: float = 0.98
    """F9: share of the largest ω2 that bounds the region where "ω2 is largest"."""
    alike: float = 0.5
    """Modal assurance criterion from which two shapes are nearer to one than to perpendicular
    ones."""
    growth_threshold: float = 2.0
    """``response_growth`` from which a response that keeps contact grows. |x| ∝ t, the slowest
    growth of an unstable linear system (at the onset of flutter), doubles from one half of a run to
    the next; exponential growth exceeds that, and a bounded one falls short."""


DAMPED_GRID = 181
"""Angles per axis at which instability is looked for where it has no closed form."""


parameter_inference_schema = DatasetSchema(
    name="parameter_inference",
    title="Which parameters agree with the paper's statements, in which reading of its friction",
    coordinates={
        "sample": count("number of the sample", "sample"),
        "reading": text("reading of the sign of friction", "reading"),
        "statement": text("id of the statement", "statement"),
        "consequence": text(
            "id of a statement that was not a constraint", "consequence"
        ),
    },
    variables={
        "kappa": Variable("contact stiffness k3/k", dims=("sample",)),
        "mu": Variable("friction coefficient", dims=("sample",)),
        "length_ratio": Variable(
            "free length of the springs over l_pre", dims=("sample",)
        ),
        "speed_ratio": Variable("belt speed over l_pre √(k/m)", dims=("sample",)),
        "holds": flag(
            "whether the statement holds: undecided where indistinguishable starts disagree, "
            "not judged where cheaper statements had already failed",
            Holds,
            "sample",
            "reading",
            "statement",
            round_off=RoundOff(
                ComparedAs.judged,
                "once a statement has refuted a parameter set, the others are not judged",
                none=int(Holds.not_judged),
            ),
        ),
        "feasible": whether("all statements hold", "sample", "reading"),
        "outcome": outcome(
            "sample",
            "reading",
            among=(Outcome.converged, Outcome.unresolved, Outcome.infeasible),
        ),
        "feasible_count": count("number of feasible samples", "reading"),
        "share": Variable("share of the samples that are feasible", dims=("reading",)),
        **{
            f"share_{end}": or_nan(
                f"{words} end of the {CONFIDENCE:.0%} Wilson interval of share",
                dims=("reading",),
            )
            for end, words in (("low", "lower"), ("high", "upper"))
        },
        "share_cut_alone": Variable(
            "share of the samples that this statement alone excludes, among the first sixteenth; "
            "for growth, which is judged last, among all",
            dims=("reading", "statement"),
        ),
        "criterion": text("what was checked", "statement"),
        "baseline_kappa": Variable("k3/k1 of the study"),
        "baseline_mu": Variable("friction coefficient of the study"),
        "baseline_length_ratio": Variable("L1/l_pre of the study"),
        "baseline_speed_ratio": Variable("V/(l_pre √(k1/m)) of the study, signed"),
        "baseline_reading": flag("the study's reading", dict(enumerate(READINGS))),
        "baseline_margin": Variable(
            "margin at the parameters of the study",
            dims=("reading", "statement"),
            rtol=1e-6,
            atol=1e-6,
        ),
        "feasible_share": or_nan(
            "share of the feasible samples in which the consequence holds; NaN where "
            "feasible_count is 0",
            dims=("reading", "consequence"),
        ),
    },
)


def of_study(inference: xr.Dataset) -> xr.Dataset:
    """The part of a ``parameter_inference`` that is in the study's own reading."""
    return inference.isel(reading=int(inference.baseline_reading))
