"""The scenes of a study of one's own: answer, run from its own start, run of what settles."""

from pathlib import Path

from squealpipe.brake.assess.assess import assess
from squealpipe.brake.dynamics.again import settled_run
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.parameters import parameters_of
from squealpipe.store import load, produce

settings, key = snakemake.params.settings, snakemake.params.key
params, scenes = parameters_of(settings), settings["scenes"]
for path in snakemake.output.answers:
    name = Path(path).stem
    scene = scenes[name]
    produce(
        lambda: assess(
            params, scene["alpha1"], scene["alpha2"], tol=settings["dynamics.tol"]
        ),
        config={**settings, "scene": name},
        key=key,
        output=path,
    )
for path in snakemake.output.runs:
    name = Path(path).stem
    scene = scenes[name]
    produce(
        lambda: simulate(
            params,
            scene["alpha1"],
            scene["alpha2"],
            t_end=scene["t_end"] * params.time_unit,
            initial_state=[scene["start"][state] for state in ("x", "y", "vx", "vy")],
            tol=settings["dynamics.tol"],
        ),
        config={**settings, "scene": name},
        key=key,
        output=path,
    )
for path, answer in zip(
    snakemake.output.settled, snakemake.output.answers, strict=True
):
    produce(
        lambda: settled_run(load(answer)),
        config={**settings, "scene": Path(path).stem},
        key=key,
        output=path,
    )
