"""A scattered map or sweep from its parts."""

from squealpipe.config.ranges import longest
from squealpipe.store import load, produce
from squealpipe.execution.parts import join

part, parts = snakemake.params.part, list(snakemake.input.parts)
along = longest(part["vary"]) if "vary" in part else "alpha1"
produce(
    lambda: join([load(path) for path in parts], along),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
    inputs=parts,
)
