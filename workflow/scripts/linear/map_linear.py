"""Linear maps over both spring angles: sliding (A2), stability (A3) and frequencies (A4)."""

import numpy as np
from squealpipe.brake.dynamics.assumptions import linear_pull_map
from squealpipe.brake.linear.boundaries import stability_boundaries
from squealpipe.brake.linear.maps import (
    natural_frequencies,
    quasi_static_map,
    stability_map,
)
from squealpipe.parameters import SCENE_ANGLES
from squealpipe.study.job import Job

job = Job(snakemake)
params, settings = job.params, job.settings
angles = np.linspace(0.0, np.pi, settings["linear.points"])
of_scenes = np.array(SCENE_ANGLES)
tasks = {
    "quasi_static": lambda: quasi_static_map(params, angles, angles),
    "stability": lambda: stability_map(params, angles, angles),
    "natural_frequencies": lambda: natural_frequencies(params, angles, angles),
    "stability_boundaries": lambda: stability_boundaries(params),
    "linear_pull": lambda: linear_pull_map(params, angles, angles),
    "scenes_quasi_static_map": lambda: quasi_static_map(params, of_scenes, of_scenes),
    "scenes_stability_map": lambda: stability_map(params, of_scenes, of_scenes),
    "scenes_natural_frequencies": lambda: natural_frequencies(
        params, of_scenes, of_scenes
    ),
}
for name, path in job.out.items():
    job.make(tasks[name], path)
