"""Branches of doubled period that leave mode 1 of the coupled scenes, at two doublings each."""

import math

from squealpipe.brake.backbones.doubling import doubled_branch
from squealpipe.study.job import Job

job = Job(snakemake)
settings, params = job.settings, job.params
limit = settings["backbones.y_peak_max"] * params.preload
for scene, over_pi in settings["backbones.coupled"].items():
    angles = [angle * math.pi for angle in over_pi]
    for doubling in (1, 2):
        job.make(
            lambda: doubled_branch(
                params, *angles, mode=1, doubling=doubling, y_peak_max=limit
            ),
            job.out[f"{scene}_{doubling}"],
            scene=scene,
            doubling=doubling,
        )
