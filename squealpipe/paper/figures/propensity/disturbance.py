"""Smallest disturbances of steady sliding over the number of directions that were tried."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.origin import scene_title
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("disturbance/*",),
    caption=(
        "Smallest disturbance of steady sliding that leads to (a) loss of contact, (b) the whirl, "
        "over the number of random directions tried, by scene. Crosses: after the local search "
        "from each of the best directions, the lowest of them the result. Dashed: contact loss by "
        "the linear motion about the steady state, in closed form. Scenes without a line have no "
        "steady sliding, or one that is unstable, or no disturbance within the bound does it. The "
        "norm is √((x² + y²)/l_pre² + (ẋ² + ẏ²)/(l_pre ω)²) with ω² = (k1 + k2)/(2m)."
    ),
    alt="Two panels of falling lines over the number of directions, with crosses below their ends.",
)
def draw(found: Mapping[str, xr.Dataset]) -> Figure:
    """Two panels."""
    figure, axes = style.new_figure(style.PAGE, 3.0, ncols=2)
    scenes = sorted({name.split("/")[1].partition("_")[0] for name in found})
    # colour and marker of each scene
    marks = dict(
        zip(
            scenes, list(zip(style.Colour.palette, "osv^DP", strict=True)), strict=False
        )
    )
    handles = {}
    for letter, panel, goal, title in zip(
        "ab",
        axes[0],
        ("contact_lost", "whirl"),
        ("loss of contact", "whirl"),
        strict=True,
    ):
        number = next(iter(found.values())).directions.values
        for scene in scenes:
            one = found.get(f"disturbance/{scene}_{goal}")
            if one is None or not np.isfinite(one.distance):
                continue
            colour, marker = marks.get(scene, (style.Colour.grey, "."))
            (handles[scene],) = panel.plot(
                number, one.distance_by_number, marker=marker, ms=3.5, color=colour
            )
            improved = one.improved_distance.values
            panel.plot(
                np.full(improved.size, 1.6 * number[-1]), improved, "x", color=colour
            )
            if np.isfinite(one.linear_distance):
                panel.axhline(float(one.linear_distance), color=colour, ls="--", lw=0.7)
        panel.set(xlabel="random directions", xscale="log", ylim=(0, None))
        if panel.lines:
            panel.set_xticks(
                [*number, 1.6 * number[-1]], [*map(str, number), "local\nsearch"]
            )
        else:
            style.say_instead(panel, "none found")
        panel.minorticks_off()
        style.panel_letter(panel, letter, title)
    axes[0, 0].set_ylabel("smallest disturbance")
    if handles:
        names = map(scene_title, handles)
        figure.legend(handles.values(), names, loc="outside lower center", ncols=4)
    return figure
