"""Fig. 13: backbones of both modes at (5π/6, 5π/6)."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.paper.figures.panels.backbone_panels import draw_scenes, key
from squealpipe.study.figures.declared import report_figure


def caption(branches: Mapping[str, xr.Dataset]) -> str:
    """Describe the panels, and the marks that are drawn."""
    return (
        "Periodic motions of model A4 at (5π/6, 5π/6) over the frequency, (a) near ω₁ and (b) "
        f"near ω₂. {key(branches)}"
    )


@report_figure(
    reads=("backbone/F13_*",),
    caption=caption,
    alt="Two panels of largest y and amplitude of x over frequency, one for each mode.",
)
def draw(branches: Mapping[str, xr.Dataset]) -> Figure:
    """One row; see ``parts.backbone_panels.draw_scenes``."""
    return draw_scenes(branches, 2.9)
