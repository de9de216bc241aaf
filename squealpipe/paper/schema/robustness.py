"""How far the statements of the paper carry in settings that it leaves out."""

from squealpipe.schema import DatasetSchema, Outcome, count, or_nan, outcome, text

_CELL = ("variant", "statement")

VERDICT_ROBUSTNESS = DatasetSchema(
    name="verdict_robustness",
    title="Statements of the paper in settings that it leaves out",
    coordinates={
        "variant": text("setting", "variant"),
        "statement": text("statement, by its id", "statement"),
    },
    variables={
        "share": or_nan(
            "share of the runs in which the statement holds; 1 or 0 for a single one",
            dims=_CELL,
        ),
        "share_low": or_nan("lower end of its 95 % interval", dims=_CELL),
        "share_high": or_nan("upper end of its 95 % interval", dims=_CELL),
        "judged": count("number of runs judged", *_CELL),
        "outcome": outcome(
            *_CELL, among=(Outcome.converged, Outcome.unresolved, Outcome.not_computed)
        ),
    },
)
