"""The benchmark of integrators with events."""

from squealpipe.benchmark.adapters import installed
from squealpipe.benchmark.scoring import benchmark
from squealpipe.store import produce

part = snakemake.params.part
study = part["comparison.benchmark"]
produce(
    lambda: benchmark(installed(study["solvers"]), tolerances=study["tolerances"]),
    config=part, key=snakemake.params.key, output=snakemake.output[0],
)
