"""Dataset of the parameter inference: samples, the paper's statements, and their margins."""

from __future__ import annotations

from squealpipe.schema import DatasetSchema, Variable, outcome

SAMPLE = ("sample",)
STATEMENT = ("statement",)
BOTH = ("sample", "statement")
CONSEQUENCE = ("consequence",)


def _group(long_name: str, units: str = "1") -> Variable:
    return Variable(dims=SAMPLE, units=units, long_name=long_name)


def _yes_no(dims: tuple[str, ...], long_name: str) -> Variable:
    return Variable(dims=dims, dtype="bool", long_name=long_name)


PARAMETER_INFERENCE = DatasetSchema(
    name="parameter_inference",
    title="Which parameters agree with the paper's statements",
    coordinates={
        "sample": Variable(dims=SAMPLE, dtype="i4", long_name="number of the sample"),
        "statement": Variable(dims=STATEMENT, dtype="U", long_name="id of the statement"),
        "consequence": Variable(
            dims=CONSEQUENCE, dtype="U", long_name="id of a statement that was not a constraint"
        ),
    },
    variables={
        "kappa": _group("contact stiffness k3/k"),
        "mu": _group("friction coefficient"),
        "length_ratio": _group("free length of the springs over l_pre"),
        "speed_ratio": _group("belt speed over l_pre √(k/m)"),
        "direction": Variable(
            dims=SAMPLE,
            dtype="i1",
            flags={-1: "against_x", 1: "along_x"},
            long_name="direction of the belt",
        ),
        "margin": Variable(
            dims=BOTH,
            rtol=1e-6,
            atol=1e-6,
            long_name="by how much the statement holds; negative where it fails",
        ),
        "holds": _yes_no(BOTH, "the statement holds"),
        "feasible": _yes_no(SAMPLE, "all statements hold"),
        "outcome": outcome(*SAMPLE),
        "baseline_kappa": Variable(long_name="k3/k1 of the study"),
        "baseline_mu": Variable(long_name="friction coefficient of the study"),
        "baseline_length_ratio": Variable(long_name="L1/l_pre of the study"),
        "baseline_speed_ratio": Variable(long_name="V/(l_pre √(k1/m)) of the study, signed"),
        "baseline_margin": Variable(
            dims=STATEMENT,
            rtol=1e-6,
            atol=1e-6,
            long_name="margin at the parameters of the study",
        ),
        "baseline_holds": _yes_no(STATEMENT, "the statement holds at the parameters of the study"),
        "baseline_outcome": Variable(
            dims=STATEMENT, dtype="i1", flags=outcome().flags, long_name="how that run ended"
        ),
        "criterion": Variable(dims=STATEMENT, dtype="U", long_name="what was checked"),
        "horizon": Variable(
            dims=STATEMENT,
            nan_allowed=True,
            long_name="horizon over √(m/k); NaN for statements without time",
        ),
        "share_holding": Variable(
            dims=STATEMENT, long_name="share of the samples in which the statement holds"
        ),
        "share_cut_alone": Variable(
            dims=STATEMENT, long_name="share of the samples that this statement alone excludes"
        ),
        "consequence_check": Variable(
            dims=CONSEQUENCE, dtype="U", long_name="what was checked of the consequence"
        ),
        "feasible_count": Variable(dtype="i4", long_name="number of feasible samples"),
        "feasible_share": Variable(
            dims=CONSEQUENCE,
            nan_allowed=True,
            long_name="share of the feasible samples in which the consequence holds; NaN where "
            "feasible_count is 0",
        ),
    },
)
