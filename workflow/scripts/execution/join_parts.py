"""A scattered map or sweep from its parts."""

from squealpipe.config.ranges import longest
from squealpipe.execution.job import Job
from squealpipe.execution.scatter import join
from squealpipe.store import load

job = Job(snakemake)
settings, parts = job.settings, list(snakemake.input.parts)
along = longest(settings["vary"]) if "vary" in settings else "alpha1"
job.make(lambda: join([load(path) for path in parts], along), inputs=parts)
