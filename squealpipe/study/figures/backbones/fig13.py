"""Fig. 13: backbones of both modes at (5π/6, 5π/6)."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.study.figures.panels.backbone_panels import SCENE_ALT, draw_scenes, key

READS = ("backbone/F13_*",)
ALT = SCENE_ALT


def caption(branches: Mapping[str, xr.Dataset]) -> str:
    """What is shown, and what the marks mean."""
    return (
        "Periodic motions of model A4 at (5π/6, 5π/6) over the frequency, (a) near ω₁ and (b) "
        f"near ω₂. {key(branches)}"
    )


CAPTION = caption


def draw(branches: Mapping[str, xr.Dataset]) -> Figure:
    """One row; see ``parts.backbone_panels.draw_scenes``."""
    return draw_scenes(branches, 2.9)
