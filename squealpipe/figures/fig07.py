"""Fig. 7: where the linear stability analysis (A3) is valid, in both readings (E10)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.patches import Patch

from squealpipe.figures.linear_overlay import mark_scene
from squealpipe.figures.style import (
    BLACK,
    LIGHT,
    PAGE,
    WHITE,
    category_colours,
    draw_map,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "Where the linear model A3 is valid. White: A1, started at rest, loses contact, so A3 says "
    "nothing. Grey: contact is kept and the system is stable; black: kept and unstable, judged (a) "
    "by the eigenvalues of A3, as the paper's text says, or (b) by the response of A1 itself, as "
    "its caption says (|x| of the second half of the run more than 1.5 times that of the first). "
    "At the baseline black is empty in both. The cross is the configuration of Fig. 3."
)
ALT = (
    "Two equal square maps over both spring angles: two grey bands with thin horns run across "
    "white; there are no black cells; a cross near the middle lies in white."
)
GROWING = 1.5
"""Ratio of late to early |x| from which a response that keeps contact counts as unstable."""


def draw(validity: xr.Dataset) -> Figure:
    """The paper's three tones in both readings.

    Args:
        validity: dataset ``validity_map``.
    """
    kept = validity.separates.values == 0
    readings = (
        ("stability from A3 (text)", validity.regime_linear.values > 0),
        ("stability from A1 (caption)", np.nan_to_num(validity.response_growth.values) > GROWING),
    )
    figure, axes = new_figure(PAGE, 3.8, ncols=2)
    for panel, letter, (title, unstable) in zip(axes[0], "ab", readings, strict=True):
        tones = np.where(kept, np.where(unstable, 2, 1), 0)
        colours = category_colours([WHITE, LIGHT, BLACK])
        draw_map(panel, validity.alpha1.values, validity.alpha2.values, tones, **colours)
        mark_scene(panel, "F3")
        panel_letter(panel, letter, f"{title}: {np.count_nonzero(tones == 2)} unstable")
    patches = [
        Patch(facecolor=WHITE, edgecolor=BLACK, linewidth=0.6, label="A3 invalid: A1 separates"),
        Patch(facecolor=LIGHT, label=f"valid, stable ({np.count_nonzero(kept)} of {kept.size})"),
        Patch(facecolor=BLACK, label="valid, unstable"),
    ]
    marks = axes[0, 0].get_legend_handles_labels()[0]
    figure.legend(handles=[*patches, *marks], loc="outside lower center", ncols=4)
    return figure
