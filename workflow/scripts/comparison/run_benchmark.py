"""The benchmark of integrators with events."""

from squealpipe.benchmark.peers import benchmark_beside_peers
from squealpipe.study.job import Job

job = Job(snakemake)
study = job.settings["comparison.benchmark"]
job.make(lambda: benchmark_beside_peers(**study))
