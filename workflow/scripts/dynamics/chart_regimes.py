"""Charts of regimes: over both angles, and over κ and μ at the angles of each scene."""

from pathlib import Path

import numpy as np

from squealpipe.execution.job import Job
from squealpipe.tasks.curves.chart import regime_chart

COARSE = 31
SMALLEST, LARGEST = 0.002, 2.0  # of κ and μ over those of the study

job = Job(snakemake)
settings, params = job.settings, job.params
files = {Path(path).stem: path for path in job.out.friction}
angles = {name: list(job.angles(name).values()) for name in files}
alpha1, alpha2 = np.array(list(angles.values())).T
ranges = [np.linspace(min(0.0, *each), max(np.pi, *each), COARSE) for each in (alpha1, alpha2)]
kappa, mu = (
    np.linspace(SMALLEST, LARGEST, COARSE) * (value or 1.0) for value in (params.kappa, params.mu)
)
options = {
    "t_end": settings["dynamics.chart_horizon"] * params.time_unit,
    "tol": settings["dynamics.tol"],
    "workers": snakemake.threads,
}
job.make(
    lambda: regime_chart(params, *ranges, design={"alpha1": alpha1, "alpha2": alpha2}, **options),
    job.out.angles,
)
for name, path in files.items():
    job.make(
        lambda: regime_chart(params, *angles[name], kappa=kappa, mu=mu, **options),
        path,
        scene=name,
    )
