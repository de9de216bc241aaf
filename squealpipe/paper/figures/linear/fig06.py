"""Fig. 6: quasi-static sliding (A2) and stability (A3) over both spring angles."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.brake.schema.linear import BoundaryCurve
from squealpipe.paper.figures.linear.linear_overlay import (
    draw_boundaries,
    mark_figure_3,
)
from squealpipe.parameters import direction_of
from squealpipe.plotting import style
from squealpipe.plotting.origin import parameter
from squealpipe.study.figures.declared import report_figure


def caption(stability: xr.Dataset, _: xr.Dataset, __: xr.Dataset) -> str:
    """Explain the tones, and the sign of friction where the belt runs along −x."""
    along_x = (
        "Quasi-static sliding (A2) and linear stability (A3) over both spring angles. White: "
        "sliding is possible; grey: it is not; black: the linear model is unstable. Sliding is "
        "judged (a) by Eq. (11) as printed, μ < K₁₁/K₁₂, and (b) by the sign of the reaction "
        "force, μK₁₂ < K₁₁. Lines are the exact boundaries; the cross is the configuration of Fig. "
        "3."
    )
    if direction_of(parameter(stability, "belt_speed")) > 0:
        return along_x
    return f"{along_x} The belt runs along −x: μ counts as negative in (b), not in (a)."


@report_figure(
    reads=("stability_map", "quasi_static_map", "stability_boundaries"),
    caption=caption,
    alt=(
        "Two maps over both spring angles in white, grey and black, one for each reading of Eq. "
        "(11)."
    ),
)
def draw(
    stability: xr.Dataset, quasi_static: xr.Dataset, boundaries: xr.Dataset
) -> Figure:
    """The paper's three tones in both readings of Eq. (11)."""
    figure, axes = style.new_figure(style.PAGE, 3.95, ncols=2)
    readings = (
        (
            "Eq. (11) as printed",
            quasi_static.possible_as_printed,
            BoundaryCurve.no_coupling,
        ),
        ("reaction force positive", quasi_static.possible, None),
    )
    cell_tones = {
        style.Colour.white: "sliding possible",
        style.Colour.light: "sliding not possible",
        style.Colour.black: "linearly unstable",
    }
    for panel, letter, (title, possible, extra) in zip(
        axes[0], "ab", readings, strict=True
    ):
        tones = np.where(possible.values, 0, 1)
        tones[stability.regime_linear.values > 0] = 2
        style.draw_map(panel, stability, tones, **style.category_colours([*cell_tones]))
        curves = [
            BoundaryCurve.flutter,
            BoundaryCurve.divergence,
            BoundaryCurve.reaction_changes_sign,
        ]
        draw_boundaries(
            panel, boundaries, curves if extra is None else [*curves, extra]
        )
        mark_figure_3(panel)
        style.panel_letter(panel, letter, title)
    lines = axes[0, 0].get_legend_handles_labels()[0]
    keys = [*style.patches(cell_tones.items()), *lines]
    figure.legend(handles=keys, loc="outside lower center", ncols=4)
    return figure
