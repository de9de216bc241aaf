"""Fig. 13: backbones of both modes at (5π/6, 5π/6), where they have changed places."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.figures.backbone_panels import KEY, draw_scene

if TYPE_CHECKING:
    from collections.abc import Sequence

    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "Periodic motions of model A4 at (α₁, α₂) = (5π/6, 5π/6). (a) Here the first mode moves in x "
    "and y and loses contact; (b) the second is the isolated motion in x: the modes have changed "
    "places against Figs. 10 to 12, because K₁₁ now exceeds K₂₂ + k₃. " + KEY
)
ALT = (
    "Two panels of amplitude over frequency: a branch of x and y that bends to lower frequencies, "
    "and a vertical branch of x alone."
)


def draw(branches: Sequence[Sequence[xr.Dataset]], preload: float) -> Figure:
    """Both modes; see :func:`squealpipe.figures.backbone_panels.draw_scene`."""
    return draw_scene(branches, preload)
