"""Smallest disturbances of steady sliding in the paper's scenes."""

from squealpipe.brake.basins.disturbance import smallest_disturbance
from squealpipe.parameters import SCENES
from squealpipe.study.job import Job

job = Job(snakemake)
settings, params = job.settings, job.params
for name, path in job.out.items():
    scene, _, goal = name.partition("_")
    job.make(
        lambda scene=SCENES[scene], goal=goal: smallest_disturbance(
            params,
            scene.alpha1,
            scene.alpha2,
            leads_to=goal,
            t_end=settings["robustness.disturbance_horizon"] * params.time_unit,
            directions=settings["robustness.disturbance_directions"],
            workers=snakemake.threads,
        ),
        path,
    )
