"""Critical friction of Coulomb's law over the angles, and over both dashpots at a pair of them."""

import math

import numpy as np
from squealpipe.brake.linear.critical import critical_damping_map, critical_friction_map
from squealpipe.brake.models.refusals import extensions
from squealpipe.parameters import DEFAULTS
from squealpipe.study.job import Job

job = Job(snakemake)
settings, out = job.settings, job.out
params = job.params.with_(**{name: DEFAULTS[name] for name in extensions(job.params)})
unit = math.sqrt(params.k1 * params.mass)
damping1, damping2 = (unit * share for share in settings["robustness.critical_damping"])
angles = np.linspace(0.0, math.pi, settings["linear.points"])
dashpots = np.linspace(
    0.0,
    settings["robustness.critical_extent"] * unit,
    settings["robustness.critical_points"],
)
if (
    "scenes" in settings
):  # of a study of one's own: the first, with its dashpots if it has any
    first = next(iter(settings["scenes"].values()))
    alpha1, alpha2 = first["alpha1"], first["alpha2"]
    given = job.params.damping1, job.params.damping2
    damping1, damping2 = given if any(given) else (damping1, damping2)
else:
    alpha1, alpha2 = (math.pi * angle for angle in settings["robustness.scene"])
damped = params.with_(damping1=damping1, damping2=damping2)
job.make(lambda: critical_friction_map(damped, angles, angles), out.angles)
job.make(
    lambda: critical_damping_map(params, alpha1, alpha2, dashpots, dashpots),
    out.dashpots,
)
