"""The cheapest adequate model over both spring angles, one map for each question."""

from __future__ import annotations

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.schema.ladder import Level
from squealpipe.study.figures.parts.work_precision import foot

READS = ("model_ladder",)
CAPTION = (
    "The cheapest level of the model ladder whose answer is within the tolerance of A1's and whose "
    "own assumptions hold, over both spring angles (a level that only drops stick counts where "
    "the belt is reached): (a) is contact lost, (b) dominant frequency of y, (c) peak contact "
    "force, (d) largest displacement, within the map's horizon. (e) CPU time of "
    "choose_model over that of always running A1; above 100 % choosing does not pay. Below "
    "each bar: share of its answers within the tolerance, and of those found by a level below A1."
)
ALT = (
    "Four maps over both spring angles, coloured by the cheapest adequate model level, and a bar "
    "chart of what choosing it costs."
)

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
    """One map for each question and the cost, from dataset ``model_ladder``."""
    figure, _ = style.new_figure(style.PAGE, 4.9)
    figure.clear()
    axes = figure.subplot_mosaic("abe;cde")
    colours = style.category_colours([colour_of(level) for level in sorted(Level)])
    present = set()
    for letter, question in zip("abcd", ladder.question.values.tolist(), strict=True):
        panel = axes[letter]
        levels = ladder.cheapest.sel(question=question).values
        present |= set(levels.ravel().tolist())
        style.draw_map(panel, ladder, levels, **colours)
        style.panel_letter(panel, letter, QUESTION_NAMES[question])
    _draw_cost(axes["e"], ladder)
    style.panel_letter(axes["e"], "e", "cost of choosing")
    tones = [(colour_of(level), level.label) for level in Level if level in present]
    keys = style.patches(tones)
    figure.legend(handles=keys, loc="outside upper center", ncols=min(len(keys), 4))
    foot(figure, ladder)
    return figure


def _draw_cost(panel: Axes, ladder: xr.Dataset) -> None:
    questions = ladder.question.values.tolist()
    cost = 100 * ladder.chosen_cpu_time.values / ladder.always_cpu_time.values
    cells = ("alpha1", "alpha2")
    right = 100 * (ladder.chosen_error <= ladder.tolerance).mean(cells).values
    below = 100 * (~ladder.chosen.isin([Level.a1, Level.a1_short])).mean(cells).values
    panel.barh(range(len(questions)), cost, color=style.BLUE, height=0.35)
    panel.axvline(100, color=style.BLACK, lw=0.8, ls="--")
    for row, question in enumerate(questions):
        words = f"{QUESTION_NAMES[question]}: {cost[row]:.0f} %"
        details = f"{right[row]:.1f} % right, {below[row]:.0f} % below A1"
        panel.text(0, row - 0.22, words, fontsize=7, va="bottom")
        panel.text(0, row + 0.22, details, fontsize=6, va="top")
    panel.set(xlabel="CPU time over always A1 (%)", yticks=[], xlim=(0, 1.1 * max(100, *cost)))
    panel.set_ylim(len(questions) - 0.4, -0.6)
