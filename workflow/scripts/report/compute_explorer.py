"""Motions from rest, spectra and backbones on a grid of spring angles."""

import numpy as np
from squealpipe.execution.job import Job
from squealpipe.tasks.dynamics.explorer import explorer_data

job = Job(snakemake)
options = dict(job.settings["explorer"])
angles = np.linspace(0.0, np.pi, options.pop("points"))
job.make(lambda: explorer_data(job.params, angles, **options))
