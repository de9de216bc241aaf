"""Reach of the paper's statements in settings that it leaves out."""

from squealpipe.schema import DatasetSchema, Outcome, count, or_nan, outcome, text

verdict_robustness_schema = DatasetSchema(
    name="verdict_robustness",
    title="Statements of the paper in settings that it leaves out",
    coordinates={
        "variant": text("setting", "variant"),
        "statement": text("statement, by its id", "statement"),
    },
    variables={
        "share": or_nan(
            "share of the runs in which the statement holds; 1 or 0 for a single one",
            dims=("variant", "statement"),
        ),
        "share_low": or_nan(
            "lower end of its 95 % interval", dims=("variant", "statement")
        ),
        "share_high": or_nan(
            "upper end of its 95 % interval", dims=("variant", "statement")
        ),
        "judged": count("number of runs judged", "variant", "statement"),
        "outcome": outcome(
            "variant",
            "statement",
            among=(Outcome.converged, Outcome.unresolved, Outcome.not_computed),
        ),
    },
)
