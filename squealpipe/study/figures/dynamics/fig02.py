"""Fig. 2: contact force of model A1 in four spring arrangements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.parameters import direction_of
from squealpipe.study.figures.model.mechanism import draw_mechanism
from squealpipe.study.figures.parts.origin import parameter
from squealpipe.study.figures.parts.style import (
    BLUE,
    GREY,
    PAGE,
    RED,
    new_figure,
    panel_letter,
    pi_label,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

READS = ("simulate/F2a", "simulate/F2b", "simulate/F2c", "simulate/F2d")
CAPTION = (
    "Contact force of model A1 over its preload, started at rest, in the four spring arrangements "
    "of the paper, each drawn beside its panel. Red strips below zero: contact is lost."
)
ALT = (
    "Four time histories of the normalized contact force, each with a small drawing of its "
    "springs; red strips below the axis mark the spells off the belt."
)
FORCE = r"$N\,/\,(k_3\,l_\mathrm{pre})$"


def draw(*runs: xr.Dataset) -> Figure:
    """Four panels in the order of the paper.

    Args:
        runs: datasets ``simulate/F2a`` … ``simulate/F2d``.
    """
    figure, axes = new_figure(PAGE, 4.3, nrows=2, ncols=2, sharex=True, sharey=True)
    for panel, letter, run in zip(axes.flat, "abcd", runs, strict=True):
        draw_force(panel, run)
        angles = pi_label(float(run.alpha1)), pi_label(float(run.alpha2))
        panel_letter(panel, letter, f"α₁ = {angles[0]}, α₂ = {angles[1]}")
        inset_mechanism(panel, run, (1.005, 0.3, 0.27, 0.6))
    for panel in axes[1]:
        panel.set_xlabel("t (s)")
    for panel in axes[:, 0]:
        panel.set_ylabel(FORCE)
    return figure


def draw_force(axes: Axes, run: xr.Dataset) -> None:
    """Contact force over time, with the spells off the belt marked."""
    time, force = run.time.values, run.normalized_contact_force.values
    axes.plot(time, force, color=BLUE)
    separated = run.regime.values == 3
    axes.fill_between(
        time, -0.06, 0.0, where=separated, color=RED, linewidth=0, step="mid", label="separated"
    )
    axes.axhline(0.0, color=GREY, linewidth=0.5)
    axes.set(xlim=(0.0, float(time[-1])), ylim=(-0.08, max(1.3, 1.1 * np.nanmax(force))))


def inset_mechanism(axes: Axes, run: xr.Dataset, place: tuple[float, float, float, float]) -> None:
    """The spring arrangement of a run with its belt, at a place in axes fractions."""
    inset = axes.inset_axes(place)
    direction = direction_of(parameter(run, "belt_speed"))
    draw_mechanism(inset, float(run.alpha1), float(run.alpha2), direction=direction)
