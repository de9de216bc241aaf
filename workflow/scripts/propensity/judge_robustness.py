"""The paper's statements in settings that it leaves out."""

from squealpipe.paper.robustness import verdict_robustness
from squealpipe.store import load
from squealpipe.study.job import Job

job = Job(snakemake)
settings, inferred = job.settings, snakemake.input.get("inferred")
job.make(
    lambda: verdict_robustness(
        job.params,
        starts=settings["robustness.random_starts"],
        inferred=load(inferred) if inferred else None,
        tol=settings["dynamics.tol"],
        workers=snakemake.threads,
    ),
    inputs=[inferred] if inferred else [],
)
