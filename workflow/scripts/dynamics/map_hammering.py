"""Impacts, extremes and kind of motion of model A1; of a scattered map the rows of one part."""

from squealpipe.brake.dynamics.hammering import hammering_map
from squealpipe.study.job import Job
from squealpipe.study.scatter import over_angles

job = Job(snakemake)
job.make(
    lambda: hammering_map(
        job.params, workers=snakemake.threads, **over_angles(job, "hammering")
    )
)
