"""Responses of Figs. 3 and 4 in the long run."""

import numpy as np
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.dynamics.whirl import transient_lifetimes, whirl_sizes
from squealpipe.parameters import SCENES
from squealpipe.study.job import Job

job = Job(snakemake)
settings, out = job.settings, job.out
params, scene = job.params, SCENES["F3"]
tol, second = settings["dynamics.tol"], params.time_unit
slowest, fastest = settings["dynamics.whirl_speeds"]
speeds = np.geomspace(slowest, fastest, settings["dynamics.whirl_count"])
t_end = 0.1 * settings["dynamics.whirl_horizon"] * second
job.make(
    lambda: simulate(params, scene.alpha1, scene.alpha2, t_end=t_end, tol=tol), out.run
)
job.make(
    lambda: whirl_sizes(
        params,
        np.union1d(
            speeds * params.preload / second,
            [abs(params.belt_speed)] if params.belt_speed else [],
        ),
        t_end=settings["dynamics.whirl_horizon"] * second,
        tol=tol,
        workers=snakemake.threads,
    ),
    out.whirl,
)
job.make(
    lambda: transient_lifetimes(
        params,
        samples=settings["dynamics.transient_samples"],
        t_end=settings["dynamics.transient_horizon"] * second,
        tol=tol,
        workers=snakemake.threads,
    ),
    out.transient,
)
