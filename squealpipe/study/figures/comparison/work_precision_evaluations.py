"""Work–precision of the time integration of A1: evaluations of the right-hand side."""

from __future__ import annotations

from functools import partial

from squealpipe.study.figures.parts.integration_panels import draw_scenes

READS = ("work_precision_integration",)
CAPTION = (
    "The same runs against evaluations of the right-hand side, which do not depend on machine or "
    "language. A Taylor step of order p counts as p + 1 evaluations, a Moreau–Jean step as one."
)
ALT = "Four charts of error against evaluations of the right-hand side, one for each scene."
draw = partial(
    draw_scenes, cost="evaluations", scale=1.0, label="evaluations of the right-hand side"
)
