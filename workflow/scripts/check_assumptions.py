"""Table 1 extended, how far the linear model lets the contact pull, and friction as printed."""

import numpy as np

from squealpipe.parameters import SCENES, parameters_of
from squealpipe.store import produce
from squealpipe.tasks.assumptions import check_assumptions, linear_pull_map
from squealpipe.tasks.dynamics import simulate

part, output = snakemake.params.part, snakemake.output
params = parameters_of(part)
printed = params.with_(belt_speed=-params.belt_speed)
scene = SCENES["F2a"]
angles = np.linspace(0.0, np.pi, part["linear.points"])
produce(lambda: check_assumptions(params), config=part, output=output.assumptions)
produce(lambda: linear_pull_map(params, angles, angles), config=part, output=output.pull)
produce(
    lambda: simulate(
        printed, scene.alpha1, scene.alpha2, t_end=scene.t_end * params.time_unit
    ),
    config=part,
    output=output.reversed,
)
