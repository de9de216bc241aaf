"""Work–precision of the time integration of A1: wall time."""

from __future__ import annotations

from functools import partial

from squealpipe.study.figures.parts.integration_panels import draw_scenes

READS = ("work_precision_integration",)
CAPTION = (
    "Error of the final state against wall time for one run of model A1 on four scenes, by our "
    "event-driven Taylor integrator (alone and as one of 64 runs of an ensemble) and by public "
    "methods: scipy with located events over tolerances, scipy on the tanh-regularized model over"
    " σ, Moreau–Jean stepping over h. Reference: long double. Grey band: Pareto front; red ring: "
    "the setting that all our maps use. Machine and versions are named below the panels."
)
ALT = "Four charts of error against wall time, one for each scene, with one line for each method."
draw = partial(draw_scenes, cost="wall_time", scale=1e3, label="wall time per run (ms)")
