"""Noise of a structure over all its operating points, from the parts of the map."""

from squealpipe.store import load
from squealpipe.study.job import Job
from squealpipe.study.structure_study import operating_sweep

job, parts = Job(snakemake), list(snakemake.input.parts)
sweep = operating_sweep(job.settings["structure"], job.settings["operating"])
job.make(lambda: sweep.joined([load(path) for path in parts]), inputs=parts)
