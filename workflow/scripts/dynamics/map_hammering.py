"""Impacts, extremes and kind of motion of model A1; of a scattered map the rows of one part."""

from squealpipe.execution.parts import make_map
from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.tasks.dynamics.hammering import hammering_map

part = snakemake.params.part
make_map(
    hammering_map,
    for_linear(parameters_of(part), part["read_as"]),
    "hammering",
    part,
    output=snakemake.output[0],
    key=snakemake.params.key,
    item=snakemake.wildcards.get("scatteritem", "1-of-1"),
)
