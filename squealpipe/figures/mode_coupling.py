"""Extra figure: a published mode-coupling model by our A3, and accuracy at the onset of flutter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.figures.style import BLACK, BLUE, ORANGE, PAGE, new_figure, panel_letter

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "External validation: the minimal model of Hoffmann et al. (2002) by our A3. (a) The two "
    "frequencies merge at μ = 0.75 (circles: published formula). (b) Beyond it one solution "
    "grows. (c) Next to the onset the matrix is defective and numeric eigenvalues lose half of "
    "their digits; the closed form does not. Errors are relative, against 60 digits; smaller "
    "ones are drawn at 10⁻¹⁷."
)
ALT = "Frequencies merging with friction, growth beyond, and eigenvalue errors next to the onset."


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
        )
    frequency.set(xlabel="μ", ylabel="frequency (rad/s)")
    frequency.legend()
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
    for panel, letter in zip(axes[0], "abc", strict=True):
        panel_letter(panel, letter)
    return figure
