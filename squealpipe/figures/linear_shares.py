"""Extra figure: areas of the angle map against friction, contact stiffness and regularization."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.figures.style import BLUE, GREEN, ORANGE, PAGE, RED, new_figure, panel_letter

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "Shares of the angle map. (a) Where quasi-static sliding is not possible: by Eq. (11) as "
    "printed about half of the map even without friction, by the reaction force none of it. "
    "(b) Linearly unstable and yet possible to slide, against μ for several κ. (c) What the "
    "regularizing factor σ of Eq. (8d) does to K₃ and to the unstable area at the study's "
    "parameters: nothing beyond σ l_pre ≈ 5."
)
ALT = "Three line plots of map shares against friction, and of K3 over k3 against sigma."


def draw(shares: xr.Dataset) -> Figure:
    """Three panels, from dataset ``linear_shares``."""
    figure, axes = new_figure(PAGE, 2.7, ncols=3)
    sliding, unstable, smooth = axes[0]
    mu = shares.mu.values
    sliding.plot(mu, shares.impossible_as_printed, color=ORANGE, ls="--", label="as printed")
    sliding.plot(mu, shares.impossible, color=BLUE, label="reaction not positive")
    sliding.set(xlabel="μ", ylabel="share where sliding is not possible", ylim=(0, None))
    sliding.legend(loc="center right")
    columns = np.unique(np.linspace(0, shares.kappa.size - 1, 5).round().astype(int))[1:]
    looks = zip(columns, (BLUE, GREEN, ORANGE, RED), ("-", "--", "-.", ":"), strict=False)
    for column, colour, dash in looks:
        unstable.plot(
            mu,
            shares.unstable_where_possible[:, column],
            color=colour,
            ls=dash,
            label=f"κ = {float(shares.kappa[column]):.3g}",
        )
    unstable.set(xlabel="μ", ylabel="share unstable where sliding is possible", ylim=(0, None))
    unstable.legend(loc="upper left")
    smooth.semilogx(shares.sharpness, shares.stiffness_ratio, color=BLUE, label="K₃/k₃")
    smooth.set(xlabel="σ l_pre", ylabel="K₃/k₃", ylim=(0, None))
    beside = smooth.twinx()
    beside.plot(
        shares.sharpness, shares.flutter_regularized, color=ORANGE, ls="--", label="flutter"
    )
    beside.plot(
        shares.sharpness, shares.divergence_regularized, color=GREEN, ls=":", label="divergence"
    )
    beside.set(ylabel="share unstable", ylim=(0, None))
    beside.spines["right"].set_visible(True)
    lines = [*smooth.get_lines(), *beside.get_lines()]
    smooth.legend(handles=lines, loc="lower right")
    for panel, letter in zip(axes[0], "abc", strict=True):
        panel_letter(panel, letter)
    return figure
