"""Table 1 extended: what each model level takes for granted, along its motions."""

from squealpipe.brake.dynamics.assumptions import check_assumptions
from squealpipe.study.job import Job

job = Job(snakemake)
job.make(lambda: check_assumptions(job.params))
