"""Extra figure: the boundaries of Fig. 6 in the plane of Z, where they are circles and a line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.schema.linear import Boundary
from squealpipe.study.figures.linear.linear_overlay import LINES
from squealpipe.study.figures.parts.style import COLUMN, LIGHT, new_figure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

READS = ("stability_boundaries",)
CAPTION = (
    "The boundaries of Fig. 6 in one plane. The angles enter the linear models only through Z = "
    "k₁exp(2iα₁) + k₂exp(−2iα₂), which the springs confine to the shaded area. Here the flutter "
    "boundary is a circle (unstable inside), the divergence boundary a concentric circle (unstable "
    "outside), and the reaction changes sign on a straight line."
)
ALT = "Shaded area of the values that Z can take, with two circular boundaries and a straight one."


def draw(boundaries: xr.Dataset) -> Figure:
    """The curves of dataset ``stability_boundaries`` over Re Z and Im Z."""
    figure, axes = new_figure(COLUMN, 3.9)
    panel = axes[0, 0]
    z = boundaries.z_real.values + 1j * boundaries.z_imag.values
    line = np.abs(z[boundaries.boundary.values == Boundary.no_coupling])
    turn = np.exp(1j * np.linspace(0.0, 2 * np.pi, 181))
    panel.fill((line.max() * turn).real, (line.max() * turn).imag, color=LIGHT, alpha=0.45, lw=0)
    if line.min() > 1e-6 * line.max():
        panel.fill((line.min() * turn).real, (line.min() * turn).imag, color="white", lw=0)
    for kind in Boundary:
        label, look = LINES[kind]
        for segment in np.unique(boundaries.segment.values[boundaries.boundary.values == kind]):
            chosen = boundaries.segment.values == segment
            panel.plot(z[chosen].real, z[chosen].imag, label=label, **look)  # type: ignore[arg-type]
            label = ""
    panel.set(xlabel="Re Z = K₁₁ − K₂₂ (N/m)", ylabel="Im Z = 2K₁₂ (N/m)", aspect="equal")
    figure.legend(loc="outside lower center", ncols=2)
    return figure
