"""Shapes of the unstable modes of a structure."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting.mode_shapes import figure_of_modes
from squealpipe.plotting.modes import own_friction
from squealpipe.structures.meshes.datasets import mesh_of
from squealpipe.study.figures.declared import report_figure


def _caption(modes: xr.Dataset) -> str:
    """Describe the shapes that are drawn."""
    grows = modes.isel(mu=own_friction(modes)).unstable.any()
    which = "grow fastest" if grows else "decay slowest, as none grows"
    look = "Grey: at rest; brighter places move farther."
    if mesh_of(modes) is None:
        look = "Arrows: displacement of the degrees of freedom that move most."
    return (
        f"Shapes of the complex modes that {which} at the structure's own friction, at the instant "
        f"of their largest displacement. {look}"
    )


@report_figure(
    reads=("structure/modes",),
    caption=_caption,
    alt="Up to four deformed shapes of the structure, one for each of the modes that grow fastest.",
)
def draw(modes: xr.Dataset) -> Figure:
    """Up to four shapes from the dataset ``structure/modes``."""
    return figure_of_modes(modes)
