"""Frequency and growth of all modes over friction."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import modes as plotting
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("structure/modes",),
    caption=(
        "Frequency (left) and growth rate (right) of the complex modes over friction, of the "
        "whole structure. Red: unstable; diamonds: where growth leaves zero."
    ),
    alt="Two panels over friction: frequencies that meet, and growth rates that leave zero there.",
)
def draw(modes: xr.Dataset) -> Figure:
    """Two panels from the dataset ``structure/modes``."""
    return plotting.figure(modes)
