"""Hammering at (5π/6, 5π/6), and the whirl that the paper calls unbounded, as animations."""

import numpy as np

from squealpipe.study.figures.dynamics.animation import animate
from squealpipe.rerun.key import state_key
from squealpipe.store import load

frames = snakemake.params.part["animation"]["frames"]
hammering = load(snakemake.input.explorer).sel(
    alpha1=5 * np.pi / 6, alpha2=5 * np.pi / 6, method="nearest"
)
whirl = load(snakemake.input.F3)
end = float(whirl.time_reached)
half = float(hammering.time[-1]) / 2
animate(hammering, snakemake.output.hammering, start=0.0, end=half, frames=frames)
animate(whirl, snakemake.output.whirl, start=0.9 * end, end=end, frames=frames)
for path in snakemake.output:
    state_key(path, snakemake.params.key)
