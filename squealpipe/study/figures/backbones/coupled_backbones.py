"""Backbones of further scenes, those that the configuration names as coupled."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.study.figures.parts.backbone_panels import KEY, draw_scenes

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr
    from matplotlib.figure import Figure

READS = ("backbone/[a-z]*",)
CAPTION = (
    "Periodic motions of model A4 in further spring arrangements, one row for each, with the mode "
    "of the lower frequency on the left. " + KEY
)
ALT = (
    "Panels of amplitude over frequency, one row for each spring arrangement, one column for each "
    "mode."
)


def draw(branches: Mapping[str, xr.Dataset]) -> Figure:
    """One row for each scene; see ``parts.backbone_panels.draw_scenes``."""
    return draw_scenes(branches, 0.6 + 2.5 * len(branches) / 4)
