"""What the mass does in each scene: contact force, path and spectrum."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.methods.spectrum import amplitude_spectrum
from squealpipe.study.figures.dynamics.fig02 import FORCE
from squealpipe.study.figures.parts.style import (
    BLUE,
    GREY,
    ORANGE,
    PAGE,
    RED,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr
    from matplotlib.figure import Figure

READS = ("own/*",)
CAPTION = (
    "The motion of model A1 from the start of each scene, one row for each. Left: contact force "
    "over its preload in the first tenth of the run; red strips below zero: contact is lost. "
    "Middle: path of the mass; dashed: contact is lost above. Right: amplitude spectrum of the "
    "contact force over the whole run."
)
ALT = "For each scene a force history, the path of the mass, and the spectrum of the force."
SHOWN = 0.1
"""Share of the run whose force is drawn."""
LOUD = 0.01
"""Amplitude over the largest one above which the spectrum is drawn."""


def draw(runs: Mapping[str, xr.Dataset]) -> Figure:
    """Three panels for each scene, from datasets ``own/<scene>``."""
    figure, axes = new_figure(PAGE, 0.3 + 1.8 * len(runs), nrows=len(runs), ncols=3)
    letters = iter("abcdefghijklmnopqrstuvwxyz" * len(runs))
    for (history, path, spectrum), (name, run) in zip(axes, runs.items(), strict=True):
        time, force = run.time.values, run.normalized_contact_force.values
        shown = time <= SHOWN * time[-1]
        history.plot(time[shown], force[shown], color=BLUE, linewidth=0.7)
        history.fill_between(
            time[shown], -0.08, 0.0, where=run.regime.values[shown] == 3, color=RED, linewidth=0
        )
        history.set(xlim=(0, time[shown][-1]), ylabel=FORCE)
        path.plot(run.x, run.y, color=ORANGE, linewidth=0.4)
        path.axhline(float(run.preload), color=GREY, ls="--", lw=0.8)
        path.set(ylabel="y (m)")
        frequency, amplitude = amplitude_spectrum(force, float(time[1] - time[0]), padding=4)
        loud = np.flatnonzero(amplitude > LOUD * amplitude.max())
        end = 1.2 * frequency[loud[-1]] if loud.size else frequency[-1]
        spectrum.plot(frequency, amplitude, color=BLUE, linewidth=0.7)
        spectrum.set(xlim=(0, end), ylabel="amplitude")
        for panel in (history, path, spectrum):
            panel.ticklabel_format(scilimits=(-3, 4), useMathText=True)
        panel_letter(history, next(letters), f"{name.removeprefix('own/')}: force")
        panel_letter(path, next(letters), "path")
        panel_letter(spectrum, next(letters), "spectrum")
    for panel, label in zip(axes[-1], ("t (s)", "x (m)", "ω (rad/s)"), strict=True):
        panel.set_xlabel(label)
    return figure
