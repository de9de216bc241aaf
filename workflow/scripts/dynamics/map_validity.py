"""Where model A1 keeps contact; of a scattered map the rows of one part."""

from functools import partial

from squealpipe.execution.parts import make_map
from squealpipe.parameters import parameters_of
from squealpipe.reading import for_a1
from squealpipe.tasks.dynamics.runs import validity_map

part = snakemake.params.part
params, model = for_a1(parameters_of(part), part["read_as"])
make_map(
    partial(validity_map, model=model),
    params,
    "validity",
    part,
    output=snakemake.output[0],
    key=snakemake.params.key,
    item=snakemake.wildcards.get("scatteritem", "1-of-1"),
)
