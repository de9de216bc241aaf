"""Propensities over uncertain parameters, and what they depend on."""

import math

from squealpipe.execution.job import Job
from squealpipe.tasks.propensity.distributions import centred
from squealpipe.tasks.propensity.propensity import propensity

job = Job(snakemake)
part, params = job.part, job.params
angles = [math.pi * angle for angle in part["spread.scene"]]
job.make(
    lambda: propensity(
        params,
        *angles,
        distributions=part["spread.distributions"] or centred(params, *angles),
        samples=part["spread.samples"],
        spring_correlation=part["spread.spring_correlation"],
        t_end=part["spread.horizon"] * params.time_unit,
        workers=snakemake.threads,
    ),
)
