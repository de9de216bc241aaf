"""Frequency and growth of all modes over friction."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import modes as plotting

READS = ("structure/modes",)
CAPTION = (
    "Frequency (above) and growth rate (below) of the complex modes over friction, of the whole "
    "structure. Red: unstable; diamonds: where growth leaves zero."
)
ALT = "Two panels over friction: frequencies that meet, and growth rates that leave zero there."


def draw(modes: xr.Dataset) -> Figure:
    """Two panels from the dataset ``structure/modes``."""
    return plotting.figure(modes)
