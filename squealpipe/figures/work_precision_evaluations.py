"""Work–precision of the time integration of A1: evaluations of the right-hand side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.figures.integration_panels import draw_scenes

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "The same runs against evaluations of the right-hand side, which no machine or language "
    "changes. A Taylor step of order p counts as p + 1 evaluations, a Moreau–Jean step as one."
)
ALT = "Four charts of error against evaluations of the right-hand side, one a scene."


def draw(integration: xr.Dataset) -> Figure:
    """Evaluations over error, from dataset ``work_precision_integration``."""
    return draw_scenes(integration, "evaluations", 1.0, "evaluations of the right-hand side")
