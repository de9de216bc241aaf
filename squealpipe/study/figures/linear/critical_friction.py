"""Critical friction over the angles, with and without dashpots, and over both dashpots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import Patch

from squealpipe.study.figures.parts.origin import angle_pair, parameter
from squealpipe.study.figures.parts.style import (
    BLACK,
    PAGE,
    WHITE,
    draw_map,
    new_figure,
    panel_letter,
)
from squealpipe.text import number

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

READS = ("critical_friction_map", "critical_damping_map")
LARGEST = 1.5
"""Upper end of the colours."""
ALT = "Two maps over both spring angles and one over both dashpots, coloured by critical friction."


def caption(angles: xr.Dataset, _: xr.Dataset) -> str:
    """What is shown, with the dashpots of the maps."""
    c1, c2 = (number(parameter(angles, f"damping{i}")) for i in (1, 2))
    return (
        "Friction coefficient of Coulomb's law at which steady sliding turns unstable by A3 "
        f"(Routh–Hurwitz), over both spring angles (a) without dashpots, (b) with c₁ = {c1} and "
        f"c₂ = {c2} N s/m; hatched: the dashpots lower the critical friction. (c) Over both "
        "dashpots at one pair of angles; white line: as without dashpots, hatched: below that."
    )


CAPTION = caption


def draw(angles: xr.Dataset, dashpots: xr.Dataset) -> Figure:
    """Three maps.

    Args:
        angles: dataset ``critical_friction_map``.
        dashpots: dataset ``critical_damping_map``.
    """
    figure, axes = new_figure(PAGE, 2.7, ncols=3)
    without, with_dashpots, plane = axes[0]
    colours: dict[str, Any] = {"cmap": "viridis", "vmin": 0.0, "vmax": LARGEST}
    grid = angles.alpha1.values, angles.alpha2.values
    for panel, name in ((without, "critical_mu_undamped"), (with_dashpots, "critical_mu")):
        draw_map(panel, *grid, np.minimum(angles[name].values, 2 * LARGEST), **colours)
    _hatch(with_dashpots, *grid, angles.destabilized.values)
    with_dashpots.set_ylabel("")
    c1, c2 = dashpots.damping1.values, dashpots.damping2.values
    values = np.minimum(dashpots.critical_mu.values, 2 * LARGEST)
    mesh = plane.pcolormesh(c1, c2, values.T, shading="nearest", rasterized=True, **colours)
    _hatch(plane, c1, c2, dashpots.destabilized.values)
    level = float(dashpots.critical_mu_undamped)
    if values.min() < level < values.max():
        plane.contour(c1, c2, values.T, levels=[level], colors=[WHITE], linewidths=1.0)
    plane.set(xlabel="dashpot c₁ (N s/m)", ylabel="dashpot c₂ (N s/m)", aspect="equal")
    panel_letter(without, "a", "no dashpots")
    panel_letter(with_dashpots, "b", "with dashpots")
    panel_letter(plane, "c", f"at {angle_pair(dashpots.alpha1, dashpots.alpha2)}")
    figure.colorbar(mesh, ax=axes[0], label="critical friction", extend="max", shrink=0.7)
    figure.legend(
        handles=[
            Patch(facecolor=WHITE, edgecolor=BLACK, hatch="////", label="lowered by dashpots")
        ],
        loc="outside lower center",
    )
    return figure


def _hatch(panel: Any, x: np.ndarray, y: np.ndarray, marked: np.ndarray) -> None:
    if marked.any():
        cells = marked.T.astype(float)
        panel.contourf(x, y, cells, levels=[0.5, 1.5], colors="none", hatches=["////"])
