"""Shares of the verdicts on a structure of scattered parameters, and what they depend on."""

from squealpipe.schema import DatasetSchema, Outcome, Variable, count, outcome, text
from squealpipe.vibration.schema import share_variables, sobol_variables

structure_propensity_schema = DatasetSchema(
    name="structure_propensity",
    title="Verdicts on a structure over a scatter of its parameters, and which of them decides",
    coordinates={
        "verdict": text("what steady sliding ends in after a push", "verdict"),
        "input": text("scattered parameter", "input"),
    },
    variables={
        **share_variables("share of the sample with this verdict", "verdict"),
        **sobol_variables("verdict", "input"),
        "relative_std": Variable(
            "standard deviation of the parameter over its value", dims=("input",)
        ),
        "judged": count("number of samples that give the shares"),
        "n_modes": count("modes in which the structure was run"),
        "outcome": outcome("verdict", among=(Outcome.converged, Outcome.unresolved)),
    },
)
