"""Operating points of a structure: verdict and frequency over pressure and speed, occurrence."""

import json

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from squealpipe.codes import Verdict
from squealpipe.plotting import style
from squealpipe.systems.inputs.units import shown_in
from squealpipe.systems.inputs.words import number

MARKS = {
    Verdict.quiet: ".",
    Verdict.squeals: "o",
    Verdict.hammers: "D",
    Verdict.undetermined: "x",
}
"""Mark of each verdict."""


def draw_points(axes: Axes, dataset: xr.Dataset) -> None:
    """Draw the points at the largest friction or temperature, coloured by their frequency."""
    scale = _scale(dataset)
    _draw(axes, dataset.isel({_last(dataset): -1}), scale)
    _legend(axes, dataset)
    _colour_bar([axes], dataset, scale)


def figure(dataset: xr.Dataset) -> Figure:
    """Draw points over speed and pressure, a panel for each friction or temperature, and bars."""
    last = _last(dataset)
    # maps side by side; of more values of friction or temperature some are shown
    most = 4
    places = np.unique(
        np.linspace(0, dataset.sizes[last] - 1, most).round().astype(int)
    )
    drawn = style.new_figure(style.PAGE, 4.8)[0]
    drawn.clear()
    grid = drawn.add_gridspec(2, len(places), height_ratios=(1.25, 1.0))
    maps = [drawn.add_subplot(grid[0, column]) for column in range(len(places))]
    scale = _scale(dataset)
    for column, place in enumerate(places):
        _draw(maps[column], dataset.isel({last: place}), scale)
        if column:
            maps[column].set_ylabel("")
    _colour_bar(maps, dataset, scale)
    bars = drawn.add_subplot(grid[1, :])
    _draw_occurrence(bars, dataset)
    _legend(maps[0], dataset, drawn)
    return drawn


def _last(dataset: xr.Dataset) -> str:
    """Return the name of the last dimension of the map, friction or temperature."""
    return str(dataset.verdict.dims[-1])


def _scale(dataset: xr.Dataset) -> LogNorm:
    """Return the scale of colours, over all frequencies of the map."""
    known = dataset.frequency.values[np.isfinite(dataset.frequency.values)]
    if not known.size:
        return LogNorm(1.0, 10.0)
    low, high = float(known.min()), float(known.max())
    return LogNorm(low / 1.05, high * 1.05)


def _pressure(dataset: xr.Dataset) -> tuple[np.ndarray, str]:
    """Return the pressures as they are shown, and the label of their axis."""
    mean = float(dataset.mean_pressure)
    if not np.isfinite(mean):
        return dataset.pressure.values, "preload over its present value"
    factor, unit = shown_in(mean * float(dataset.pressure.max()), "Pa")
    return dataset.pressure.values * mean * factor, f"mean pressure ({unit})"


def _draw(axes: Axes, points: xr.Dataset, scale: LogNorm) -> None:
    """Draw the points of one friction or temperature, noisy ones coloured by frequency."""
    pressure, label = _pressure(points)
    speeds, pressures = np.meshgrid(points.speed.values, pressure)
    # marks touch on a fine grid, and are no larger than is pretty on a coarse one
    size = min(60.0, 5e3 / max(points.verdict.size, 1))
    for verdict, mark in MARKS.items():
        chosen = points.verdict.values == verdict
        if not chosen.any():
            continue
        at = speeds[chosen], pressures[chosen]
        if verdict in (Verdict.squeals, Verdict.hammers):
            look = {"c": points.frequency.values[chosen], "norm": scale}
            axes.scatter(
                *at, s=size, marker=mark, cmap="viridis", edgecolors="none", **look
            )
        else:
            axes.scatter(*at, s=0.5 * size, marker=mark, color=style.Colour.grey)
    last = next(name for name in ("temperature", "mu") if name in points.coords)
    value = number(float(points[last]))
    axes.set(
        title=f"{value} °C" if last == "temperature" else f"friction {value}",
        xlabel=f"speed ({_speed_unit(points)})",
        ylabel=label,
    )
    axes.margins(0.08)


def _speed_unit(points: xr.Dataset) -> str:
    numbers = json.loads(points.attrs.get("parameters", "{}"))
    return "rad/s" if "rotation" in numbers else "m/s"


def _legend(axes: Axes, dataset: xr.Dataset, drawn: Figure | None = None) -> None:
    """Draw the legend of the verdicts that occur, above the map or, for a figure, above all."""
    handles = [
        mpl.lines.Line2D(
            [],
            [],
            marker=mark,
            color=style.Colour.grey,
            linestyle="none",
            label=verdict.words,
        )
        for verdict, mark in MARKS.items()
        if (dataset.verdict.values == verdict).any()
    ]
    look = {"handles": handles, "fontsize": 7, "ncols": len(handles)}
    if drawn is None:
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.08), **look)
    else:
        drawn.legend(loc="outside upper center", **look)


def _colour_bar(maps: list[Axes], dataset: xr.Dataset, scale: LogNorm) -> None:
    """Draw the scale of frequencies, unless all points are quiet."""
    if not np.isfinite(dataset.frequency.values).any():
        return
    low, high = float(scale.vmin or 1.0), float(scale.vmax or 1.0)
    factor, unit = shown_in(high, "Hz")
    bar = maps[0].figure.colorbar(
        mpl.cm.ScalarMappable(scale, "viridis"), ax=maps, label=f"frequency ({unit})"
    )
    ticks = np.geomspace(low, high, 6)[1:-1]
    bar.ax.yaxis.set_major_locator(FixedLocator(ticks.tolist()))
    bar.ax.yaxis.set_minor_locator(NullLocator())
    bar.ax.yaxis.set_major_formatter(
        FuncFormatter(lambda value, _: number(factor * value))
    )


def _draw_occurrence(axes: Axes, dataset: xr.Dataset) -> None:
    """Draw the share of points that are noisy in each band, and of the lines of a measured list."""
    if not dataset.sizes["band"]:
        style.say_instead(axes, "no point is noisy")
        axes.set(ylabel="noisy points (%)")
        return
    low, high = dataset.band_low.values, dataset.band_high.values
    factor, unit = shown_in(float(high.max()), "Hz")
    third = np.allclose(high / low, 10.0**0.1)
    names = [
        _nominal(factor * middle)
        if third
        else f"{number(factor * one)}–{number(factor * other)}"
        for middle, one, other in zip(dataset.band.values, low, high, strict=True)
    ]
    place = np.arange(len(names))
    measured = "measured_occurrence" in dataset
    width = 0.4 if measured else 0.8
    shift = 0.2 if measured else 0.0
    bars = axes.bar(
        place - shift,
        100.0 * dataset.occurrence.values,
        width,
        color=style.Colour.blue,
        label="points of the map",
    )
    axes.bar_label(
        bars, [_percent(value) for value in dataset.occurrence.values], size=6
    )
    if measured:
        heard = axes.bar(
            place + shift,
            100.0 * dataset.measured_occurrence.values,
            width,
            color="white",
            edgecolor=style.Colour.grey,
            label="lines of the measured list",
        )
        share = dataset.measured_occurrence.values
        axes.bar_label(heard, [_percent(each) for each in share], size=6)
        axes.legend(fontsize=7)
    axes.set_xticks(place, names, rotation=90 if len(names) > 12 else 0)
    axes.set(
        xlabel=f"{'third octave' if third else 'band'} ({unit})",
        ylabel="occurrence (%)",
        xlim=(-0.6, len(names) - 0.4),
    )
    axes.margins(y=0.15)


def _percent(share: float) -> str:
    """Return a share as the text above its bar, "" if there is no bar."""
    return f"{100.0 * share:.3g}" if share else ""


def _nominal(middle: float) -> str:
    """Return the name of a third octave by IEC 61260: 1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3, 8."""
    names = np.array([1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0, 10.0])
    decade = 10.0 ** np.floor(np.log10(middle) + 1e-9)
    return number(decade * names[np.abs(np.log(names * decade / middle)).argmin()])
