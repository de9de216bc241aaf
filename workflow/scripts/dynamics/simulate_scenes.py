"""Model A1 in the scenes of Figs. 2 to 5."""

from squealpipe.parameters import SCENES, parameters_of
from squealpipe.store import produce
from squealpipe.tasks.dynamics.runs import simulate

part = snakemake.params.part
params = parameters_of(part)
for name, path in snakemake.output.items():
    scene = SCENES[name]
    produce(
        lambda: simulate(
            params,
            scene.alpha1,
            scene.alpha2,
            t_end=scene.t_end * params.time_unit,
            tol=part["dynamics.tol"],
            growth=True,
        ),
        config={**part, "scene": name}, sources=snakemake.input.sources,
        output=path,
    )
