"""Where model A1 keeps contact; of a scattered map the rows of one part."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.store.chunks import Checkpoint
from squealpipe.tasks.dynamics import validity_map
from squealpipe.tasks.row_blocks import map_in_blocks, scattered_rows

part = snakemake.params.part
params = parameters_of(part)
angles = np.linspace(0.0, np.pi, part["dynamics.validity_points"])
rows = angles[scattered_rows(len(angles), snakemake.wildcards.get("scatteritem", "1-of-1"))]
options = {"t_end": part["dynamics.validity_horizon"] * params.time_unit, "tol": part["dynamics.tol"]}
output, sources, log = snakemake.output[0], snakemake.input.sources, snakemake.log[0]

with Checkpoint.beside(output, config=part, sources=sources, log=log) as checkpoint:
    produce(
        lambda: map_in_blocks(
            lambda some: validity_map(params, some, angles, **options),
            rows,
            len(angles),
            label="validity map",
            checkpoint=checkpoint,
        ),
        config=part,
        output=output,
    )
