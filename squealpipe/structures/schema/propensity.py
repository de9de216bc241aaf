"""Shares of the verdicts on a structure of scattered parameters, and what they depend on."""

from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    or_nan,
    outcome,
    text,
)

_PAIR = ("verdict", "input")

STRUCTURE_PROPENSITY = DatasetSchema(
    name="structure_propensity",
    title="Verdicts on a structure over a scatter of its parameters, and which of them decides",
    coordinates={
        "verdict": text("what steady sliding ends in after a push", "verdict"),
        "input": text("scattered parameter", "input"),
    },
    variables={
        "share": Variable("share of the sample with this verdict", dims=("verdict",)),
        "share_low": Variable("lower end of its 95 % interval", dims=("verdict",)),
        "share_high": Variable("upper end of its 95 % interval", dims=("verdict",)),
        **{
            f"{order}{end}": or_nan(f"Sobol index, {words}{of}", dims=_PAIR, rtol=1e-6)
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
        "relative_std": Variable(
            "standard deviation of the parameter over its value", dims=("input",)
        ),
        "judged": count("number of samples that give the shares"),
        "n_modes": count("modes in which the structure was run"),
        "outcome": outcome("verdict", among=(Outcome.converged, Outcome.unresolved)),
    },
)
