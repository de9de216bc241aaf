"""Shapes of the unstable modes of a structure."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting.mode_shapes import figure_of_modes
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("structure/modes",),
    caption=(
        "Shapes of the complex modes that grow fastest at the structure's own friction, at the "
        "instant of their largest displacement; where none grows, of those that decay slowest. "
        "Grey: at rest; brighter places move farther. Without a mesh, arrows at the degrees of "
        "freedom."
    ),
    alt="Up to four deformed shapes of the structure, one for each of the modes that grow fastest.",
)
def draw(modes: xr.Dataset) -> Figure:
    """Up to four shapes from the dataset ``structure/modes``."""
    return figure_of_modes(modes)
