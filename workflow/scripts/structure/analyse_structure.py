"""Complex modes of a structure over friction, and which of them squeal."""

from squealpipe.execution.job import Job
from squealpipe.execution.structure_study import modes_over_friction, squealing

job = Job(snakemake)
section = job.settings["structure"]
job.make(lambda: modes_over_friction(section), job.out.modes)
job.make(lambda: squealing(section, snakemake.threads), job.out.squeal)
