"""Kinds of motion of model A1 over both spring angles, with impacts and forces."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from squealpipe.parameters import SCENES
from squealpipe.plotting import plot, style
from squealpipe.text import number

READS = ("hammering_map",)
CAPTION = (
    "What model A1 does over both spring angles, started at rest. (a) Kind of motion in the "
    "second half of the run; dots: another kind in its last quarter. (b) Returns to the belt per "
    "unit of time. (c) Share of the time off the belt. (d) Largest contact force over the preload. "
    "The cross is the configuration of Fig. 3."
)
ALT = (
    "Four square maps over both angles: kind of motion, impacts per time, share of time separated, "
    "and peak contact force."
)

FORCE_TICKS = (1, 2, 5, 10, 20, 50, 100, 200, 500)


def draw(hammering: xr.Dataset) -> Figure:
    """Four maps.

    Args:
        hammering: dataset ``hammering_map``.
    """
    figure, axes = style.new_figure(style.PAGE, 6.2, nrows=2, ncols=2)
    angles = hammering.alpha1.values, hammering.alpha2.values
    plot(hammering, ax=axes[0, 0])
    style.panel_letter(axes[0, 0], "a", f"motion to t = {number(float(hammering.t_end), 4)} s")
    force = hammering.peak_contact_force.values
    quantities: list[tuple[str, str, np.ndarray, dict[str, Any]]] = [
        ("b", "impacts per time (1/s)", hammering.impact_rate.values, {}),
        ("c", "share of time separated", hammering.separated_fraction.values, {"vmin": 0}),
        (
            "d",
            r"peak force over $k_3 l_\mathrm{pre}$",
            force,
            {"norm": LogNorm(1.0, max(2.0, force.max()))},
        ),
    ]
    for panel, (letter, title, values, scale) in zip(axes.flat[1:], quantities, strict=True):
        mesh = style.draw_map(panel, *angles, values, cmap="viridis", **scale)
        bar = figure.colorbar(mesh, ax=panel, shrink=0.85)
        if letter == "d":
            ticks = [tick for tick in FORCE_TICKS if tick <= mesh.norm.vmax]
            bar.set_ticks(ticks, labels=[f"{tick:g}" for tick in ticks], minor=False)
            bar.minorticks_off()
        style.panel_letter(panel, letter, title)
    scene = SCENES["F3"]
    for panel in axes.flat:
        for colour, width in (("white", 3.2), (style.BLACK, 1.6)):
            panel.plot(scene.alpha1, scene.alpha2, "x", color=colour, ms=7, mew=width)
    return figure
