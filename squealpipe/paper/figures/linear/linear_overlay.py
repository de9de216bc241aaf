"""Curves and marks that several maps over both angles share."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from squealpipe.brake.schema.linear import BoundaryCurve
from squealpipe.parameters import SCENES
from squealpipe.plotting.origin import scene_title
from squealpipe.plotting.style import Colour


def draw_boundaries(
    axes: Axes, boundaries: xr.Dataset, kinds: Iterable[BoundaryCurve]
) -> None:
    """Exact curves over a map of 0 … π; curves that leave it come in again by periodicity."""
    alpha1, alpha2 = boundaries.alpha1.values, boundaries.alpha2.values
    looks: dict[BoundaryCurve, tuple[str, dict[str, Any]]] = {
        BoundaryCurve.flutter: (
            "flutter boundary",
            {"color": Colour.blue, "linestyle": "-"},
        ),
        BoundaryCurve.divergence: (
            "divergence boundary",
            {"color": Colour.orange, "linestyle": (0, (4, 1))},
        ),
        BoundaryCurve.reaction_changes_sign: (
            "K₁₁ = μK₁₂",
            {"color": Colour.green, "linestyle": (0, (1, 1))},
        ),
        BoundaryCurve.no_coupling: (
            "K₁₂ = 0",
            {"color": Colour.grey, "linestyle": "-."},
        ),
    }
    for kind in kinds:
        label, look = looks[kind]
        for segment in np.unique(
            boundaries.segment.values[boundaries.boundary.values == kind]
        ):
            chosen = boundaries.segment.values == segment
            for shift1, shift2 in np.ndindex(5, 5):
                x = alpha1[chosen] + (shift1 - 2) * np.pi
                y = alpha2[chosen] + (shift2 - 2) * np.pi
                inside = (x >= 0) & (x <= np.pi) & (y >= 0) & (y <= np.pi)
                if inside.any():
                    axes.plot(x, y, linewidth=0.9, label=label, **look)
                    label = ""


def mark_figure_3(axes: Axes, colour: str = Colour.red, **look: Any) -> None:
    """Mark the angles of the paper's Fig. 3 with its ×."""
    look = {"ms": 7, "mew": 1.8, "label": scene_title("F3"), "clip_on": False, **look}
    axes.plot(SCENES["F3"].alpha1, SCENES["F3"].alpha2, "x", color=colour, **look)
