"""Fig. 12: backbones of both modes at (3π/4, 3π/4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.figures.backbone_panels import KEY, draw_scene

if TYPE_CHECKING:
    from collections.abc import Sequence

    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "Periodic motions of model A4 at (α₁, α₂) = (3π/4, 3π/4). (a) Near ω₁ the mass moves in x "
    "alone, at one frequency. (b) Near ω₂ it moves in x and y; beyond the loss of contact the "
    "branch bends to lower frequencies. " + KEY
)
ALT = (
    "Two panels of amplitude over frequency: a vertical branch of x alone, and a branch of x and "
    "y that bends to lower frequencies above the contact threshold."
)


def draw(branches: Sequence[Sequence[xr.Dataset]], preload: float) -> Figure:
    """Both modes; see :func:`squealpipe.figures.backbone_panels.draw_scene`."""
    return draw_scene(branches, preload)
