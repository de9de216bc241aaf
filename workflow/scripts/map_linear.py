"""Linear maps over both spring angles: sliding (A2), stability (A3), frequencies (A4)."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.linear import natural_frequencies, quasi_static_map, stability_map
from squealpipe.tasks.linear_boundaries import stability_boundaries

part = snakemake.params.part
params, out = parameters_of(part), snakemake.output
angles = np.linspace(0.0, np.pi, part["linear.points"])
produce(lambda: quasi_static_map(params, angles, angles), config=part, output=out.quasi_static)
produce(lambda: stability_map(params, angles, angles), config=part, output=out.stability)
produce(lambda: natural_frequencies(params, angles, angles), config=part, output=out.frequencies)
produce(lambda: stability_boundaries(params), config=part, output=out.boundaries)
