"""Noise of a structure over its operating points, or some of them; a stopped job goes on."""

from pathlib import Path

from squealpipe.study.chunks import beside
from squealpipe.study.job import Job
from squealpipe.study.structure_study import operating_sweep
from squealpipe.study.sweep import run_sweep

job = Job(snakemake)
sweep = operating_sweep(job.settings["structure"], job.settings["operating"])
if job.item != "1-of-1":
    sweep = sweep.scattered(job.item)
kept = beside(Path(job.out[0]), job.key)
job.make(lambda: run_sweep(sweep, workers=snakemake.threads, kept=kept))
kept.remove()
