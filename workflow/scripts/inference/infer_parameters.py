"""Which parameters agree with the paper's statements."""

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.inference.inference import infer_parameters

part = snakemake.params.part
produce(
    lambda: infer_parameters(
        parameters_of(part), reading=part["reading"], **part["inference"]
    ),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
