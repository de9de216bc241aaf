"""Table 1 extended, and how far the linear model lets the contact pull."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.assumptions import check_assumptions, linear_pull_map

part = snakemake.params.part
params = parameters_of(part)
angles = np.linspace(0.0, np.pi, part["linear.points"])
produce(lambda: check_assumptions(params), config=part, output=snakemake.output.assumptions)
produce(
    lambda: linear_pull_map(params, angles, angles), config=part, output=snakemake.output.pull
)
