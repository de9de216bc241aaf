"""Where model A1 keeps contact."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.dynamics import validity_map

part = snakemake.params.part
params = parameters_of(part)
angles = np.linspace(0.0, np.pi, part["dynamics.validity_points"])
t_end = part["dynamics.horizon"] * params.time_unit
produce(
    lambda: validity_map(params, angles, angles, t_end=t_end, tol=part["dynamics.tol"]),
    config=part,
    output=snakemake.output[0],
)
