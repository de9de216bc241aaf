"""Atlas of the periodic motions of model A4 over both spring angles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.figures.style import LIGHT, PAGE, RED, draw_map, new_figure, panel_letter

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "Angular frequency of the exact periodic motions of model A4 that peak at the same y beyond "
    "the loss of contact, over both spring angles. Red lines bound the unstable motions; grey "
    "cells hold none (flutter, divergence, no static state, or the branch turns into an internal "
    "resonance; the dataset's outcome says which)."
)
ALT = "Two square maps of angular frequency over both spring angles, one for each mode."


def draw(atlas: xr.Dataset) -> Figure:
    """A panel a mode from dataset ``orbit_atlas``."""
    figure, axes = new_figure(PAGE, 3.3, ncols=2)
    for panel, letter, mode in zip(axes[0], "ab", atlas.mode.values, strict=True):
        part = atlas.sel(mode=mode)
        panel.set_facecolor(LIGHT)
        omega = np.ma.masked_invalid(part.omega.values)
        mesh = draw_map(panel, atlas.alpha1.values, atlas.alpha2.values, omega, cmap="cividis")
        unstable = (np.abs(part.stability_index.values) > 2).astype(float)
        if unstable.any():
            panel.contour(
                atlas.alpha1.values,
                atlas.alpha2.values,
                unstable.T,
                levels=[0.5],
                colors=RED,
                linewidths=0.7,
            )
        panel_letter(panel, letter, f"mode {mode}, peak at {float(atlas.y_peak):g} m")
        figure.colorbar(mesh, ax=panel, label="ω (rad/s)", shrink=0.8)  # type: ignore[arg-type]
    return figure
