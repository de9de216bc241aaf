"""A task over ranges; of a scattered sweep some of the values of its longest dimension."""

from squealpipe.execution.job import Job
from squealpipe.execution.sweep import planned, run_sweep

job = Job(snakemake)
sweep = planned(job.settings).scattered(job.item)
job.make(lambda: run_sweep(sweep, workers=snakemake.threads))
