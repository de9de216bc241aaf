"""Impacts, extremes and kind of motion of model A1; of a scattered map the rows of one part."""

from squealpipe.tasks.dynamics.hammering import hammering_map
from squealpipe.execution.row_blocks import make_map

make_map(
    hammering_map,
    "hammering",
    snakemake.params.part,
    output=snakemake.output[0],
    sources=snakemake.input.sources,
    log=snakemake.log[0],
    item=snakemake.wildcards.get("scatteritem", "1-of-1"),
)
