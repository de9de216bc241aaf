"""Backbones as the paper shows them: amplitudes of x and y over the frequency, a panel a mode."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.figures.style import BLUE, GREY, ORANGE, PAGE, RED, new_figure, panel_letter

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import xarray as xr
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CROSSES = 24
"""Points of the harmonic balance that are drawn, evenly spaced along the branch."""
QUANTITIES = (("x_amplitude", ORANGE, "x"), ("y_amplitude", BLUE, "y"))
KEY = (
    "Crosses: harmonic balance; lines: exact orbits, dotted where unstable. Circle: contact is "
    "lost from here upwards; grey line: l_pre. Red rings would mark x' > V, where A4 does not hold."
)
"""What the marks mean, for captions."""

STABLE_TO_ROUND_OFF = 2.0 + 1e-6


def draw_scene(branches: Sequence[Sequence[xr.Dataset]], preload: float) -> Figure:
    """Two panels, the vicinities of ω1 and ω2.

    Args:
        branches: for each mode the exact ``backbone`` and the one by harmonic balance.
        preload: l_pre, m.
    """
    figure, axes = new_figure(PAGE, 3.0, ncols=2)
    for panel, letter, number, (exact, series) in zip(axes[0], "ab", "₁₂", branches, strict=True):
        draw_branch(panel, exact, series, preload)
        panel_letter(panel, letter, f"vicinity of ω{number}")
    axes[0, 0].set_ylabel("amplitude (m)")
    handles, labels = key_entries(axes[0])
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def draw_branch(panel: Axes, exact: xr.Dataset, series: xr.Dataset, preload: float) -> None:
    """One mode: lines for exact orbits beneath crosses for harmonic balance."""
    panel.axhline(preload, color=GREY, linewidth=1.0, label=r"$l_\mathrm{pre}$")
    if not exact.sizes["point"]:
        meanings = str(exact.end.attrs["flag_meanings"]).split()
        reason = meanings[list(exact.end.attrs["flag_values"]).index(int(exact.end))]
        panel.text(0.5, 0.5, reason.replace("_", " "), transform=panel.transAxes, ha="center")
        return
    unstable = np.abs(exact.stability_index.values) > STABLE_TO_ROUND_OFF
    omega = exact.omega.values
    shown = _evenly(series)
    for name, colour, label in QUANTITIES:
        values = exact[name].values
        stable = np.where(unstable, np.nan, values)
        panel.plot(omega, stable, color=colour, linewidth=1.4, label=f"{label}, exact")
        # both ends of each unstable stretch are shared with the stable line, so that none gapes
        near = unstable | np.roll(unstable, 1) | np.roll(unstable, -1)
        dotted = np.where(near & unstable.any(), values, np.nan)
        panel.plot(omega, dotted, color=colour, linewidth=1.4, linestyle=":")
        panel.plot(
            series.omega.values[shown],
            series[name].values[shown],
            linestyle="none",
            marker="x",
            markersize=4.5,
            markeredgewidth=0.9,
            color=colour,
            label=f"{label}, harmonic balance",
        )
        broken = exact.sliding_assumption.values == 0
        panel.plot(
            omega[broken],
            values[broken],
            linestyle="none",
            marker="o",
            markerfacecolor="none",
            markeredgecolor=RED,
        )
    _mark_contact_loss(panel, exact, preload)
    _frame(panel, omega)


def _mark_contact_loss(panel: Axes, exact: xr.Dataset, preload: float) -> None:
    """A circle where the branch reaches y = l_pre."""
    peak = exact.y_peak.values
    if peak.max() <= preload or peak[0] >= preload:
        return
    at = int(np.flatnonzero(peak >= preload * (1 - 1e-12))[0])
    panel.plot(
        exact.omega.values[at],
        exact.y_amplitude.values[at],
        linestyle="none",
        marker="o",
        markersize=5,
        markerfacecolor="white",
        markeredgecolor=BLUE,
        zorder=3,
        label="contact is lost above",
    )


def _frame(panel: Axes, omega: np.ndarray) -> None:
    span = max(float(np.ptp(omega)), 0.05 * float(omega.mean()))
    middle = 0.5 * (float(omega.min()) + float(omega.max()))
    panel.set_xlim(middle - 0.65 * span, middle + 0.65 * span)
    panel.set_ylim(bottom=0)
    panel.set_xlabel("ω (rad/s)")


def _evenly(series: xr.Dataset) -> np.ndarray:
    """Indices of points at even distances along the branch in the picture."""
    if series.sizes["point"] <= CROSSES:
        return np.arange(series.sizes["point"])
    parts = [series[name].values for name in ("omega", "x_amplitude", "y_amplitude")]
    steps = np.sqrt(sum((np.diff(part) / (np.ptp(part) or 1.0)) ** 2 for part in parts))
    length = np.concatenate([[0.0], np.cumsum(steps)])
    wanted = np.linspace(0.0, length[-1], CROSSES)
    return np.unique(np.searchsorted(length, wanted).clip(0, len(length) - 1))


def key_entries(panels: Iterable[Axes]) -> tuple[list[Artist], list[str]]:
    """Each label once, over both panels."""
    found: dict[str, Artist] = {}
    for panel in panels:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    return list(found.values()), list(found)
