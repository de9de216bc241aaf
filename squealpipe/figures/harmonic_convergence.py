"""Convergence of harmonic balance to the exact orbits over N_h, N and σ."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PAGE,
    PURPLE,
    RED,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAPTION = (
    "Errors of harmonic balance against exact orbits, median over the peaks. (a) ω at equal peak "
    "and (b) the waveform over the harmonics N_h, with contact integrals in closed form; thin "
    "lines fall like N_h⁻⁴ and N_h⁻³. (c) ω over the samples N of a sampled contact force: the "
    "dashed line is the closed form at the same N_h. (d) The shift of ω by tanh smoothing; the "
    "thin line falls like σ⁻²."
)
ALT = "Four log-log panels of falling errors over harmonics, samples and smoothing."
COLOURS = (BLUE, ORANGE, GREEN, RED, PURPLE, BLACK)
MARKERS = "osv^DP"


def draw(sweep: xr.Dataset) -> Figure:
    """Four panels from dataset ``harmonic_sweep``."""
    figure, axes = new_figure(PAGE, 5.2, nrows=2, ncols=2)
    panels = axes.ravel()
    _lines(
        panels[0],
        sweep.omega_error.median("peak"),
        "harmonics",
        r"$N_\mathrm{h}$",
        "error of ω (rad/s)",
        -4,
    )
    _lines(
        panels[1],
        sweep.waveform_error.median("peak"),
        "harmonics",
        r"$N_\mathrm{h}$",
        "waveform error (m)",
        -3,
    )
    _lines(
        panels[2],
        sweep.omega_error_samples.median("peak"),
        "samples",
        "N",
        "error of ω (rad/s)",
        None,
    )
    _lines(
        panels[3],
        sweep.omega_error_sigma.median("peak"),
        "sigma",
        r"$\sigma\,l_\mathrm{pre}$",
        "shift of ω (rad/s)",
        -2,
    )
    fixed = int(sweep.n_harmonics_fixed)
    at_fixed = sweep.omega_error.sel(
        harmonics=[count for count in sweep.harmonics.values if count == fixed]
    )
    if at_fixed.sizes["harmonics"]:
        panels[2].axhline(float(at_fixed.median()), color=GREY, linestyle="--", linewidth=0.9)
    titles = ("truncation", "truncation", f"sampling, N_h = {fixed}", f"smoothing, N_h = {fixed}")
    for panel, letter, title in zip(panels, "abcd", titles, strict=True):
        panel_letter(panel, letter, title)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _lines(
    panel: Axes, errors: xr.DataArray, name: str, xlabel: str, ylabel: str, slope: int | None
) -> None:
    settings = errors[name].values.astype(float)
    for index, scene in enumerate(errors.scene.values):
        panel.plot(
            settings,
            errors.sel(scene=scene).values,
            marker=MARKERS[index % len(MARKERS)],
            color=COLOURS[index % len(COLOURS)],
            markersize=3.5,
            label=str(scene),
        )
    if slope is not None:
        start = 2.5 * float(np.nanmax(errors.values[:, 0]))
        panel.plot(settings, start * (settings / settings[0]) ** slope, color=GREY, linewidth=0.7)
    panel.set(xscale="log", yscale="log", xlabel=xlabel, ylabel=ylabel)
    panel.set_xticks(settings, [f"{value:g}" for value in settings])
    panel.minorticks_off()
