"""Table 1 extended: what each model level takes for granted, along its motions."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.dynamics.assumptions import check_assumptions

part = snakemake.params.part
produce(
    lambda: check_assumptions(for_linear(parameters_of(part), part["read_as"])),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
