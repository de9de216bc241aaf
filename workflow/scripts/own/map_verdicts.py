"""The verdict over both spring angles."""

import numpy as np
from squealpipe.brake.assess.map import verdict_map
from squealpipe.study.job import Job

job = Job(snakemake)
angles = np.linspace(0.0, np.pi, job.settings["dynamics.hammering_points"])
job.make(lambda: verdict_map(job.params, angles, angles, workers=snakemake.threads))
