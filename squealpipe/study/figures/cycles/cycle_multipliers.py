"""Floquet multipliers along a branch of limit cycles."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting.origin import scene_title
from squealpipe.plotting.style import BLUE, GREY, ORANGE, PAGE, new_figure, panel_letter
from squealpipe.study.figures.cycles.cycle_branches import flutter_title

READS = ("cycles/branch_F3_down", "cycles/branch_flutter")
CAPTION = (
    "Floquet multipliers along two branches of the previous figure, without the trivial one. Dots: "
    "points where the cycle is stable; crosses: where it is not; the circle is the limit of "
    "stability. (a) Scene of Fig. 3, from the study's friction down; (b) the "
    "branch from the onset of flutter."
)
ALT = (
    "Two complex planes with the unit circle and the multipliers of cycles along a branch, or "
    "a note that there is none."
)


def draw(growing: xr.Dataset, flutter: xr.Dataset) -> Figure:
    """Two panels.

    Args:
        growing: branch of the scene of Fig. 3.
        flutter: branch from the onset of flutter.
    """
    figure, axes = new_figure(PAGE, 3.3, ncols=2)
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    titles = (scene_title("F3"), flutter_title(flutter))
    for letter, panel, branch, title in zip("ab", axes[0], (growing, flutter), titles, strict=True):
        panel.plot(np.cos(turn), np.sin(turn), color=GREY, linewidth=0.8)
        real = branch.multiplier_real.values[:, 1:]
        imaginary = branch.multiplier_imag.values[:, 1:]
        stable = branch.stable.values.astype(bool)
        for wanted, colour, marker, words in (
            (stable, BLUE, ".", "stable cycle"),
            (~stable, ORANGE, "x", "unstable cycle"),
        ):
            panel.plot(
                real[wanted].ravel(), imaginary[wanted].ravel(), marker, color=colour,
                markersize=3.5, label=words,
            )  # fmt: skip
        if not stable.size:
            panel.text(0.0, 0.0, "no cycle", ha="center", color=GREY)
        panel.set(xlabel="Re λ", ylabel="Im λ", aspect="equal")
        panel.set_adjustable("datalim")
        panel_letter(panel, letter, title)
    handles, words = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, words, loc="outside lower center", ncols=len(words))
    return figure
