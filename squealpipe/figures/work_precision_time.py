"""Work–precision of the time integration of A1: wall time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.figures.integration_panels import draw_scenes

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "Error of the final state against wall time for one run of model A1 on four scenes, by our "
    "event-driven Taylor integrator (alone and as one of 64 runs of an ensemble) and by public "
    "methods: scipy with located events over tolerances, scipy on the tanh-regularized model over"
    " σ, Moreau–Jean stepping over h. Reference: long double. Grey band: Pareto front; red ring: "
    "the setting that all our maps use. Machine and versions are named below the panels."
)
ALT = "Four charts of error against wall time, one a scene, with one line a method."


def draw(integration: xr.Dataset) -> Figure:
    """Wall time in ms over error, from dataset ``work_precision_integration``."""
    return draw_scenes(integration, "wall_time", 1e3, "wall time of a run (ms)")
