"""The paper's statements in settings that it leaves out."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import load, produce
from squealpipe.tasks.propensity.robustness import verdict_reach

part, inferred = snakemake.params.part, snakemake.input.get("inferred")
produce(
    lambda: verdict_reach(
        for_linear(parameters_of(part), part["read_as"]),
        starts=part["spread.starts"],
        inferred=load(inferred) if inferred else None,
        tol=part["dynamics.tol"],
        workers=snakemake.threads,
    ),
    config=part,
    key=snakemake.params.key,
    inputs=[inferred] if inferred else [],
    output=snakemake.output[0],
)
