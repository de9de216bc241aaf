"""Areas of the linear regimes over friction, contact stiffness and regularization."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.linear_boundaries import linear_shares

part = snakemake.params.part
count = part["linear.share_points"]
produce(
    lambda: linear_shares(
        parameters_of(part),
        np.linspace(0.0, part["linear.mu_max"], count),
        np.linspace(0.0, part["linear.kappa_max"], count + 1)[1:],
        np.geomspace(0.1, 100.0, 2 * count),
    ),
    config=part,
    output=snakemake.output[0],
)
