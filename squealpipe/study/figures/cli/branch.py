"""A picture of one backbone, for the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.study.figures.parts.backbone_panels import say_why_empty
from squealpipe.study.figures.parts.style import COLUMN, GREY, X_COLOUR, Y_COLOUR, new_figure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


def draw(branch: xr.Dataset, *, preload: float) -> Figure:
    """Peak of y and amplitude of x over the frequency; open marks are unstable.

    Args:
        branch: dataset ``backbone``; an empty one gives the reason instead.
        preload: l_pre, m: above it contact is lost.
    """
    figure, axes = new_figure(COLUMN, 2.8)
    axis = axes[0, 0]
    if not branch.sizes["point"]:
        say_why_empty(axis, branch)
        return figure
    unstable = np.abs(branch.stability_index.values) > 2
    lines = (
        (branch.y_peak, Y_COLOUR, "-", "y peak"),
        (branch.x_amplitude, X_COLOUR, "--", "x amplitude"),
    )
    for values, colour, dash, label in lines:
        axis.plot(branch.omega, values, color=colour, linestyle=dash, label=label)
        axis.plot(
            branch.omega[unstable],
            values[unstable],
            linestyle="none",
            marker="o",
            markerfacecolor="white",
            markeredgecolor=colour,
            markersize=3,
        )
    axis.axhline(preload, color=GREY, linewidth=0.8, linestyle=":")
    axis.annotate(
        r"$l_\mathrm{pre}$", (1, preload), xycoords=("axes fraction", "data"),
        xytext=(2, 0), textcoords="offset points", va="center", color=GREY, fontsize=7,
    )  # fmt: skip
    axis.set(xlabel="ω (rad/s)", ylabel="displacement (m)")
    axis.set_ylim(bottom=0)
    axis.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=2, borderaxespad=0)
    return figure
