"""The benchmark of integrators with events."""

from squealpipe.benchmark.adapters import installed
from squealpipe.benchmark.scoring import benchmark
from squealpipe.execution.job import Job

job = Job(snakemake)
study = job.settings["comparison.benchmark"]
job.make(lambda: benchmark(installed(study["solvers"]), tolerances=study["tolerances"]))
