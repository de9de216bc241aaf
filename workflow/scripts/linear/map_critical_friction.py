"""Critical friction of Coulomb's law over the angles, and over both dashpots at a pair of them."""

import math

import numpy as np

from squealpipe.models.refusals import without_extensions
from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.linear.critical import critical_damping_map, critical_friction_map

part, out = snakemake.params.part, snakemake.output
params = without_extensions(for_linear(parameters_of(part), part["read_as"]))
unit = math.sqrt(params.k1 * params.mass)
damping1, damping2 = (unit * share for share in part["spread.critical_damping"])
angles = np.linspace(0.0, math.pi, part["linear.points"])
dashpots = np.linspace(0.0, part["spread.critical_extent"] * unit, part["spread.critical_points"])
damped = params.with_(damping1=damping1, damping2=damping2)
if "scenes" in part:  # of a study of one's own: the first
    first = next(iter(part["scenes"].values()))
    scene = [first["alpha1"], first["alpha2"]]
else:
    scene = [math.pi * angle for angle in part["spread.scene"]]
for task, path in (
    (lambda: critical_friction_map(damped, angles, angles), out.angles),
    (lambda: critical_damping_map(params, *scene, dashpots, dashpots), out.dashpots),
):
    produce(task, config=part, key=snakemake.params.key, output=path)
