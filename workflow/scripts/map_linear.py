"""Linear maps over both spring angles: sliding (A2), stability (A3), frequencies (A4); areas."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.linear import natural_frequencies, quasi_static_map, stability_map
from squealpipe.tasks.linear_boundaries import linear_shares, stability_boundaries

part = snakemake.params.part
section, params, out = part["linear"], parameters_of(part), snakemake.output
angles = np.linspace(0.0, np.pi, section["points"])
mu = np.linspace(0.0, section["mu_max"], section["share_points"])
kappa = np.linspace(0.0, section["kappa_max"], section["share_points"] + 1)[1:]
sharpness = np.geomspace(0.1, 100.0, 2 * section["share_points"])
produce(lambda: quasi_static_map(params, angles, angles), config=part, output=out.quasi_static)
produce(lambda: stability_map(params, angles, angles), config=part, output=out.stability)
produce(lambda: natural_frequencies(params, angles, angles), config=part, output=out.frequencies)
produce(lambda: stability_boundaries(params), config=part, output=out.boundaries)
produce(lambda: linear_shares(params, mu, kappa, sharpness), config=part, output=out.shares)
