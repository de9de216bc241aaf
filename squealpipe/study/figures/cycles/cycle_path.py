"""One limit cycle in the plane and in time, its regimes coloured."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.schema import meanings
from squealpipe.study.figures.parts.backbone_panels import key_entries
from squealpipe.study.figures.parts.origin import parameter
from squealpipe.study.figures.parts.style import (
    GREY,
    PAGE,
    REGIME_COLOURS,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

READS = ("cycles/limit_F3",)
CAPTION = (
    "The limit cycle of the scene of Fig. 3 with dashpots, at the study's friction, if there is "
    "one. (a) Path of the mass; the line is l_pre, above which contact is lost. (b) Velocity along "
    "the belt over one period; the dashed line is belt speed. Colours: the regime."
)
ALT = (
    "Left, the path of the cycle in the plane of x and y, to scale; right, its velocity over one "
    "period. Regimes differ in colour; a panel without a cycle says so."
)


def draw(cycle: xr.Dataset) -> Figure:
    """Two panels.

    Args:
        cycle: dataset of ``limit_cycle``.
    """
    figure, axes = new_figure(PAGE, 3.0, ncols=2)
    path, rate = axes[0]
    if not cycle.sizes["sample"]:
        for panel in (path, rate):
            panel.text(0.5, 0.5, "no cycle", transform=panel.transAxes, ha="center", color=GREY)
            panel.set(xticks=[], yticks=[])
    else:
        _coloured(path, cycle.x_path.values, cycle.y_path.values, cycle)
        _coloured(rate, cycle.time.values, cycle.vx_path.values, cycle)
        height, speed = parameter(cycle, "preload"), parameter(cycle, "belt_speed")
        path.axhline(height, color=GREY, lw=0.6, label=r"$l_\mathrm{pre}$: contact is lost above")
        path.set(aspect="equal", adjustable="datalim")
        rate.axhline(speed, color=GREY, lw=0.6, ls="--", label="belt speed")
        handles, words = key_entries((path, rate))
        figure.legend(handles, words, loc="outside lower center", ncols=len(words))
    path.set(xlabel="x (m)", ylabel="y (m)")
    rate.set(xlabel="t (s)", ylabel="velocity along the belt (m/s)")
    panel_letter(path, "a", "path")
    panel_letter(rate, "b", "velocity")
    return figure


def _coloured(panel: Axes, x: np.ndarray, y: np.ndarray, cycle: xr.Dataset) -> None:
    flags = meanings(cycle.regime_path)
    regimes = cycle.regime_path.values
    for value in np.unique(regimes):
        here = np.isin(np.arange(len(x)), np.flatnonzero(regimes == value))
        # one sample further, so that pieces join
        here |= np.roll(here, 1) & (np.arange(len(x)) > 0)
        name = flags[int(value)]
        panel.plot(
            np.where(here, x, np.nan), np.where(here, y, np.nan),
            color=REGIME_COLOURS[name], linewidth=1.4, label=name.replace("_", ", "),
        )  # fmt: skip
