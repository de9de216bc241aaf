"""The cheapest adequate model over both spring angles, one map for each question."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.brake.schema.ladder import Level
from squealpipe.plotting import style
from squealpipe.plotting.work_precision import foot
from squealpipe.study.figures.declared import report_figure


def caption(ladder: xr.Dataset) -> str:
    """Describe the maps, and the cost that a choice beforehand saves."""
    hindsight, _ = shares_of_a3(ladder)
    below = 100 * float((ladder.chosen < Level.a1).mean())
    cost = 100 * float(ladder.chosen_cpu_time / ladder.always_cpu_time)
    maps = (
        "The cheapest level of the model ladder whose answer is within the tolerance of A1's and "
        "whose own assumptions hold, over both spring angles (a level that only drops stick counts "
        "where the belt is reached): (a) is contact lost, (b) dominant frequency of y, (c) peak "
        "contact force, (d) largest displacement, within the map's horizon."
    )
    return (
        f"{maps} This is hindsight; A3 would have done for (a) in {hindsight:.0f} % of the cells. "
        "choose_model has to know beforehand that A3 is right, as it does where the linear "
        f"motion stays clear of l_pre by a margin, in {below:.0f} %; it runs A1 in the others, "
        f"answers wrongly in {int(ladder.chosen_wrong.sum())} of {ladder.chosen.size}, and takes "
        f"{cost:.0f} % of the CPU time of always running A1."
    )


QUESTION_NAMES = {
    "contact_lost": "contact lost?",
    "frequency": "frequency",
    "peak_contact_force": "peak contact force",
    "max_displacement": "largest displacement",
}


def shares_of_a3(ladder: xr.Dataset) -> tuple[float, float]:
    """Per cent of the cells in which A3 tells whether contact is lost: in hindsight, beforehand."""
    hindsight = ladder.cheapest.sel(question="contact_lost") == Level.a3
    beforehand = ladder.chosen == Level.a3
    return 100 * float(hindsight.mean()), 100 * float(beforehand.mean())


@report_figure(
    reads=("model_ladder",),
    caption=caption,
    alt=(
        "Four maps over both spring angles, coloured by the cheapest adequate model level."
    ),
)
def draw(ladder: xr.Dataset) -> Figure:
    """One map for each question, from dataset ``model_ladder``."""
    figure, axes = style.new_figure(style.PAGE, 6.4, nrows=2, ncols=2)
    colours = style.category_colours(
        [style.colour_of(level) for level in sorted(Level)]
    )
    present = set()
    questions = ladder.question.values.tolist()
    for letter, panel, question in zip("abcd", axes.flat, questions, strict=True):
        levels = ladder.cheapest.sel(question=question).values
        present |= set(levels.ravel().tolist())
        style.draw_map(panel, ladder, levels, **colours)
        style.panel_letter(panel, letter, QUESTION_NAMES[question])
    keys = style.patches(
        (style.colour_of(level), level.label) for level in Level if level in present
    )
    figure.legend(handles=keys, loc="outside upper center", ncols=min(len(keys), 4))
    foot(figure, ladder)
    return figure
