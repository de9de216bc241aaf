"""Cycles of the damped scenes of Figs. 3 and 2(d), and of one born by flutter, over friction."""

import math

import numpy as np
from squealpipe.brake.cycles.branch import cycle_branch
from squealpipe.brake.cycles.cycle import limit_cycle
from squealpipe.brake.cycles.extremes import settled_extremes
from squealpipe.parameters import SCENES
from squealpipe.store import load
from squealpipe.study.job import Job

job = Job(snakemake)
settings, out = job.settings, job.out
paper, cycles = job.params, settings["cycles"]
damping = cycles["damping"] * math.sqrt(paper.k1 * paper.mass)
params = paper.with_(damping1=damping, damping2=damping)
settle = cycles["settle"] * params.time_unit
low, high = cycles["mu"]
scenes = {name: (SCENES[name].alpha1, SCENES[name].alpha2) for name in ("F3", "F2d")}
scenes["flutter"] = tuple(math.pi * angle for angle in cycles["flutter"])

for name in ("F3", "F2d"):
    job.make(
        lambda name=name: limit_cycle(params, *scenes[name], t_settle=settle),
        out[f"limit_{name}"],
    )
first = load(out.limit_F3)
for way, to in (("down", low), ("up", high)):
    job.make(
        lambda to=to: cycle_branch(
            params,
            *scenes["F3"],
            parameter="mu",
            to=to,
            start=first,
            n_points=cycles["points"],
        ),
        out[f"branch_F3_{way}"],
    )
job.make(
    lambda: cycle_branch(
        params.with_(mu=low),
        *scenes["flutter"],
        parameter="mu",
        to=high,
        start="onset",
        n_points=cycles["points"],
    ),
    out.branch_flutter,
)
job.make(
    lambda: settled_extremes(
        params,
        scenes,
        np.linspace(low, high, cycles["extremes_mu"]),
        starts=cycles["extremes_starts"],
        t_end=cycles["extremes_horizon"] * params.time_unit,
        workers=snakemake.threads,
    ),
    out.extremes,
)
