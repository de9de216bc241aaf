"""A scattered map from its parts."""

from squealpipe.store import load, produce
from squealpipe.tasks.row_blocks import join

parts = list(snakemake.input.parts)
produce(
    lambda: join([load(path) for path in parts]),
    config=snakemake.params.part,
    output=snakemake.output[0],
    inputs=parts,
)
