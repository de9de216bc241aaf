"""Fig. 7: where the linear stability analysis (A3) is valid, in both readings (E10)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.patches import Patch

from squealpipe.schema.dynamics.runs import growth_threshold
from squealpipe.study.figures.linear.linear_overlay import mark_scene
from squealpipe.study.figures.parts.style import (
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

READS = ("validity_map",)
ALT = (
    "Two equal square maps over both spring angles, in white where contact is lost, grey where it "
    "is kept and the system is stable, and black where it is kept and unstable; a cross near the "
    "middle marks the configuration of Fig. 3."
)


def caption(validity: xr.Dataset) -> str:
    """What the tones mean, with the threshold and the numbers of black cells of the dataset."""
    by_a3, by_a1 = (np.count_nonzero(cells) for cells in _unstable(validity))
    return (
        "Where the linear model A3 is valid. White: A1, started at rest, loses contact, so A3 says "
        "nothing. Grey: contact is kept and the system is stable; black: kept and unstable, judged "
        "(a) by the eigenvalues of A3, as the paper's text says, or (b) by the response of A1 "
        f"itself, as its caption says (|x| grows {growth_threshold(validity):g} times or more from "
        "the first half of the run to the second, as it does if it grows as fast as time). "
        f"Black are {by_a3} cells in (a) and {by_a1} in (b). The cross is the configuration of "
        "Fig. 3."
    )


CAPTION = caption


def draw(validity: xr.Dataset) -> Figure:
    """The paper's three tones in both readings.

    Args:
        validity: dataset ``validity_map``.
    """
    kept = validity.separates.values == 0
    titles = ("stability from A3 (text)", "stability from A1 (caption)")
    readings = zip(titles, _unstable(validity), strict=True)
    figure, axes = new_figure(PAGE, 3.8, ncols=2)
    for panel, letter, (title, black) in zip(axes[0], "ab", readings, strict=True):
        tones = np.where(black, 2, kept)
        colours = category_colours([WHITE, LIGHT, BLACK])
        draw_map(panel, validity.alpha1.values, validity.alpha2.values, tones, **colours)
        mark_scene(panel, "F3")
        panel_letter(panel, letter, f"{title}: {np.count_nonzero(black)} unstable")
    lost = f"A3 invalid: A1 separates ({np.count_nonzero(~kept)} of {kept.size})"
    patches = [
        Patch(facecolor=WHITE, edgecolor=BLACK, linewidth=0.6, label=lost),
        Patch(facecolor=LIGHT, label="valid, stable"),
        Patch(facecolor=BLACK, label="valid, unstable"),
    ]
    marks = axes[0, 0].get_legend_handles_labels()[0]
    figure.legend(handles=[*patches, *marks], loc="outside lower center", ncols=4)
    return figure


def _unstable(validity: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Cells that keep contact and are unstable, by A3 and by A1's own response."""
    kept = validity.separates.values == 0
    grows = np.nan_to_num(validity.response_growth.values) >= growth_threshold(validity)
    return kept & (validity.regime_linear.values > 0), kept & grows
