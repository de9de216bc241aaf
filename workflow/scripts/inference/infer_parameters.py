"""Parameters that agree with the paper's statements."""

from squealpipe.paper.inference.inference import infer_parameters
from squealpipe.parameters import parameters_of
from squealpipe.study.job import Job

job = Job(snakemake)
settings = job.settings
job.make(
    lambda: infer_parameters(
        parameters_of(settings),
        reading=settings["reading"],
        workers=snakemake.threads,
        **settings["inference"],
    )
)
