"""Table 1 extended, how far the linear model lets the contact pull, and friction as printed."""

import numpy as np

from squealpipe.parameters import SCENES, parameters_of
from squealpipe.store import produce
from squealpipe.tasks.dynamics.assumptions import check_assumptions, linear_pull_map
from squealpipe.tasks.dynamics.runs import simulate

part, output = snakemake.params.part, snakemake.output
params = parameters_of(part)
printed = params.with_(belt_speed=-params.belt_speed)
scene = SCENES["F2a"]
angles = np.linspace(0.0, np.pi, part["linear.points"])
tasks = {
    "assumptions": lambda: check_assumptions(params),
    "pull": lambda: linear_pull_map(params, angles, angles),
    "reversed": lambda: simulate(
        printed, scene.alpha1, scene.alpha2, t_end=scene.t_end * params.time_unit
    ),
}
for name, path in output.items():
    produce(tasks[name], config=part, sources=snakemake.input.sources, output=path)
