"""Basins of the scenes of Figs. 2(d) and 3 over the velocity at the start."""

import numpy as np
from squealpipe.brake.basins.basin import basin_map
from squealpipe.parameters import SCENES
from squealpipe.study.job import Job

job = Job(snakemake)
settings, out, params = job.settings, job.out, job.params
speed = settings["robustness.basin_extent"] * params.preload / params.time_unit
axis = np.linspace(-speed, speed, settings["robustness.basin_points"])
for name, path in out.items():
    scene = SCENES[name]
    job.make(
        lambda scene=scene: basin_map(
            params,
            scene.alpha1,
            scene.alpha2,
            vx=axis,
            vy=axis,
            t_end=settings["robustness.basin_horizon"] * params.time_unit,
            workers=snakemake.threads,
        ),
        path,
    )
