"""Extra figure: what A3 predicts against what A1 does, cell by cell."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.patches import Patch

from squealpipe.study.figures.linear.linear_overlay import mark_scene
from squealpipe.study.figures.parts.style import (
    BLACK,
    COLUMN,
    LIGHT,
    ORANGE,
    WHITE,
    category_colours,
    draw_map,
    new_figure,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

KINDS = (
    ("agree: stable, keeps contact", WHITE),
    ("agree: unstable, separates", BLACK),
    ("missed: stable, but separates", LIGHT),
    ("false alarm: unstable, keeps contact", ORANGE),
)
READS = ("validity_map",)
CAPTION = (
    "The linear prediction (A3) against the motion from rest (A1), cell by cell. White and black: "
    "they agree; grey: A3 calls stable what A1 sees lose contact; orange: A3 calls unstable what "
    "keeps contact. Counts are in the legend."
)
ALT = (
    "Map over both angles in four tones: agreement in white and black, missed separations in grey, "
    "false alarms in orange."
)


def kinds_of_cells(validity: xr.Dataset) -> np.ndarray:
    """Index into ``KINDS`` of each cell."""
    unstable = validity.regime_linear.values > 0
    separates = validity.separates.values.astype(bool)
    return np.select([~unstable & ~separates, unstable & separates, separates], [0, 1, 2], 3)


def draw(validity: xr.Dataset) -> Figure:
    """The map with counts, from dataset ``validity_map``."""
    figure, axes = new_figure(COLUMN, 4.2)
    panel = axes[0, 0]
    kinds = kinds_of_cells(validity)
    draw_map(
        panel,
        validity.alpha1.values,
        validity.alpha2.values,
        kinds,
        **category_colours([colour for _, colour in KINDS]),
    )
    mark_scene(panel, "F3")
    counts = np.bincount(kinds.ravel(), minlength=len(KINDS))
    handles = [
        Patch(facecolor=colour, edgecolor=BLACK, linewidth=0.5, label=f"{label}: {count}")
        for (label, colour), count in zip(KINDS, counts, strict=True)
    ]
    figure.legend(handles=[*handles, *panel.get_lines()[-1:]], loc="outside lower center")
    return figure
