"""Extra figure: how far the natural frequencies shift when contact is lost."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.schema import Outcome
from squealpipe.study.figures.parts.frequency_map import HATCH, outline
from squealpipe.study.figures.parts.style import PAGE, draw_map, new_figure, panel_letter

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

READS = ("natural_frequencies",)
CAPTION = (
    "Natural frequencies separated minus in contact, paired by their order: (a) ω₁, (b) ω₂. Blue: "
    "the frequency falls when contact is lost; red: it rises; black lines lie between the two. "
    "Hatched: flutter in contact."
)
ROUND_OFF = 1e-9
"""A shift below this is none: where K12 = 0 one frequency does not depend on contact."""
ALT = "Two maps over both angles of the frequency shift between contact states, in blue and red."


def draw(frequencies: xr.Dataset) -> Figure:
    """Both modes, from dataset ``natural_frequencies``."""
    figure, axes = new_figure(PAGE, 3.5, ncols=2)
    shift = frequencies.omega.sel(contact_state="separated") - frequencies.omega.sel(
        contact_state="contact"
    )
    limit = float(np.abs(shift).max())
    for panel, letter, mode in zip(axes[0], "ab", (1, 2), strict=True):
        values = shift.sel(mode=mode).values
        mesh = draw_map(
            panel,
            frequencies.alpha1.values,
            frequencies.alpha2.values,
            values,
            cmap="RdBu_r",
            vmin=-limit,
            vmax=limit,
        )
        panel.contour(
            frequencies.alpha1.values,
            frequencies.alpha2.values,
            values.T,
            levels=[ROUND_OFF],
            colors="black",
            linewidths=0.7,
        )
        outcome = frequencies.outcome.sel(mode=mode, contact_state="contact").values
        outline(panel, frequencies, outcome == Outcome.complex_pair)
        panel_letter(panel, letter, f"shift of ω{'₁₂'[mode - 1]}")
    figure.legend(handles=[HATCH], loc="outside lower center")
    figure.colorbar(mesh, ax=axes, label="separated − contact (rad/s)", shrink=0.8)  # type: ignore[arg-type]
    return figure
