"""Extra figure: contact forces of quasi-static sliding (A2) and of the static state of Eq. (15)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.study.figures.linear.linear_overlay import mark_scene
from squealpipe.study.figures.parts.style import BLACK, PAGE, draw_map, new_figure, panel_letter

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

READS = ("quasi_static_map",)
CAPTION = (
    "Two contact forces that the paper does not tell apart. (a) Reaction Rₙ of A2, which holds the "
    "mass at y = 0; (b) contact force of the static state of Eq. (15), where y settles. Both over "
    "k₃l_pre, red: pressed, blue: k₃ would have to pull. Black lines: where the sign changes. The "
    "force in (b) is proportional to det K, which is zero along α₁ + α₂ = nπ. The cross is the "
    "configuration of Fig. 3."
)
ALT = "Two maps over both angles of contact forces in red where pressed and blue where pulled."
LIMIT = 2.0


def draw(quasi_static: xr.Dataset) -> Figure:
    """Both forces over the preload.

    Args:
        quasi_static: dataset ``quasi_static_map`` whose first angles are 0.
    """
    figure, axes = new_figure(PAGE, 3.3, ncols=2)
    # R_n = F_n/(1 − μK12/K11) is F_n itself where K12 = 0, as in the corner α1 = α2 = 0.
    load = float(quasi_static.reaction_force[0, 0])
    panels = (
        ("reaction of A2 (y = 0)", quasi_static.reaction_force),
        ("static state of Eq. (15)", quasi_static.contact_force_static),
    )
    for panel, letter, (title, force) in zip(axes[0], "ab", panels, strict=True):
        values = force.values / load
        mesh = draw_map(
            panel,
            quasi_static.alpha1.values,
            quasi_static.alpha2.values,
            np.ma.masked_invalid(values),
            cmap="RdBu_r",
            vmin=-LIMIT,
            vmax=LIMIT,
        )
        panel.contour(
            quasi_static.alpha1.values,
            quasi_static.alpha2.values,
            (values < 0).T.astype(float),
            levels=[0.5],
            colors=BLACK,
            linewidths=0.8,
        )
        mark_scene(panel, "F3")
        panel_letter(panel, letter, title)
    figure.colorbar(
        mesh, ax=axes, label=r"force over $k_3 l_\mathrm{pre}$", shrink=0.8, extend="both"
    )  # type: ignore[arg-type]
    return figure
