"""A scattered map or sweep from its parts."""

from squealpipe.ranges import longest
from squealpipe.store import load
from squealpipe.study.job import Job
from squealpipe.study.sweep import joined

job = Job(snakemake)
settings, parts = job.settings, list(snakemake.input.parts)
along = longest(settings["vary"]) if "vary" in settings else "alpha1"
job.make(lambda: joined(settings, [load(path) for path in parts], along), inputs=parts)
