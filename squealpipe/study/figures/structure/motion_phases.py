"""One period of the strongest line of a structure's motion, as a strip of eight phases."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.animation import phases
from squealpipe.structures.meshes.datasets import mesh_of
from squealpipe.study.figures.declared import report_figure


def _caption(run: xr.Dataset) -> str:
    """Describe the strip, and how contacts are drawn."""
    told = (
        "The motion that a small push ends in over one period of its strongest line, the "
        "vibration enlarged and without the static deformation. Contacts are blue in slip, orange "
        "in stick, green where they are faster than the belt, and hollow where they are open."
    )
    if mesh_of(run) is None:
        told += " There is no mesh: the contacts stand side by side."
    return told


@report_figure(
    reads=("structure/run",),
    caption=_caption,
    alt="Eight drawings of the vibrating structure with its contacts, an eighth of a period apart.",
)
def draw(run: xr.Dataset) -> Figure:
    """Eight phases from the dataset ``structure/run``."""
    if not run.sizes["time"]:
        figure, axes = style.new_figure(style.PAGE, 0.8)
        style.say_instead(axes[0, 0], "the motion dies out")
        return figure
    return phases(run)
