"""One run: contact force, displacements, orbit and spectrum."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.study.figures.model.mechanism import SPRING_COLOURS, displaced_springs
from squealpipe.study.figures.parts.style import (
    BLUE,
    GREY,
    PAGE,
    RED,
    X_COLOUR,
    Y_COLOUR,
    new_figure,
    panel_letter,
    pi_label,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORCE = r"$N / (k_3 l_\mathrm{pre})$"


def draw(run: xr.Dataset, summary: xr.Dataset) -> Figure:
    """Four panels of one run.

    Args:
        run: dataset ``simulation``.
        summary: dataset ``run_summary`` of the same run.
    """
    figure, axes = new_figure(PAGE, 4.8, nrows=2, ncols=2)
    _force(axes[0, 0], run)
    _displacement(axes[0, 1], run)
    _orbit(axes[1, 0], run)
    _spectrum(axes[1, 1], summary)
    figure.suptitle(
        f"α₁ = {pi_label(float(run.alpha1))}, α₂ = {pi_label(float(run.alpha2))}, "
        f"model {run.attrs.get('model', 'A1')}",
        fontsize=9,
    )
    return figure


def _force(axes: Axes, run: xr.Dataset) -> None:
    force = run.normalized_contact_force.values
    axes.plot(run.time, force, color=BLUE)
    axes.fill_between(
        run.time.values,
        0,
        1,
        where=force <= 0,
        transform=axes.get_xaxis_transform(),
        color=RED,
        alpha=0.2,
        linewidth=0,
        label="separated",
    )
    axes.set(xlabel="t (s)", ylabel=FORCE, xlim=(0, float(run.time_reached)))
    axes.set_ylim(bottom=0)
    if np.any(force <= 0):
        axes.legend(loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0)
    panel_letter(axes, "a", "contact force")


def _displacement(axes: Axes, run: xr.Dataset) -> None:
    axes.plot(run.time, run.x, color=X_COLOUR, label="x")
    axes.plot(run.time, run.y, color=Y_COLOUR, linestyle="--", label="y")
    axes.axhline(float(run.preload), color=GREY, linewidth=0.8, linestyle=":")
    axes.annotate(
        "$l_\\mathrm{pre}$", (1, float(run.preload)), xycoords=("axes fraction", "data"),
        xytext=(2, 0), textcoords="offset points", va="center", color=GREY, fontsize=7,
    )  # fmt: skip
    axes.set(xlabel="t (s)", ylabel="displacement (m)", xlim=(0, float(run.time_reached)))
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0, ncols=2)
    panel_letter(axes, "b", "displacements")


def _orbit(axes: Axes, run: xr.Dataset) -> None:
    axes.plot(run.x, run.y, color=GREY, linewidth=0.6)
    ends = np.flatnonzero(np.isfinite(run.x.values))
    x, y = float(run.x[ends[-1]]), float(run.y[ends[-1]])
    lengths = (float(run.length1), float(run.length2))
    width = 0.05 * min(lengths)
    springs = displaced_springs(x, y, float(run.alpha1), float(run.alpha2), lengths, width)
    for spring, colour in zip(springs, SPRING_COLOURS, strict=True):
        axes.plot(*spring.T, color=colour, linewidth=0.9)
        axes.plot(*spring[-1], "s", color="black", markersize=3)
    axes.plot(x, y, "o", color="black", markersize=5)
    axes.axhline(float(run.preload), color=GREY, linewidth=0.8, linestyle=":")
    axes.set(xlabel="x (m)", ylabel="y (m)")
    axes.set_aspect("equal", adjustable="datalim")
    panel_letter(axes, "c", "orbit and springs at the end")


def _spectrum(axes: Axes, summary: xr.Dataset) -> None:
    axes.plot(summary.frequency, summary.force_spectrum, color=BLUE)
    axes.plot(summary.dominant_frequency, summary.dominant_amplitude, "v", color=RED, markersize=4)
    peaks = summary.dominant_frequency.values
    axes.set_xlim(0, 1.6 * float(peaks.max()) if peaks.size else None)
    axes.set_ylim(bottom=0)
    axes.set(xlabel="ω (rad/s)", ylabel=f"amplitude of {FORCE}")
    panel_letter(axes, "d", "spectrum of the contact force")
