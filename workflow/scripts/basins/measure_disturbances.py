"""Smallest disturbances of steady sliding in the paper's scenes."""

from squealpipe.parameters import SCENES, parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.basins.disturbance import smallest_disturbance

part = snakemake.params.part
params = for_linear(parameters_of(part), part["read_as"])
for name, path in snakemake.output.items():
    scene, _, goal = name.partition("_")
    produce(
        lambda scene=SCENES[scene], goal=goal: smallest_disturbance(
            params,
            scene.alpha1,
            scene.alpha2,
            leads_to=goal,
            t_end=part["spread.disturbance_horizon"] * params.time_unit,
            directions=part["spread.disturbance_directions"],
            workers=snakemake.threads,
        ),
        config=part,
        key=snakemake.params.key,
        output=path,
    )
