"""A task over ranges; of a scattered sweep some of the values of its longest dimension."""

from squealpipe.store import produce
from squealpipe.execution.sweep import planned, run_sweep

part = snakemake.params.part
sweep = planned(part).part(snakemake.wildcards.get("scatteritem", "1-of-1"))

produce(
    lambda: run_sweep(sweep, workers=snakemake.threads),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
