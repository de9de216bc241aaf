"""Shares of the events of a pad of scattered parameters, and what they depend on."""

from squealpipe.brake.schema.linear import angles_of_one_pair
from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    or_nan,
    outcome,
    text,
)
from squealpipe.vibration.schema import share_variables, sobol_variables

propensity_schema = DatasetSchema(
    name="propensity",
    title="Propensity for instability, and what it depends on, over a spread of parameters",
    coordinates={
        "quantity": text("what happens", "quantity"),
        "input": text("uncertain parameter", "input"),
        "size": count("size of a part of the sample", "size"),
    },
    variables={
        **share_variables("share of the sample in which it happens", "quantity"),
        "share_by_size": Variable(
            "the same share from a part of the sample", dims=("quantity", "size")
        ),
        **sobol_variables("quantity", "input"),
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
        "outcome": outcome("quantity", among=(Outcome.converged, Outcome.unresolved)),
        **angles_of_one_pair,
        "t_end": Variable(units="s", long_name="end of each run"),
    },
)
