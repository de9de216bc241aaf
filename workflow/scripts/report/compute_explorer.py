"""Motions from rest, spectra and backbones on a grid of spring angles."""

import numpy as np
from squealpipe.brake.explorer import explorer_data
from squealpipe.study.job import Job

job = Job(snakemake)
options = dict(job.settings["explorer"])
angles = np.linspace(0.0, np.pi, options.pop("points"))
# scenes of one's own keep their exact angles
exact = [
    scene[name]
    for scene in job.settings.get("scenes", {}).values()
    for name in ("alpha1", "alpha2")
    if 0.0 <= scene[name] <= np.pi
]
angles = np.union1d(angles, exact)
job.make(
    lambda: explorer_data(job.params, angles, workers=snakemake.threads, **options)
)
