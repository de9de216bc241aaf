"""The boundary of kept contact as curves, and how far scenes are from it."""

from pathlib import Path

import numpy as np
from squealpipe.brake.curves.contact import boundary_distance, contact_boundary
from squealpipe.study.job import Job

job = Job(snakemake)
settings, params = job.settings, job.params
angles = np.linspace(0.0, np.pi, settings["dynamics.validity_points"])
boundary = contact_boundary(
    params,
    angles,
    angles,
    t_end=settings["dynamics.validity_horizon"] * params.time_unit,
    model=job.model,
    tol=settings["dynamics.tol"],
    workers=snakemake.threads,
)
job.make(lambda: boundary, job.out.boundary)
for path in job.out.distances:
    scene = Path(path).stem
    job.make(lambda: boundary_distance(boundary, job.angles(scene)), path, scene=scene)
