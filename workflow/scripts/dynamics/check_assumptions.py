"""Table 1 extended: what each model level takes for granted, along its motions."""

from squealpipe.execution.job import Job
from squealpipe.tasks.dynamics.assumptions import check_assumptions

job = Job(snakemake)
job.make(lambda: check_assumptions(job.params))
