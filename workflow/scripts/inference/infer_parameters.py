"""Which parameters agree with the paper's statements."""

from squealpipe.execution.job import Job
from squealpipe.parameters import parameters_of
from squealpipe.tasks.inference.inference import infer_parameters

job = Job(snakemake)
settings = job.settings
job.make(
    lambda: infer_parameters(
        parameters_of(settings), reading=settings["reading"], **settings["inference"]
    )
)
