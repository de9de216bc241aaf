"""Damping ratio of all modes over their frequency, as brake engineers draw it."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import modes as plotting
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("structure/modes",),
    caption=(
        "Damping ratio over frequency of the complex modes of the whole structure at its own "
        "friction. Modes below the line grow."
    ),
    alt="One panel of damping ratios over frequency; those of unstable modes are negative.",
)
def draw(modes: xr.Dataset) -> Figure:
    """One panel from the dataset ``structure/modes``."""
    return plotting.figure_of_damping(modes)
