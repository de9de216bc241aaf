"""Propensities over uncertain parameters, and what they depend on."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.codes import flag_words
from squealpipe.plotting import style
from squealpipe.vibration.sobol import SobolRules

COLOURS = (
    style.Colour.blue,
    style.Colour.orange,
    style.Colour.red,
    style.Colour.purple,
    style.Colour.green,
)


def figure(spread: xr.Dataset) -> Figure:
    """Four panels."""
    drawn, axes = style.new_figure(style.PAGE, 4.8, nrows=2, ncols=2)
    (bars, sizes), (indices, widths) = axes
    names = [flag_words(name) for name in spread.quantity.values.tolist()]
    draw_shares(bars, spread)
    for row, colour in zip(spread.share_by_size.values, COLOURS, strict=False):
        sizes.plot(spread["size"], row, ".-", color=colour)
    sizes.set(xlabel="sample size", xscale="log", ylim=(0, 1.02), ylabel="share")
    _ends(sizes, spread["size"].values)
    inputs = list(map(style.symbol, spread.input.values.tolist()))
    shown = [
        i for i in range(len(names)) if np.isfinite(spread.total_order.values[i]).all()
    ]
    width = 0.8 / max(len(shown), 1)
    for position, i in enumerate(shown):
        at = np.arange(len(inputs)) + (position - 0.5 * (len(shown) - 1)) * width
        total = spread.total_order.values[i]
        limits = np.stack(
            [spread.total_order_low.values[i], spread.total_order_high.values[i]]
        )
        indices.bar(
            at,
            total,
            width,
            yerr=np.abs(limits - total),
            color=COLOURS[i],
            ecolor=style.Colour.grey,
            label=names[i],
        )
        indices.plot(at, spread.first_order.values[i], "k.", markersize=3)
    indices.set_xticks(np.arange(len(inputs)), inputs)
    indices.set(ylabel="Sobol index", xlim=(-0.5, len(inputs) - 0.5), ylim=(0, None))
    if shown:
        indices.legend()
    else:
        style.say_instead(indices, "none supported")
    for row, colour in zip(spread.half_width_by_size, COLOURS, strict=False):
        if np.isfinite(row).any():
            base = spread.index_samples.sel(quantity=row.quantity)
            widths.plot(base, row, ".-", color=colour)
    widths.axhline(
        SobolRules.widest,
        color=style.Colour.grey,
        ls="--",
        lw=0.8,
        label="widest that is given",
    )
    widths.legend()
    widths.set(
        xlabel="base sample",
        xscale="log",
        ylabel="half-width of total index",
        ylim=(0, None),
    )
    if not np.isfinite(spread.half_width_by_size).any():
        style.say_instead(widths, "too few of the sample differ")
        widths.minorticks_off()
    else:
        known = np.isfinite(spread.half_width_by_size)
        _ends(widths, spread.index_samples.where(known).values)
    titles = ("propensity", "convergence of shares")
    style.panel_letters(axes.flat, (*titles, "sensitivity", "convergence of indices"))
    return drawn


def figure_of_structure(spread: xr.Dataset) -> Figure:
    """Shares of the verdicts, and the total Sobol indices of those that have them."""
    drawn, axes = style.new_figure(style.PAGE, 2.6, ncols=2)
    bars, indices = axes[0]
    draw_verdicts(bars, spread)
    inputs = [name.replace("_", " ") for name in spread.input.values.tolist()]
    at = np.arange(len(inputs))
    known = np.flatnonzero(np.isfinite(spread.total_order.values).any(axis=1))
    height = 0.8 / max(known.size, 1)
    for position, row in enumerate(known.tolist()):
        one = spread.isel(verdict=row)
        total = one.total_order.values
        limits = np.stack([one.total_order_low.values, one.total_order_high.values])
        indices.barh(
            at + (position - 0.5 * (known.size - 1)) * height,
            total,
            height,
            xerr=np.abs(limits - total),
            color=COLOURS[row],
            ecolor=style.Colour.grey,
            label=str(one.verdict.item()),
        )
    indices.set_yticks(at, inputs)
    indices.invert_yaxis()
    indices.set(xlabel="total Sobol index", xlim=(0, None))
    if known.size:
        indices.legend()
    else:
        style.say_instead(indices, "too few samples differ,\nor too few were drawn")
    style.panel_letters(axes[0], ("verdicts", "what decides"))
    return drawn


def draw_verdicts(axes: Axes, spread: xr.Dataset) -> None:
    """Share of the sample with each verdict on a structure, with its 95 % interval."""
    draw_shares(axes, spread.rename(verdict="quantity"))


def _ends(axes: Axes, numbers: np.ndarray) -> None:
    """The smallest and the largest number as the labels of a logarithmic axis."""
    ends = [int(np.nanmin(numbers)), int(np.nanmax(numbers))]
    axes.set_xticks(ends, map(str, ends))
    axes.minorticks_off()


def draw_shares(axes: Axes, spread: xr.Dataset) -> None:
    """Share of the sample in which each quantity occurs, with its 95 % interval."""
    names = [flag_words(name) for name in spread.quantity.values.tolist()]
    place = np.arange(len(names))
    share = spread.share.values
    error = np.abs(
        np.stack([spread.share_low.values, spread.share_high.values]) - share
    )
    axes.barh(
        place,
        share,
        xerr=error,
        color=COLOURS[: len(names)],
        ecolor=style.Colour.grey,
        height=0.6,
    )
    # a bar of less than a pixel looks like none
    shares = [
        f"{name}\n{100.0 * each:.3g} %" for name, each in zip(names, share, strict=True)
    ]
    axes.set_yticks(place, shares)
    axes.invert_yaxis()
    axes.set(xlabel="share", xlim=(0, 1))
