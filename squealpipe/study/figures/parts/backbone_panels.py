"""Backbones as the paper shows them: amplitudes over the frequency, one panel for each mode."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.schema import meanings
from squealpipe.study.figures.parts.origin import angle_pair, parameter
from squealpipe.study.figures.parts.style import (
    GREY,
    PAGE,
    RED,
    X_COLOUR,
    Y_COLOUR,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import xarray as xr
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CROSSES = 24
"""Points of the harmonic balance that are drawn, evenly spaced along the branch."""
QUANTITIES = (("x_amplitude", X_COLOUR, "x"), ("y_amplitude", Y_COLOUR, "y"))
KEY = (
    "Crosses: harmonic balance; lines: exact orbits, dotted where unstable. Amplitudes are half of "
    "the peak to peak and exclude the mean: contact is lost from the circle upwards, where mean "
    "and amplitude of y add up to l_pre (grey line). Red rings: the mass overtakes the belt, where "
    "A4 does not hold."
)
"""What the marks mean, for captions."""
SCENE_ALT = "Two panels of amplitude over frequency for x and y, one for each mode."

MOST_IN_A_ROW = 6
"""Entries that a row of the legend takes."""
STABLE_TO_ROUND_OFF = 2.0 + 1e-6


def draw_scene(branches: Mapping[str, xr.Dataset]) -> Figure:
    """Two panels, one for each mode.

    Args:
        branches: datasets ``backbone/<scene>_mode<n>`` (exact) and those that end in ``_hbm``.
    """
    return draw_scenes(branches, 3.0)


def draw_scenes(branches: Mapping[str, xr.Dataset], height: float) -> Figure:
    """One row for each scene, one panel for each mode; ``branches`` as for :func:`draw_scene`."""
    scenes = list(dict.fromkeys(name.rsplit("_mode", 1)[0] for name in branches))
    figure, axes = new_figure(PAGE, height, nrows=len(scenes), ncols=2)
    letters = iter("abcdefghijklmnopqrst")
    for row, scene in zip(axes, scenes, strict=True):
        for panel, mode in zip(row, (1, 2), strict=True):
            exact, series = (branches[f"{scene}_mode{mode}{form}"] for form in ("", "_hbm"))
            draw_branch(panel, exact, series, parameter(exact, "preload"))
            panel_letter(panel, next(letters), f"{_angles(exact)}, vicinity of ω{'₁₂'[mode - 1]}")
        row[0].set_ylabel("amplitude (m)")
    handles, labels = key_entries(axes.ravel())
    columns = len(labels) if len(labels) <= MOST_IN_A_ROW else -(-len(labels) // 2)
    figure.legend(handles, labels, loc="outside lower center", ncols=columns)
    return figure


def scene_caption(branches: Mapping[str, xr.Dataset]) -> str:
    """Caption of one scene's backbones."""
    angles = _angles(next(iter(branches.values())))
    return (
        f"Periodic motions of model A4 at (α₁, α₂) = {angles}: amplitudes of x and y over the "
        f"frequency, (a) near ω₁ and (b) near ω₂. {KEY}"
    )


def _angles(branch: xr.Dataset) -> str:
    return angle_pair(branch.attrs["alpha1"], branch.attrs["alpha2"])


def draw_branch(panel: Axes, exact: xr.Dataset, series: xr.Dataset, preload: float) -> None:
    """One mode: lines for exact orbits beneath crosses for harmonic balance."""
    panel.axhline(preload, color=GREY, linewidth=1.0, label=r"$l_\mathrm{pre}$")
    if not exact.sizes["point"]:
        say_why_empty(panel, exact)
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
        panel.plot(
            omega, dotted, color=colour, linewidth=1.4, linestyle=":",
            label=f"{label}, unstable" if unstable.any() else None,
        )  # fmt: skip
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
            label="mass overtakes the belt" if broken.any() else None,
        )
    _mark_contact_loss(panel, exact, preload)
    _frame(panel, np.concatenate([omega, series.omega.values[shown]]))


def say_why_empty(panel: Axes, branch: xr.Dataset) -> None:
    """Write why a branch has no points into its panel."""
    reason = meanings(branch.end)[int(branch.end)]
    text = f"no periodic motions:\n{reason.replace('_', ' ')}"
    panel.text(0.5, 0.5, text, transform=panel.transAxes, ha="center", va="center")
    panel.set(xticks=[], yticks=[])


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
        markeredgecolor=Y_COLOUR,
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
    """Each label once, over all panels."""
    found: dict[str, Artist] = {}
    for panel in panels:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    return list(found.values()), list(found)
