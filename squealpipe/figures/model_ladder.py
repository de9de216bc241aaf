"""The cheapest adequate model over both spring angles, one map a question."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.patches import Patch

from squealpipe.figures.style import (
    BLUE,
    GREEN,
    GREY,
    LIGHT,
    ORANGE,
    PAGE,
    PURPLE,
    RED,
    WHITE,
    category_colours,
    draw_map,
    new_figure,
    panel_letter,
)
from squealpipe.schema.comparison import Level

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "The cheapest level of the model ladder whose answer is within the tolerance of A1's and "
    "whose own assumptions hold, over both spring angles: (a) is contact lost, (b) dominant "
    "frequency of y, (c) peak contact force, (d) largest displacement, within the map's horizon. "
    "Where contact is lost, exact geometry is needed almost everywhere; without stick A1 is as "
    "good as with it, for at the baseline the belt is never reached."
)
ALT = "Four maps over both spring angles, coloured by the cheapest adequate model level."

NAMES = {
    Level.closed_form: ("closed form", WHITE),
    Level.a3_in_contact: ("A3 in contact", LIGHT),
    Level.a4_exact: ("A4, closed-form flow", GREEN),
    Level.a4_in_time: ("A4 in time", BLUE),
    Level.a1_linear_springs: ("A1, linear springs", PURPLE),
    Level.a1_no_stick: ("A1 without stick", ORANGE),
    Level.a1_short: ("A1, part of the horizon", GREY),
    Level.a1: ("A1", RED),
}
"""Level → its name and colour."""

QUESTION_NAMES = {
    "contact_lost": "contact lost?",
    "frequency": "frequency",
    "peak_contact_force": "peak contact force",
    "max_displacement": "largest displacement",
}


def draw(ladder: xr.Dataset) -> Figure:
    """One map a question, from dataset ``model_ladder``."""
    figure, axes = new_figure(PAGE, 7.2, nrows=2, ncols=2)
    colours = category_colours([colour for _, colour in NAMES.values()])
    present = set()
    for letter, panel, question in zip(
        "abcd", axes.flat, ladder.question.values.tolist(), strict=True
    ):
        levels = ladder.cheapest.sel(question=question).values
        present |= set(levels.ravel().tolist())
        draw_map(panel, ladder.alpha1.values, ladder.alpha2.values, levels, **colours)
        panel_letter(panel, letter, QUESTION_NAMES[question])
    patches = [
        Patch(facecolor=colour, edgecolor=GREY, lw=0.5, label=name)
        for level, (name, colour) in NAMES.items()
        if level in present
    ]
    figure.legend(handles=patches, loc="outside upper center", ncols=len(patches))
    return figure
