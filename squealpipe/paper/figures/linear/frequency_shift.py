"""Extra figure: how far the natural frequencies shift when contact is lost."""

import numpy as np
import xarray as xr
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from squealpipe.paper.figures.panels.frequency_map import hatch_key, isoline, outline
from squealpipe.plotting.style import PAGE, draw_map, new_figure, panel_letter
from squealpipe.schema import Outcome
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.words import number

NO_SHIFT = 1e-9
"""A shift below this is none: where K12 = 0 one frequency does not depend on contact."""


@report_figure(
    reads=("natural_frequencies",),
    caption=(
        "Natural frequencies separated minus in contact, paired by their order: (a) ω₁, (b) ω₂. "
        "Blue: the frequency falls when contact is lost; red: it rises, on a scale of its own; "
        "black lines lie between the two. Hatched: flutter in contact."
    ),
    alt="Two maps over both angles of the frequency shift between contact states, in blue and red.",
)
def draw(frequencies: xr.Dataset) -> Figure:
    """Both modes, from dataset ``natural_frequencies``."""
    figure, axes = new_figure(PAGE, 3.3, ncols=2)
    shift = frequencies.omega.sel(contact_state="separated") - frequencies.omega.sel(
        contact_state="contact"
    )
    for panel, letter, mode in zip(axes[0], "ab", (1, 2), strict=True):
        values = shift.sel(mode=mode).values
        low = min(float(values.min()), -NO_SHIFT)
        high = max(float(values.max()), NO_SHIFT)
        scale = TwoSlopeNorm(0.0, low, high)
        mesh = draw_map(panel, frequencies, values, cmap="RdBu_r", norm=scale)
        isoline(panel, frequencies, values, NO_SHIFT, "black")
        outcome = frequencies.outcome.sel(mode=mode, contact_state="contact").values
        outline(panel, frequencies, outcome == Outcome.complex_pair)
        panel_letter(panel, letter, f"shift of ω{'₁₂'[mode - 1]}")
        label = "separated − contact (rad/s)" if mode == 2 else ""
        ticks = [*np.linspace(low, 0, 5), *np.linspace(0, high, 3)[1:]]
        bar = figure.colorbar(mesh, ax=panel, label=label, shrink=0.8)
        bar.set_ticks(ticks, labels=[number(float(tick), 2) for tick in ticks])
    figure.legend(handles=[hatch_key], loc="outside lower center")
    return figure
