"""One period of the strongest line of each scene's settled motion, as a strip of eight phases."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.codes import Verdict
from squealpipe.plotting import style
from squealpipe.plotting.animation import draw_phases
from squealpipe.plotting.motion_panels import COLOURS_IN_WORDS
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("assess/*",),
    caption=(
        "The settled motion of each scene over one period of its strongest line, from left to "
        "right. The mass is drawn on its springs above the belt, its displacements enlarged. "
        f"{COLOURS_IN_WORDS}"
    ),
    alt="For each scene eight drawings of the mass on its springs, an eighth of a period apart.",
)
def draw(answers: Mapping[str, xr.Dataset]) -> Figure:
    """One row of eight phases for each scene, from datasets ``assess/<scene>``."""
    figure, axes = style.new_figure(
        style.PAGE, 0.2 + 1.35 * len(answers), nrows=len(answers), ncols=8
    )
    for row, (name, answer) in zip(axes, answers.items(), strict=True):
        for panel in row:
            panel.set_axis_off()
        words = name.removeprefix("assess/")
        if int(answer.verdict) == Verdict.quiet or not np.isfinite(answer.path_x).all():
            style.say_instead(row[0], "dies out")
            row[0].set_title(words, fontsize=8, loc="left")
            continue
        scale = draw_phases(list(row), answer)
        # write the scene one line above the instants: it is wider than a panel
        for panel in row:
            panel.set_title(f"\n{panel.get_title()}", fontsize=7)
        scene = row[0].annotate(
            f"{words}, {scale}",
            (0.0, 1.0),
            (0.0, 16.0),
            "axes fraction",
            "offset points",
            fontsize=7,
        )
        scene.set_in_layout(False)  # else the first panel gets the width of the text
    return figure
