"""The first moments of each scene, from its own start: contact force and path."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.axis_units import in_units
from squealpipe.plotting.run import draw_force, draw_orbit
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("own/*",),
    caption=(
        "The first moments of each scene from the start in the configuration (at rest under the "
        "whole preload if none is given), not settled. Left: contact force over its preload; red "
        "strips below zero: contact is lost. Right: path of the mass over the whole run, with its "
        "end as a dot; dotted: contact is lost above."
    ),
    alt="For each scene the beginning of the contact force over time, and the path of the mass.",
)
def draw(runs: Mapping[str, xr.Dataset]) -> Figure:
    """Two panels for each scene, from datasets ``own/<scene>``."""
    figure, axes = style.new_figure(
        0.75 * style.PAGE, 0.2 + 2.0 * len(runs), nrows=len(runs), ncols=2
    )
    for (history, path), (name, run) in zip(axes, runs.items(), strict=True):
        # the first tenth of the run, or its first eight events if they take longer
        shown = [0.1 * float(run.time[-1]), *run.event_time.values[:8]]
        draw_force(history, run.sel(time=slice(0.0, float(np.max(shown)))))
        draw_orbit(path, run)
        history.set_title(name.removeprefix("own/"), loc="left", fontweight="bold")
        history.set_ylabel("contact force over preload")
    in_units(figure, (), run)
    return figure
