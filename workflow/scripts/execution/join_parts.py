"""A scattered map or sweep from its parts."""

from squealpipe.config.ranges import longest
from squealpipe.execution.job import Job
from squealpipe.execution.parts import join
from squealpipe.store import load

job = Job(snakemake)
part, parts = job.part, list(snakemake.input.parts)
along = longest(part["vary"]) if "vary" in part else "alpha1"
job.make(lambda: join([load(path) for path in parts], along), inputs=parts)
