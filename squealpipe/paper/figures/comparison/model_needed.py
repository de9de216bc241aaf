"""The cheapest sufficient model level at a glance: a bar for each question."""

import numpy as np
import xarray as xr
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from squealpipe.brake.schema.ladder import Level
from squealpipe.paper.figures.comparison.model_ladder import (
    QUESTION_NAMES,
    shares_of_a3,
)
from squealpipe.plotting import style
from squealpipe.study.figures.declared import report_figure


def caption(ladder: xr.Dataset) -> str:
    """Describe the bars, and why two of them answer one question."""
    hindsight, beforehand = shares_of_a3(ladder)
    cost = 100 * float(ladder.chosen_cpu_time / ladder.always_cpu_time)
    return (
        "Share of all pairs of spring angles at which a level is the cheapest that answers as A1 "
        f"does, within {100 * float(ladder.tolerance):g} %. All bars but the second are "
        "hindsight: A1 was run to know which would have done, A3 for contact loss at "
        f"{hindsight:.0f} % of the angles. The second is what is known beforehand: choose_model "
        f"trusts A3 at {beforehand:.0f} %, where its motion stays clear of losing contact by a "
        "margin, and runs A1 up to the first loss at the others. It was wrong at "
        f"{int(ladder.chosen_wrong.sum())} of {ladder.chosen.size} pairs of angles and took "
        f"{cost:.0f} % of the CPU time of A1 alone."
    )


@report_figure(
    reads=("model_ladder",),
    caption=caption,
    alt="Five bars, each divided among model levels by the share of angles they suffice for.",
)
def draw(ladder: xr.Dataset) -> Figure:
    """The bars, from dataset ``model_ladder``."""
    lost, *others = ladder.question.values.tolist()
    bars = {
        QUESTION_NAMES[lost]: ladder.cheapest.sel(question=lost),
        "contact lost?\n(beforehand)": ladder.chosen,
    }
    for question in others:
        bars[QUESTION_NAMES[question]] = ladder.cheapest.sel(question=question)
    present = [
        level
        for level in Level
        if any((cells == level).any() for cells in bars.values())
    ]
    figure, axes = style.new_figure(style.PAGE, 2.3)
    panel = axes[0, 0]
    for row, cells in enumerate(bars.values()):
        left = 0.0
        for level in present:
            share = float((cells == level).mean())
            colour = style.colour_of(level)
            panel.barh(row, 100 * share, left=left, color=colour, ec="white", lw=0.8)
            # a number does not fit inside a narrower part of a bar
            if share >= 0.04:
                dark = np.dot(to_rgb(colour), (0.299, 0.587, 0.114)) < 0.5
                ink = style.Colour.white if dark else style.Colour.black
                middle, words = left + 50 * share, f"{100 * share:.0f}"
                style.write(panel, middle, row, words, color=ink)
            left += 100 * share
    panel.set_yticks(range(len(bars)), list(bars))
    panel.invert_yaxis()
    panel.set(xlim=(0.0, 100.0), xlabel="share of the pairs of spring angles (%)")
    panel.tick_params(axis="y", length=0)
    keys = style.patches(
        ((style.colour_of(level), level.label) for level in present), edgecolor="none"
    )
    figure.legend(handles=keys, loc="outside upper center", ncols=len(keys))
    return figure
