"""Convergence of harmonic balance to the exact orbits over N_h, N and σ."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.origin import scene_name

READS = ("harmonic_sweep",)
CAPTION = (
    "Errors of harmonic balance against exact orbits, median over the peaks. (a) ω at equal peak "
    "and (b) the waveform over the harmonics N_h, with contact integrals in closed form; thin "
    "lines have the slopes −4 and −3. (c) ω over the samples N of a sampled contact force; dashed: "
    "the closed form at the same N_h. (d) Shift of ω by tanh smoothing over σ; the thin line has "
    "the slope −2."
)
ALT = "Four log-log panels of errors over harmonics, samples and smoothing."
COLOURS = (style.BLUE, style.ORANGE, style.GREEN, style.RED, style.PURPLE, style.BLACK)
MARKERS = "osv^DP"


PANELS = (
    ("omega_error", "harmonics", r"$N_\mathrm{h}$", "error of ω (rad/s)", -4),
    ("waveform_error", "harmonics", r"$N_\mathrm{h}$", "waveform error (m)", -3),
    ("omega_error_samples", "samples", "$N$", "error of ω (rad/s)", None),
    ("omega_error_sigma", "sigma", r"$\sigma\,l_\mathrm{pre}$", "shift of ω (rad/s)", -2),
)
"""Variable, setting, both labels and the slope drawn beside, of each panel."""


def draw(sweep: xr.Dataset) -> Figure:
    """Four panels from dataset ``harmonic_sweep``."""
    figure, axes = style.new_figure(style.PAGE, 5.2, nrows=2, ncols=2)
    panels = axes.ravel()
    for panel, (name, setting, xlabel, ylabel, slope) in zip(panels, PANELS, strict=True):
        _lines(sweep, panel, sweep[name].median("peak"), setting, slope)
        panel.set(xlabel=xlabel, ylabel=ylabel)
    fixed = int(sweep.n_harmonics_fixed)
    at_fixed = sweep.omega_error.sel(
        harmonics=[count for count in sweep.harmonics.values if count == fixed]
    )
    if at_fixed.sizes["harmonics"]:
        panels[2].axhline(float(at_fixed.median()), color=style.GREY, linestyle="--", linewidth=0.9)
        panels[2].annotate(
            "closed form", (0.03, float(at_fixed.median())), fontsize=7, color=style.GREY,
            xycoords=panels[2].get_yaxis_transform(), xytext=(0, 2), textcoords="offset points",
        )  # fmt: skip
    titles = (
        "truncation: frequency",
        "truncation: waveform",
        f"sampling, N_h = {fixed}",
        f"smoothing, N_h = {fixed}",
    )
    for panel, letter, title in zip(panels, "abcd", titles, strict=True):
        style.panel_letter(panel, letter, style.symbols(title))
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _lines(
    sweep: xr.Dataset, panel: Axes, errors: xr.DataArray, name: str, slope: int | None
) -> None:
    settings = errors[name].values.astype(float)
    for index, scene in enumerate(errors.scene.values):
        panel.plot(
            settings,
            errors.sel(scene=scene).values,
            marker=MARKERS[index % len(MARKERS)],
            color=COLOURS[index % len(COLOURS)],
            markersize=3.5,
            label=scene_name(sweep, str(scene)),
        )
    if slope is not None:
        start = 2.5 * float(np.nanmax(errors.values[:, 0]))
        panel.plot(
            settings, start * (settings / settings[0]) ** slope, color=style.GREY, linewidth=0.7
        )
        panel.annotate(
            f"slope −{-slope}", (0.97, 0.95), xycoords="axes fraction", ha="right", va="top",
            fontsize=7, color=style.GREY,
        )  # fmt: skip
    panel.set(xscale="log", yscale="log")
    panel.set_xticks(settings, [f"{value:g}" for value in settings])
    panel.minorticks_off()
