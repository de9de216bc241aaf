"""Extra figure: a published mode-coupling model by our A3, and accuracy at the onset of flutter."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting.style import BLACK, BLUE, ORANGE, PAGE, new_figure, panel_letter

READS = ("mode_coupling",)
CAPTION = (
    "External validation: the minimal model of Hoffmann et al. (2002) by our A3 (lines) and by its "
    "published formula (circles). (a) Frequencies and (b) growth rate over μ. (c) Relative error "
    "of the eigenvalues next to the onset at μ = 0.75, against 60 digits; errors below 10⁻¹⁷ are "
    "drawn there."
)
ALT = (
    "Frequencies and growth rate over friction, and eigenvalue errors next to the onset of flutter."
)


def draw(coupling: xr.Dataset) -> Figure:
    """Three panels, from dataset ``mode_coupling``."""
    figure, axes = new_figure(PAGE, 2.6, ncols=3)
    frequency, growth, error = axes[0]
    some = coupling.isel(mu=slice(None, None, 6))
    for mode, colour, dash in ((1, BLUE, "-"), (2, ORANGE, "--")):
        frequency.plot(
            coupling.mu,
            coupling.frequency.sel(mode=mode),
            color=colour,
            ls=dash,
            label=f"mode {mode}",
        )
        frequency.plot(
            some.mu,
            some.published_frequency.sel(mode=mode),
            "o",
            ms=3,
            mfc="none",
            color=BLACK,
            mew=0.6,
            label="published" if mode == 1 else None,
        )
    frequency.set(xlabel="μ", ylabel="frequency (rad/s)")
    first, marks, second = frequency.get_lines()[:3]
    frequency.legend(handles=[first, second, marks])
    growth.plot(coupling.mu, coupling.growth_rate, color=BLUE)
    growth.plot(some.mu, some.published_growth_rate, "o", ms=3, mfc="none", color=BLACK, mew=0.6)
    growth.set(xlabel="μ", ylabel="growth rate (1/s)")
    for name, colour, marker in (("numeric", ORANGE, "^"), ("closed_form", BLUE, "o")):
        worst = coupling[f"{name}_error"].max("side")
        error.loglog(
            coupling.distance,
            np.maximum(worst, 1e-17),
            marker=marker,
            ms=3,
            lw=0.7,
            color=colour,
            label=name.replace("_", " "),
        )
    error.set(xlabel="|μ/0.75 − 1|", ylabel="error of eigenvalues")
    error.legend()
    titles = ("frequencies", "growth", "next to the onset")
    for panel, letter, title in zip(axes[0], "abc", titles, strict=True):
        panel_letter(panel, letter, title)
    return figure
