"""Work–precision of harmonic balance and of eigenvalues near flutter onset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.study.figures.parts.style import BLUE, ORANGE, PAGE, RED, new_figure, panel_letter
from squealpipe.study.figures.parts.work_precision import (
    FALLBACK,
    Mark,
    draw_methods,
    foot,
    legend_above,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

READS = ("work_precision_frequencies",)
CAPTION = (
    "Harmonic balance on model A4: median error of ω at equal peak of y against exact orbits, over "
    "N_h, the number of samples N, and σ (points of a line run over N_h or σ), against (a) wall "
    "time and (b) evaluations of the balance's equations. The exact orbit itself is shown with the "
    "velocity left after half a period. (c) Error of both ω next to flutter onset, stable (full) "
    "and in flutter (dotted), over the distance from it and (d) against wall time. Grey band: "
    "Pareto front; red rings: our settings. Machine and versions are named below the panels."
)
ALT = (
    "Charts of frequency error against cost for forms of harmonic balance, and of the error of "
    "eigenvalues against the distance from flutter onset and against time."
)
_EXACT = "exact orbit (shooting)"
"""It has no equations of balance to be counted."""
_LEAST = 1e-17
_ONSET_MARKS = {
    "closed form": Mark(RED, "o"),
    "eigenvalues, 4 × 4 (numpy)": Mark(BLUE, "s"),
    "eigenvalues, 2 × 2 (scipy)": Mark(ORANGE, "x"),
}

TITLES = (
    "harmonic balance: time",
    "harmonic balance: evaluations",
    "flutter onset",
    "flutter onset: time",
)


def draw(frequencies: xr.Dataset) -> Figure:
    """Both charts, from dataset ``work_precision_frequencies``."""
    figure, axes = new_figure(PAGE, 6.4, nrows=2, ncols=2)
    rows = frequencies.isel(run=frequencies.task.values == "harmonic balance")
    onset = frequencies.isel(run=frequencies.task.values == "stability")
    methods = list(dict.fromkeys(rows.method.values.tolist()))
    marks = {method: FALLBACK[i % len(FALLBACK)] for i, method in enumerate(methods)}
    draw_methods(axes[0, 0], rows, "wall_time", 1e3, marks)
    axes[0, 0].set_ylabel("wall time per point (ms)")
    balances = rows.isel(run=rows.method.values != _EXACT)
    draw_methods(axes[0, 1], balances, "evaluations", 1.0, marks)
    axes[0, 1].set_ylabel("evaluations of the equations")
    if axes[0, 0].get_legend_handles_labels()[0]:
        legend_above(figure, axes[0, 0], 4)
    _draw_onset(axes[1, 0], onset)
    draw_methods(axes[1, 1], onset, "wall_time", 1e6, _ONSET_MARKS)
    axes[1, 1].set_ylabel("wall time (µs)")
    for panel in (*axes[0], axes[1, 1]):
        panel.set_xlabel("error of ω, relative")
    for letter, panel, title in zip("abcd", axes.flat, TITLES, strict=True):
        panel_letter(panel, letter, title)
    foot(figure, frequencies)
    return figure


def _draw_onset(axes: Axes, rows: xr.Dataset) -> None:
    distance = np.array([float(text.split()[-1]) for text in rows.setting.values.tolist()])
    for method, (colour, marker, _) in _ONSET_MARKS.items():
        for side, dash in (("stable", "-"), ("flutter", ":")):
            mine = (rows.method.values == method) & (rows.scene.values == side)
            axes.plot(
                distance[mine], np.maximum(rows.error.values[mine], _LEAST), dash, color=colour,
                marker=marker, ms=3.5, lw=0.8, label=method if side == "stable" else None,
            )  # fmt: skip
    axes.set(
        xscale="log", yscale="log", xlabel="distance from onset, 1 − μ/μ$_c$",
        ylabel="error of ω, relative",
    )  # fmt: skip
    axes.minorticks_off()
    axes.grid(visible=True, lw=0.3, color="#DDDDDD")
    axes.legend(fontsize=6, loc="upper right")
