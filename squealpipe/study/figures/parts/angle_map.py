"""A picture of any dataset over both spring angles, for the command line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from squealpipe.schema import meanings
from squealpipe.study.figures.parts.style import (
    COLUMN,
    REGIME_COLOURS,
    category_colours,
    draw_map,
    flag_words,
    new_figure,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Shown:
    """The variable of a schema that its picture shows, and the dimensions fixed for it."""

    name: str
    at: tuple[tuple[str, object], ...] = ()

    def variable(self, dataset: xr.Dataset) -> xr.DataArray:
        """The variable, over both angles only."""
        return dataset[self.name].sel(dict(self.at))

    def counts(self, dataset: xr.Dataset) -> list[str]:
        """What the map holds, in words."""
        variable = self.variable(dataset)
        if table := meanings(variable):
            codes, numbers = np.unique(variable.values, return_counts=True)
            return [
                f"{number} of {variable.size} cells: {flag_words(table[code])}"
                for code, number in zip(codes, numbers, strict=True)
            ]
        values = variable.values
        finite = np.isfinite(values)
        return [
            f"{_label(variable)}: in {np.count_nonzero(finite)} of {values.size} cells, "
            f"from {values[finite].min():.6g} to {values[finite].max():.6g}"
            if finite.any()
            else f"{_words(variable)}: in no cell"
        ]


SHOWN = {
    "validity_map": Shown("first_separation_time"),
    "hammering_map": Shown("motion"),
    "quasi_static_map": Shown("reaction_force"),
    "stability_map": Shown("regime_linear"),
    "critical_friction_map": Shown("critical_mu"),
    "natural_frequencies": Shown("omega", (("mode", 1), ("contact_state", "contact"))),
}
"""Schema → what its picture shows."""


def draw(dataset: xr.Dataset) -> Figure:
    """The map of a dataset's first interest, in the colours of all other figures.

    Args:
        dataset: a map whose schema is a key of :data:`SHOWN`.
    """
    variable = SHOWN[str(dataset.attrs["schema"])].variable(dataset)
    figure, axes = new_figure(COLUMN, 3.1)
    axis, values = axes[0, 0], variable.values.astype(float)
    angles = (dataset.alpha1.values, dataset.alpha2.values)
    table = meanings(variable)
    if not table:
        finite = values[np.isfinite(values)]
        low, high = np.percentile(finite, [1, 99]) if finite.size else (0, 1)
        mesh = draw_map(axis, *angles, values, cmap="viridis", vmin=low, vmax=high)
        figure.colorbar(mesh, ax=axis, label=_label(variable), extend="both", shrink=0.85)
        return figure
    present, places = np.unique(variable.values, return_inverse=True)
    names = [table[code] for code in present]
    colours = category_colours([REGIME_COLOURS[name] for name in names])
    mesh = draw_map(axis, *angles, places.reshape(values.shape), **colours)
    bar = figure.colorbar(mesh, ax=axis, ticks=range(len(names)), shrink=0.85)
    bar.ax.set_yticklabels([name.replace("_", "\n") for name in names])
    return figure


def _words(variable: xr.DataArray) -> str:
    return str(variable.long_name).split(" (")[0]


def _label(variable: xr.DataArray) -> str:
    words = _words(variable)
    return words if variable.units == "1" else f"{words} ({variable.units})"
