"""Basins of the scenes of Figs. 2(d) and 3 over the velocity at the start."""

import numpy as np

from squealpipe.parameters import SCENES, parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.basins.basin import basin_map

part, out = snakemake.params.part, snakemake.output
params = for_linear(parameters_of(part), part["read_as"])
speed = part["spread.basin_extent"] * params.preload / params.time_unit
axis = np.linspace(-speed, speed, part["spread.basin_points"])
for name, path in out.items():
    scene = SCENES[name]
    produce(
        lambda scene=scene: basin_map(
            params,
            scene.alpha1,
            scene.alpha2,
            vx=axis,
            vy=axis,
            t_end=part["spread.basin_horizon"] * params.time_unit,
            workers=snakemake.threads,
        ),
        config=part,
        key=snakemake.params.key,
        output=path,
    )
