"""Where model A1 keeps contact; of a scattered map the rows of one part."""

from squealpipe.execution.job import Job
from squealpipe.execution.scatter import over_angles
from squealpipe.tasks.dynamics.runs import validity_map

job = Job(snakemake)
job.make(
    lambda: validity_map(job.params, model=job.model, **over_angles(job, "validity"))
)
