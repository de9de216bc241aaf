"""A task over ranges; of a scattered sweep some of the values of its longest dimension."""

from pathlib import Path

from squealpipe.study.chunks import beside
from squealpipe.study.job import Job
from squealpipe.study.sweep import planned, run_sweep

job = Job(snakemake)
sweep = planned(job.settings).scattered(job.item)
kept = beside(Path(job.out[0]), job.key)
job.make(lambda: run_sweep(sweep, workers=snakemake.threads, kept=kept))
kept.remove()
