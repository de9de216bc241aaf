"""Work–precision of harmonic balance and of eigenvalues near flutter onset."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from squealpipe.figures.style import BLUE, ORANGE, PAGE, RED, new_figure, panel_letter
from squealpipe.figures.work_precision import FALLBACK, draw_methods, foot

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAPTION = (
    "(a) Harmonic balance on model A4: median error of ω at equal y_peak against exact orbits, "
    "over N_h, the number of samples N, and σ; points of a line run over N_h (or σ). The exact "
    "orbit itself is shown with the velocity left after half a period. Grey band: Pareto front; "
    "red rings: our settings. (b) Error of both ω next to flutter onset, where eigenvalues of the"
    " first-order form lose half their digits and the closed form loses none."
)
ALT = (
    "Chart of frequency error against wall time for forms of harmonic balance, and chart of the "
    "error of eigenvalues against the distance from flutter onset."
)
_LEAST = 1e-17
_ABOVE: dict[str, Any] = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.06), "ncols": 2}


def draw(frequencies: xr.Dataset) -> Figure:
    """Both charts, from dataset ``work_precision_frequencies``."""
    figure, axes = new_figure(PAGE, 3.7, ncols=2)
    rows = frequencies.isel(run=frequencies.task.values == "harmonic balance")
    methods = list(dict.fromkeys(rows.method.values.tolist()))
    marks = {method: FALLBACK[i % len(FALLBACK)] for i, method in enumerate(methods)}
    draw_methods(axes[0, 0], rows, "wall_time", 1e3, marks)
    axes[0, 0].set(xlabel="error of ω, relative", ylabel="wall time of a point (ms)")
    if axes[0, 0].get_legend_handles_labels()[0]:
        axes[0, 0].legend(fontsize=6, **_ABOVE)
    _draw_onset(axes[0, 1], frequencies.isel(run=frequencies.task.values == "stability"))
    for letter, panel in zip("ab", axes.flat, strict=True):
        panel_letter(panel, letter)
    foot(figure, frequencies)
    return figure


def _draw_onset(axes: Axes, rows: xr.Dataset) -> None:
    distance = np.array([float(text.split()[-1]) for text in rows.setting.values.tolist()])
    methods = list(dict.fromkeys(rows.method.values.tolist()))
    for method, colour, marker in zip(methods, (RED, BLUE, ORANGE), "osx", strict=False):
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
    axes.legend(fontsize=6, **_ABOVE)
