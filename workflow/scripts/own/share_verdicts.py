"""Shares of the verdicts around the first scene of a study of one's own."""

from squealpipe.brake.assess.shares import verdict_shares
from squealpipe.study.job import Job

MOST = 1024
"""Brakes that are run at most."""

job = Job(snakemake)
scene = next(iter(job.settings["scenes"].values()))
job.make(
    lambda: verdict_shares(
        job.params,
        scene["alpha1"],
        scene["alpha2"],
        distributions=job.settings["robustness.distributions"],
        samples=min(MOST, job.settings["robustness.samples"]),
    )
)
