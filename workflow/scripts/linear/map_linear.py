"""Linear maps over both spring angles: sliding (A2), stability (A3), frequencies (A4)."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.linear.maps import natural_frequencies, quasi_static_map, stability_map
from squealpipe.tasks.linear.boundaries import stability_boundaries

part = snakemake.params.part
section, params, out = part["linear"], parameters_of(part), snakemake.output
angles = np.linspace(0.0, np.pi, section["points"])
tasks = {
    "quasi_static": lambda: quasi_static_map(params, angles, angles),
    "stability": lambda: stability_map(params, angles, angles),
    "frequencies": lambda: natural_frequencies(params, angles, angles),
    "boundaries": lambda: stability_boundaries(params),
}
for name, path in out.items():
    produce(tasks[name], config=part, sources=snakemake.input.sources, output=path)
