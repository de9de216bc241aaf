"""Impacts, extremes and kind of motion of model A1; of a scattered map the rows of one part."""

from squealpipe.execution.job import Job
from squealpipe.execution.scatter import over_angles
from squealpipe.tasks.dynamics.hammering import hammering_map

job = Job(snakemake)
job.make(lambda: hammering_map(job.params, **over_angles(job, "hammering")))
