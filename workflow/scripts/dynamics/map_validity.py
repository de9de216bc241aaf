"""Where model A1 keeps contact; of a scattered map the rows of one part."""

from squealpipe.tasks.dynamics.runs import validity_map
from squealpipe.execution.row_blocks import make_map

make_map(
    validity_map,
    "validity",
    snakemake.params.part,
    output=snakemake.output[0],
    sources=snakemake.input.sources,
    log=snakemake.log[0],
    item=snakemake.wildcards.get("scatteritem", "1-of-1"),
)
