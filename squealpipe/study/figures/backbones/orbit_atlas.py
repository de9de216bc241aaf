"""Atlas of the periodic motions of model A4 over both spring angles."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from squealpipe.plotting import style
from squealpipe.study.figures.parts.backbone_panels import STABLE_TO_ROUND_OFF
from squealpipe.text import number

READS = ("orbit_atlas",)
CAPTION = (
    "Angular frequency of the exact periodic motions of model A4 that peak at the same y beyond "
    "the loss of contact, over both spring angles (top), and their stability (bottom). The peak is "
    "the larger y of the two at which the mass rests. Grey cells hold none: flutter, divergence, "
    "no static state, or the branch turns into an internal resonance. Where it does and an orbit "
    "beyond was found, that one is shown; the dataset's outcome says where."
)
ALT = "Square maps over both spring angles: angular frequency and stability of each mode."


def draw(atlas: xr.Dataset) -> Figure:
    """One column for each mode, frequency above stability, from dataset ``orbit_atlas``."""
    figure, axes = style.new_figure(style.PAGE, 6.2, nrows=2, ncols=2)
    for (upper, lower), letters, mode in zip(axes.T, ("ac", "bd"), atlas.mode.values, strict=True):
        part = atlas.sel(mode=mode)
        angles = atlas.alpha1.values, atlas.alpha2.values
        upper.set_facecolor(style.LIGHT)
        mesh = style.draw_map(
            upper, *angles, np.ma.masked_invalid(part.omega.values), cmap="cividis"
        )
        style.panel_letter(
            upper, letters[0], f"mode {mode}, peak at {number(float(atlas.y_peak))} m"
        )
        figure.colorbar(mesh, ax=upper, label="ω (rad/s)", shrink=0.85)  # type: ignore[arg-type]
        style.draw_map(
            lower,
            *angles,
            _stability(part),
            **style.category_colours([style.WHITE, style.ORANGE, style.LIGHT]),
        )
        style.panel_letter(lower, letters[1], f"mode {mode}, stability")
    keys = [
        Patch(facecolor=colour, edgecolor="black", linewidth=0.5, label=label)
        for colour, label in (
            (style.WHITE, "stable"),
            (style.ORANGE, "unstable"),
            (style.LIGHT, "no such motion"),
        )
    ]
    figure.legend(handles=keys, loc="outside lower center", ncols=3)
    return figure


def _stability(part: xr.Dataset) -> np.ndarray:
    """0 stable, 1 unstable, 2 no motion; an isolated x motion counts as stable."""
    unstable = np.abs(part.stability_index.values) > STABLE_TO_ROUND_OFF
    return np.where(np.isnan(part.omega.values), 2, unstable.astype(int))
