"""Extra figure: areas of the angle map against friction, contact stiffness and regularization."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.study.figures.parts.style import (
    BLUE,
    GREEN,
    ORANGE,
    PAGE,
    RED,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

READS = ("linear_shares",)
CAPTION = (
    "Shares of the angle map. (a) Where quasi-static sliding is not possible, by Eq. (11) as "
    "printed and by the reaction force, over μ. (b) Where it is not possible by A2, though the "
    "static state of Eq. (15) is pressed against the belt, for several κ = k₃/k₁. (c) Where "
    "sliding is possible and the linear model unstable, for the same κ. (d) K₃ of Eq. (8d) and the "
    "unstable share over the regularizing factor σ, at the study's parameters."
)
ALT = "Four line plots of map shares against friction, and of K3 over k3 against sigma."


def draw(shares: xr.Dataset) -> Figure:
    """Four panels, from dataset ``linear_shares``."""
    figure, axes = new_figure(PAGE, 4.8, nrows=2, ncols=2)
    sliding, pressed, unstable, smooth = axes.ravel()
    mu = shares.mu.values
    sliding.plot(
        mu, shares.impossible_as_printed, color=ORANGE, ls="--", label="Eq. (11) as printed"
    )
    sliding.plot(mu, shares.impossible, color=BLUE, label="reaction not positive")
    sliding.set(xlabel="μ", ylabel="share of the map", ylim=(0, None))
    sliding.legend(loc="center right")
    _lines_for_stiffnesses(pressed, shares, "impossible_but_pressed")
    pressed.legend(loc="upper left")
    pressed.set(xlabel="μ", ylabel="share of the map", ylim=(0, None))
    _lines_for_stiffnesses(unstable, shares, "unstable_where_possible")
    unstable.set(xlabel="μ", ylabel="share of the map", ylim=(0, None))
    _regularization(smooth, shares)
    titles = ("sliding not possible", "not possible, yet pressed", "possible, yet unstable",
              "regularization")  # fmt: skip
    for panel, letter, title in zip(axes.ravel(), "abcd", titles, strict=True):
        panel_letter(panel, letter, title)
    return figure


def _lines_for_stiffnesses(panel: Axes, shares: xr.Dataset, name: str) -> None:
    columns = np.unique(np.linspace(0, shares.kappa.size - 1, 5).round().astype(int))[1:]
    looks = zip(columns, (BLUE, GREEN, ORANGE, RED), ("-", "--", "-.", ":"), strict=False)
    for column, colour, dash in looks:
        label = f"κ = {float(shares.kappa[column]):.3g}"
        panel.plot(shares.mu, shares[name][:, column], color=colour, ls=dash, label=label)


def _regularization(panel: Axes, shares: xr.Dataset) -> None:
    panel.semilogx(shares.sharpness, shares.stiffness_ratio, color=BLUE, label="K₃/k₃")
    panel.set(xlabel=r"$\sigma\,l_\mathrm{pre}$", ylabel="K₃/k₃", ylim=(0, None))
    beside = panel.twinx()
    for name, colour, dash in (("flutter", ORANGE, "--"), ("divergence", GREEN, ":")):
        share = shares[f"{name}_regularized"]
        beside.plot(shares.sharpness, share, color=colour, ls=dash, label=name)
    beside.set(ylabel="unstable share of the map", ylim=(0, None))
    beside.spines["right"].set_visible(True)
    panel.legend(handles=[*panel.get_lines(), *beside.get_lines()], loc="lower right")
