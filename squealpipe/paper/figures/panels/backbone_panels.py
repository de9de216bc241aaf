"""Backbones over the frequency, one panel for each mode."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.cycles import joined, key_entries, say_why_empty
from squealpipe.plotting.origin import angle_pair, parameter

STABLE_TO_ROUND_OFF = 2.0 + 1e-6


def key(branches: Mapping[str, xr.Dataset], *, first: bool = False) -> str:
    """Return the words of a caption about the marks: all in the first figure that has them."""
    exact = [branch for name, branch in branches.items() if not name.endswith("_hbm")]
    looks = []
    if any((_unstable(each) & ~_overtakes(each)).any() for each in exact):
        looks.append("dotted where unstable")
    if any(_overtakes(each).any() for each in exact):
        looks.append("grey where the mass overtakes the belt and A4 does not hold")
    marks = (
        "Blue: largest y, so that contact is lost where it reaches the black line at l_pre; "
        "orange: amplitude of x, half of its peak to peak. Crosses: harmonic balance; lines: "
        "exact orbits"
    )
    return f"{', '.join([marks if first else 'Marks as in Figs. 10–12', *looks])}."


def _unstable(exact: xr.Dataset) -> np.ndarray:
    return np.asarray(np.abs(exact.stability_index.values) > STABLE_TO_ROUND_OFF)


def _overtakes(exact: xr.Dataset) -> np.ndarray:
    return np.asarray(exact.sliding_assumption.values == 0)


def draw_scenes(branches: Mapping[str, xr.Dataset], height: float) -> Figure:
    """One row for each scene, one panel for each mode.

    Args:
        branches: datasets ``backbone/<scene>_mode<n>`` (exact) and those that end in ``_hbm``.
    """
    scenes = list(dict.fromkeys(name.rsplit("_mode", 1)[0] for name in branches))
    figure, axes = style.new_figure(style.PAGE, height, nrows=len(scenes), ncols=2)
    letters = iter("abcdefghijklmnopqrst")
    for row, scene in zip(axes, scenes, strict=True):
        for panel, mode in zip(row, (1, 2), strict=True):
            exact, series = (
                branches[f"{scene}_mode{mode}{form}"] for form in ("", "_hbm")
            )
            draw_branch(panel, exact, series, parameter(exact, "preload"))
            angles = angle_pair(exact.attrs["alpha1"], exact.attrs["alpha2"])
            style.panel_letter(
                panel, next(letters), f"{angles}, vicinity of ω{'₁₂'[mode - 1]}"
            )
        row[0].set_ylabel("y, x (m)")
    figure.legend(*key_entries(axes.ravel()), loc="outside lower center", ncols=3)
    return figure


def draw_branch(
    panel: Axes, exact: xr.Dataset, series: xr.Dataset, preload: float
) -> None:
    """One mode: lines for exact orbits beneath crosses for harmonic balance."""
    panel.axhline(
        preload,
        color=style.Colour.black,
        linewidth=0.8,
        label=r"$l_\mathrm{pre}$, contact is lost",
    )
    if say_why_empty(panel, exact):
        return
    unstable, overtakes = _unstable(exact), _overtakes(exact)
    omega = exact.omega.values
    shown = _evenly(series)
    quantities = (
        ("x_amplitude", style.Colour.along, "amplitude of x"),
        ("y_peak", style.Colour.across, "largest y"),
    )
    for name, colour, label in quantities:
        values = exact[name].values
        for chosen, shade, dash, words in (
            (~unstable & ~overtakes, colour, "-", label),
            (unstable & ~overtakes, colour, ":", "unstable"),
            (overtakes, style.Colour.grey, "-", "mass overtakes the belt"),
        ):
            if chosen.any():
                line = np.where(joined(chosen), values, np.nan)
                panel.plot(omega, line, dash, color=shade, linewidth=1.4, label=words)
        here, words = series.isel(point=shown), f"{label}, harmonic balance"
        panel.plot(
            here.omega, here[name], "x", ms=4.5, mew=0.9, color=colour, label=words
        )
    drawn = np.concatenate([omega, series.omega.values[shown]])
    span = max(float(np.ptp(drawn)), 0.05 * float(drawn.mean()))
    middle = 0.5 * (float(drawn.min()) + float(drawn.max()))
    limits = middle - 0.65 * span, middle + 0.65 * span
    panel.set(xlabel="ω (rad/s)", xlim=limits, ylim=(0, None))


def _evenly(series: xr.Dataset) -> np.ndarray:
    """Indices of points at even distances along the branch in the picture."""
    # more crosses than this hide the exact line beneath them
    crosses = 24
    if series.sizes["point"] <= crosses:
        return np.arange(series.sizes["point"])
    parts = [series[name].values for name in ("omega", "x_amplitude", "y_peak")]
    steps = np.sqrt(sum((np.diff(part) / (np.ptp(part) or 1.0)) ** 2 for part in parts))
    length = np.concatenate([[0.0], np.cumsum(steps)])
    wanted = np.linspace(0.0, length[-1], crosses)
    return np.unique(np.searchsorted(length, wanted).clip(0, len(length) - 1))
