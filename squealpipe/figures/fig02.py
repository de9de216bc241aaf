"""Fig. 2: contact force of model A1 in four spring arrangements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.figures.mechanism import draw_mechanism
from squealpipe.figures.style import BLUE, GREY, PAGE, RED, new_figure, panel_letter, pi_label

if TYPE_CHECKING:
    from collections.abc import Sequence

    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAPTION = (
    "Contact force of model A1 over its preload, started at rest, with the spring arrangement of "
    "each panel. (a)–(c) The mass keeps contact and the three responses differ little: they have "
    "the same stiffness matrix, and differ only by the geometry of long springs. (d) The force "
    "reaches zero again and again (red): the pad leaves the disc and comes back with a blow."
)
ALT = (
    "Four time histories of the normalized contact force with small drawings of the springs. In "
    "three of them the force swings between about 0.1 and 1; in the fourth it is zero for about "
    "half of the time, in spells marked red."
)
FORCE = "contact force / k₃ l_pre"


def draw(runs: Sequence[xr.Dataset]) -> Figure:
    """Four panels in the order of the paper.

    Args:
        runs: datasets ``simulate/F2a`` … ``simulate/F2d``.
    """
    figure, axes = new_figure(PAGE, 4.3, nrows=2, ncols=2, sharex=True, sharey=True)
    for panel, letter, run in zip(axes.flat, "abcd", runs, strict=True):
        draw_force(panel, run)
        angles = float(run.alpha1), float(run.alpha2)
        panel_letter(panel, letter, f"α₁ = {pi_label(angles[0])}, α₂ = {pi_label(angles[1])}")
        inset_mechanism(panel, *angles, (1.005, 0.3, 0.27, 0.6))
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


def inset_mechanism(
    axes: Axes, alpha1: float, alpha2: float, place: tuple[float, float, float, float]
) -> None:
    """The spring arrangement in a corner, in axes fractions."""
    inset = axes.inset_axes(place)
    draw_mechanism(inset, alpha1, alpha2)
