"""The boundary of kept contact as curves, and how far scenes are from it, in each reading."""

from pathlib import Path

import numpy as np
from squealpipe.brake.curves.contact import boundary_distance, contact_boundary
from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear, reading_of
from squealpipe.study.job import Job

job = Job(snakemake)
settings = job.settings
angles = np.linspace(0.0, np.pi, settings["dynamics.validity_points"])
for reading, (path, *distances) in job.out.items():
    params = for_linear(parameters_of(settings), reading)
    boundary = contact_boundary(
        params,
        angles,
        angles,
        t_end=settings["dynamics.validity_horizon"] * params.time_unit,
        model=reading_of(reading).a1_model,
        tol=settings["dynamics.tol"],
        workers=snakemake.threads,
    )
    job.make(lambda: boundary, path, read_as=reading)
    for place in distances:
        scene = Path(place).stem
        job.make(
            lambda: boundary_distance(boundary, job.angles(scene)),
            place,
            read_as=reading,
            scene=scene,
        )
