"""The cheapest adequate model over both spring angles, one map for each question."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.patches import Patch

from squealpipe.schema.ladder import Level
from squealpipe.study.figures.parts import style
from squealpipe.study.figures.parts.style import (
    GREY,
    PAGE,
    category_colours,
    draw_map,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

READS = ("model_ladder",)
CAPTION = (
    "The cheapest level of the model ladder whose answer is within the tolerance of A1's and whose "
    "own assumptions hold, over both spring angles (a level that only drops stick counts where "
    "the belt is reached): (a) is contact lost, (b) dominant frequency of "
    "y, (c) peak contact force, (d) largest displacement, within the map's horizon."
)
ALT = "Four maps over both spring angles, coloured by the cheapest adequate model level."

QUESTION_NAMES = {
    "contact_lost": "contact lost?",
    "frequency": "frequency",
    "peak_contact_force": "peak contact force",
    "max_displacement": "largest displacement",
}


def colour_of(level: Level) -> str:
    """The colour of a level."""
    return str(getattr(style, level.colour))


def draw(ladder: xr.Dataset) -> Figure:
    """One map for each question, from dataset ``model_ladder``."""
    figure, axes = new_figure(PAGE, 7.2, nrows=2, ncols=2)
    colours = category_colours([colour_of(level) for level in sorted(Level)])
    present = set()
    for letter, panel, question in zip(
        "abcd", axes.flat, ladder.question.values.tolist(), strict=True
    ):
        levels = ladder.cheapest.sel(question=question).values
        present |= set(levels.ravel().tolist())
        draw_map(panel, ladder.alpha1.values, ladder.alpha2.values, levels, **colours)
        panel_letter(panel, letter, QUESTION_NAMES[question])
    patches = [
        Patch(facecolor=colour_of(level), edgecolor=GREY, lw=0.5, label=level.label)
        for level in Level
        if level in present
    ]
    figure.legend(handles=patches, loc="outside upper center", ncols=len(patches))
    return figure
