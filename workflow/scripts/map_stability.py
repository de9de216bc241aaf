"""Linear stability (A3) over both spring angles."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.linear import stability_map

part = snakemake.params.part
angles = np.linspace(0.0, np.pi, part["linear.points"])
produce(
    lambda: stability_map(parameters_of(part), angles, angles),
    config=part,
    output=snakemake.output[0],
)
