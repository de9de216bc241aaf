"""The verdict on every statement of the paper."""

from squealpipe.paper.claims.judge import judge
from squealpipe.parameters import parameters_of
from squealpipe.study.job import Job

job = Job(snakemake)
settings, paths = job.settings, snakemake.input.datasets
sources = dict(zip(snakemake.params.names, paths, strict=True))
job.make(
    lambda: judge(parameters_of(settings), sources, settings["reading"]), inputs=paths
)
