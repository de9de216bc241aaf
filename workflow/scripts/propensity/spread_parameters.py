"""Propensities over uncertain parameters, and what they depend on."""

import math

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.propensity.distributions import centred
from squealpipe.tasks.propensity.propensity import propensity

part = snakemake.params.part
params = for_linear(parameters_of(part), part["read_as"])
angles = [math.pi * angle for angle in part["spread.scene"]]
produce(
    lambda: propensity(
        params,
        *angles,
        distributions=part["spread.distributions"] or centred(params, *angles),
        samples=part["spread.samples"],
        spring_correlation=part["spread.spring_correlation"],
        t_end=part["spread.horizon"] * params.time_unit,
        workers=snakemake.threads,
    ),
    config=part,
    key=snakemake.params.key,
    output=snakemake.output[0],
)
