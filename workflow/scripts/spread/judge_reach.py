"""The paper's statements in settings that it leaves out."""

from squealpipe.parameters import parameters_of
from squealpipe.store import load, produce
from squealpipe.tasks.spread.reach import verdict_reach

part, inferred = snakemake.params.part, snakemake.input.get("inferred")
produce(
    lambda: verdict_reach(
        parameters_of(part),
        starts=part["spread.starts"],
        inferred=load(inferred) if inferred else None,
        tol=part["dynamics.tol"],
        workers=snakemake.threads,
    ),
    config=part,
    sources=snakemake.input.sources,
    inputs=[inferred] if inferred else [],
    output=snakemake.output[0],
)
