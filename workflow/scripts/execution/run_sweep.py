"""A task over ranges; of a scattered sweep some of the values of its longest dimension."""

from squealpipe.store import produce
from squealpipe.store.chunks import Checkpoint
from squealpipe.execution.sweep import executor, planned, run_sweep

part = snakemake.params.part
sweep = planned(part).part(snakemake.wildcards.get("scatteritem", "1-of-1"))
output, key, log = snakemake.output[0], snakemake.params.key, snakemake.log[0]

with (
    Checkpoint.beside(output, key=key, log=log) as checkpoint,
    executor(snakemake.threads) as pool,
):
    produce(
        lambda: run_sweep(sweep, executor=pool, checkpoint=checkpoint),
        config=part,
        key=key,
        output=output,
    )
