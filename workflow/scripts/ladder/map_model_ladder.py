"""The cheapest adequate model over both spring angles."""

from squealpipe.brake.ladder.ladder import model_ladder
from squealpipe.study.job import Job

job = Job(snakemake)
params, ladder = job.params, job.settings["comparison.ladder"]
job.make(
    lambda: model_ladder(
        params,
        ladder["points"],
        ladder["tolerance"],
        t_end=ladder["horizon"] * params.time_unit,
        workers=snakemake.threads,
    )
)
