"""Fig. 6: quasi-static sliding (A2) and stability (A3) over both spring angles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.figures.style import BLACK, COLUMN, WHITE, category_colours, draw_map, new_figure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = "Stability of the linearized model over both spring angles; black: unstable."
ALT = "Square map over both spring angles with black unstable areas."


def draw(stability: xr.Dataset) -> Figure:
    """The map in the paper's tones.

    Args:
        stability: dataset ``stability_map``.
    """
    figure, axes = new_figure(COLUMN, 3.4)
    unstable = (stability.regime_linear > 0).astype(int)
    draw_map(
        axes[0, 0],
        stability.alpha1.values,
        stability.alpha2.values,
        unstable.values,
        **category_colours([WHITE, BLACK]),
    )
    return figure
