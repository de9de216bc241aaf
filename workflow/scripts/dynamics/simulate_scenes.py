"""Model A1 in the scenes of Figs. 2 to 5, two of them run long, one by Eq. (4) as printed."""

from dataclasses import replace

from squealpipe.brake.dynamics.runs import simulate
from squealpipe.paper.schema.growth import GROWTH_HORIZON
from squealpipe.parameters import SCENES
from squealpipe.reading import READINGS
from squealpipe.study.job import Job

LONG = 3000.0  # √(m/k1), of Fig. 4

job = Job(snakemake)
params, model = job.params, job.model
runs = {name: (scene, model) for name, scene in SCENES.items()} | {
    "F3_long": (replace(SCENES["F3"], t_end=GROWTH_HORIZON), model),
    "F4_long": (replace(SCENES["F4"], t_end=LONG), model),
    "F2a_printed": (SCENES["F2a"], READINGS["as_printed"].a1_model),
}
for name, path in job.out.items():
    scene, of_model = runs[name]
    job.make(
        lambda: simulate(
            params,
            scene.alpha1,
            scene.alpha2,
            t_end=scene.t_end * params.time_unit,
            model=of_model,
            tol=job.settings["dynamics.tol"],
            growth=name in SCENES,
        ),
        path,
        scene=name,
    )
