"""What the model ladder is worth: how often each level is right, and what choosing saves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.schema.ladder import Level
from squealpipe.study.figures.comparison.model_ladder import QUESTION_NAMES
from squealpipe.study.figures.parts.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PAGE,
    WHITE,
    new_figure,
    panel_letter,
)
from squealpipe.study.figures.parts.work_precision import foot

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

READS = ("model_ladder",)
CAPTION = (
    "(a) Share of the cells in which a level's answer is within the tolerance of A1's, whether or "
    "not its assumptions hold; the closed form and A3 have none where their motion does not "
    "oscillate. (b) Bars: time integrated with choose_model, over that of always running A1 until "
    "the question is answered, with the share of its answers within the tolerance above each bar. "
    "Strokes: the same for a choice that knows the cheapest adequate level of every cell."
)
ALT = "Dots: share of cells right by level and question. Bars: cost of the chosen models."
_COLOURS = dict(zip(QUESTION_NAMES, (BLACK, BLUE, GREEN, ORANGE), strict=True))
_MARKERS = dict(zip(QUESTION_NAMES, "osD^", strict=True))


def draw(ladder: xr.Dataset) -> Figure:
    """Both charts, from dataset ``model_ladder``."""
    figure, axes = new_figure(PAGE, 3.3, ncols=2)
    _draw_levels(axes[0, 0], ladder)
    _draw_saving(axes[0, 1], ladder)
    panel_letter(axes[0, 0], "a", "right answers of each level")
    panel_letter(axes[0, 1], "b", "cost of the chosen level")
    foot(figure, ladder)
    return figure


def _draw_levels(axes: Axes, ladder: xr.Dataset) -> None:
    rows = np.arange(ladder.sizes["level"])
    within = (ladder.error <= ladder.tolerance).mean(("alpha1", "alpha2"))
    for question, name in QUESTION_NAMES.items():
        axes.plot(
            100 * within.sel(question=question).values, rows, _MARKERS[question], ms=5,
            color=_COLOURS[question], label=name, alpha=0.8,
        )  # fmt: skip
    labels = [Level[name].label for name in ladder.level.values.tolist()]
    seconds = ladder.level_wall_time.values / (ladder.sizes["alpha1"] * ladder.sizes["alpha2"])
    axes.set_yticks(
        rows,
        [
            f"{label}\n{_microseconds(t)} µs per cell"
            for label, t in zip(labels, seconds, strict=True)
        ],
    )
    axes.tick_params(axis="y", labelsize=6)
    axes.invert_yaxis()
    axes.set(xlabel="cells within the tolerance (%)", xlim=(0, 103))
    axes.grid(visible=True, lw=0.3, color="#DDDDDD")
    axes.legend(loc="lower left", fontsize=6)


def _draw_saving(axes: Axes, ladder: xr.Dataset) -> None:
    questions = ladder.question.values.tolist()
    # each cell counts with the time that always running A1 takes in it
    shares = 100 * ladder.chosen_time.values / ladder.always_time.values
    right = 100 * (ladder.chosen_error <= ladder.tolerance).mean(("alpha1", "alpha2")).values
    axes.bar(range(len(questions)), shares, color=[_COLOURS[q] for q in questions], width=0.6)
    for index, (share, good) in enumerate(zip(shares, right, strict=True)):
        axes.text(
            index, share + 1.5, f"{share:.0f} %\n{good:.1f} % right", ha="center",
            fontsize=6, zorder=4, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5},
        )  # fmt: skip
    least = 100 * ladder.hindsight_time.values / ladder.always_time.values
    for colour, width in ((WHITE, 3.2), (BLACK, 1.6)):  # one bar is black
        axes.plot(range(len(questions)), least, "_", color=colour, ms=26, mew=width, zorder=3)
    axes.set_xticks(
        range(len(questions)), [QUESTION_NAMES[q].replace(" ", "\n") for q in questions]
    )
    axes.set(ylabel="cost over always A1 (%)", ylim=(0, 115))


def _microseconds(seconds: float) -> str:
    """Two digits, without an exponent: 0.63, 95, 130."""
    value = float(f"{1e6 * seconds:.2g}")
    return f"{value:g}" if value < 1e5 else f"{value:.0f}"
