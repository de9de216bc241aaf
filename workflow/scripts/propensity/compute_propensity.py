"""Propensities over uncertain parameters, and what they depend on."""

import math

from squealpipe.brake.propensity.distributions import centred
from squealpipe.brake.propensity.propensity import propensity
from squealpipe.study.job import Job

job = Job(snakemake)
settings, params = job.settings, job.params
angles = [math.pi * angle for angle in settings["robustness.scene"]]
job.make(
    lambda: propensity(
        params,
        *angles,
        distributions=settings["robustness.distributions"] or centred(params, *angles),
        samples=settings["robustness.samples"],
        spring_correlation=settings["robustness.spring_correlation"],
        t_end=settings["robustness.horizon"] * params.time_unit,
        workers=snakemake.threads,
    )
)
