"""Figs. 10–12: backbones of both modes at (π/2, π), (π, π/2) and (3π/4, 3π/4)."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.paper.figures.panels.backbone_panels import draw_scenes, key
from squealpipe.study.figures.declared import report_figure


def caption(branches: Mapping[str, xr.Dataset]) -> str:
    """Describe the rows, and the marks that are drawn."""
    return (
        "Periodic motions of model A4 over the frequency, one row for each of Figs. 10, 11 and "
        f"12, with the mode of the lower frequency on the left. {key(branches, first=True)}"
    )


@report_figure(
    reads=("backbone/F1[012]_*",),
    caption=caption,
    alt="Three rows of two panels: largest y and amplitude of x over frequency near each mode.",
)
def draw(branches: Mapping[str, xr.Dataset]) -> Figure:
    """Three rows; see ``parts.backbone_panels.draw_scenes``."""
    return draw_scenes(branches, 6.2)
