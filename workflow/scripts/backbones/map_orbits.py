"""Periodic motions of A4 at one peak over both spring angles."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.backbones.atlas import orbit_atlas

part = snakemake.params.part
params = for_linear(parameters_of(part), part["read_as"])
angles = np.linspace(0.0, np.pi, part["backbones.atlas_points"])
produce(
    lambda: orbit_atlas(
        params,
        angles,
        angles,
        y_peak=part["backbones.atlas_peak"] * params.preload,
        workers=snakemake.threads,
    ),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
