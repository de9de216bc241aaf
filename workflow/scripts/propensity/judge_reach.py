"""The paper's statements in settings that it leaves out."""

from squealpipe.execution.job import Job
from squealpipe.store import load
from squealpipe.tasks.propensity.robustness import verdict_reach

job = Job(snakemake)
part, inferred = job.part, snakemake.input.get("inferred")
job.make(
    lambda: verdict_reach(
        job.params,
        starts=part["spread.starts"],
        inferred=load(inferred) if inferred else None,
        tol=part["dynamics.tol"],
        workers=snakemake.threads,
    ),
    inputs=[inferred] if inferred else [],
)
