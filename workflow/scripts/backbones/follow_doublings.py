"""Branches of doubled period that leave mode 1 of the coupled scenes, at two doublings each."""

import math

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.backbones.doubling import doubled_branch

part = snakemake.params.part
params = for_linear(parameters_of(part), part["read_as"])
limit = part["backbones.y_peak_max"] * params.preload
for scene, over_pi in part["backbones.coupled"].items():
    angles = [angle * math.pi for angle in over_pi]
    for doubling in (1, 2):
        produce(
            lambda: doubled_branch(params, *angles, mode=1, doubling=doubling, y_peak_max=limit),
            config={**part, "scene": scene, "doubling": doubling}, key=snakemake.params.key,
            output=snakemake.output[f"{scene}_{doubling}"],
        )
