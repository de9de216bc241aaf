"""Operating points of a structure: verdict and frequency over pressure and speed, occurrence."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.codes import Verdict
from squealpipe.plotting import style
from squealpipe.units import shown_in


def draw_points(axes: Axes, dataset: xr.Dataset) -> None:
    """Draw the points at the smallest friction."""
    top = float(np.nanmax(dataset.frequency.values, initial=1.0))
    _draw(axes, dataset.isel(mu=0), *shown_in(top, "Hz"))


def _draw(axes: Axes, points: xr.Dataset, factor: float, unit: str) -> None:
    """Draw the points of one friction, each noisy one with its frequency."""
    speeds, pressures = np.meshgrid(points.speed.values, points.pressure.values)
    # mark, colour and words of each verdict
    marks = {
        Verdict.quiet: ("o", style.GREY, "quiet"),
        Verdict.squeals: ("s", style.BLUE, "squeals"),
        Verdict.hammers: ("D", style.RED, "hammers"),
        Verdict.undetermined: ("x", style.GREY, "undetermined"),
    }
    for verdict, (mark, colour, words) in marks.items():
        chosen = points.verdict.values == verdict
        if chosen.any():
            axes.plot(
                speeds[chosen], pressures[chosen], mark, color=colour, label=words
            )
    for speed, pressure, frequency in zip(
        speeds.ravel(), pressures.ravel(), points.frequency.values.ravel(), strict=True
    ):
        if np.isfinite(frequency):
            axes.annotate(
                f"{factor * frequency:.3g}",
                (speed, pressure),
                xytext=(0, 4),
                textcoords="offset points",
                ha="center",
                fontsize=5,
            )
    axes.set(
        title=f"friction {float(points.mu):g}; labels in {unit}",
        xlabel="speed (m/s, or rad/s)",
        ylabel="preload over its present value",
    )
    axes.margins(x=0.15, y=0.3)  # room for the legend above the points
    axes.legend(fontsize=6, loc="upper center", ncols=len(marks))


def figure(dataset: xr.Dataset) -> Figure:
    """Points over speed and pressure, one panel a friction, and bars of occurrence."""
    count = dataset.sizes["mu"]
    drawn, axes = style.new_figure(style.PAGE, 2.6, ncols=count + 1)
    panels = axes[0]
    top = float(np.nanmax(dataset.frequency.values, initial=1.0))
    factor, unit = shown_in(top, "Hz")
    for place in range(count):
        _draw(panels[place], dataset.isel(mu=place), factor, unit)
    bars = panels[count]
    if dataset.sizes["band"]:
        names = [f"{factor * each:.3g}" for each in dataset.band.values]
        bars.bar(names, 100.0 * dataset.occurrence.values, color=style.BLUE)
        bars.tick_params(axis="x", rotation=90)
    else:
        style.say_instead(bars, "no point\nis noisy")
    bars.set(xlabel=f"third octave ({unit})", ylabel="noisy points (%)")
    return drawn
