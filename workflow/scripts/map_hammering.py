"""Impacts, extremes and kind of motion of model A1."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.hammering import hammering_map

part = snakemake.params.part
params = parameters_of(part)
angles = np.linspace(0.0, np.pi, part["dynamics.hammering_points"])
t_end = part["dynamics.horizon"] * params.time_unit
produce(
    lambda: hammering_map(params, angles, angles, t_end=t_end, tol=part["dynamics.tol"]),
    config=part,
    output=snakemake.output[0],
)
