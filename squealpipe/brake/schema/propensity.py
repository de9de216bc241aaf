"""Datasets on how far verdicts carry and how parameters spread into results."""

from squealpipe.brake.schema.linear import ONE_PAIR
from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    or_nan,
    outcome,
    text,
)

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

_BY_QUANTITY, _INPUT = ("quantity",), ("quantity", "input")

PROPENSITY = DatasetSchema(
    name="propensity",
    title="Propensity for instability, and what it depends on, over a spread of parameters",
    coordinates={
        "quantity": text("what happens", *_BY_QUANTITY),
        "input": text("uncertain parameter", "input"),
        "size": count("size of a part of the sample", "size"),
    },
    variables={
        "share": Variable(
            dims=_BY_QUANTITY, long_name="share of the sample in which it happens"
        ),
        "share_low": Variable(
            dims=_BY_QUANTITY, long_name="lower end of its 95 % interval"
        ),
        "share_high": Variable(
            dims=_BY_QUANTITY, long_name="upper end of its 95 % interval"
        ),
        "share_by_size": Variable(
            "the same share from a part of the sample", dims=("quantity", "size")
        ),
        **{
            f"{order}{end}": or_nan(f"Sobol index, {words}{of}", dims=_INPUT, rtol=1e-6)
            for order, words in (
                ("first_order", "first order"),
                ("total_order", "total"),
            )
            for end, of in (
                ("", ""),
                ("_low", ", lower end of its 95 % interval"),
                ("_high", ", upper end of its 95 % interval"),
            )
        },
        "half_width_by_size": or_nan(
            "half-width of the widest total index",
            dims=("quantity", "size"),
            optional=True,
            rtol=1e-6,
        ),
        "index_samples": count(
            "base sample of the indices", "quantity", "size", optional=True
        ),
        "judged": count("number of parameter sets"),
        "outcome": outcome(
            *_BY_QUANTITY, among=(Outcome.converged, Outcome.unresolved)
        ),
        **ONE_PAIR,
        "t_end": Variable(units="s", long_name="end of each run"),
    },
)
