"""Complex modes: growth or damping ratio over frequency, or how they change with a parameter."""

from textwrap import fill

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from squealpipe.plotting import style
from squealpipe.plotting.origin import parameter
from squealpipe.plotting.quantities import label
from squealpipe.systems.inputs.units import shown_in
from squealpipe.systems.inputs.words import number


def draw_modes(axes: Axes, modes: xr.Dataset) -> None:
    """Growth over frequency of one spectrum; of several, frequency over the first factor."""
    dims = _factors(modes)
    if not dims:
        _draw_spectrum(axes, modes)
    else:
        _draw_along(axes, _one_way(modes, dims), "frequency", dims[0])


def _factors(modes: xr.Dataset) -> list[str]:
    return [str(dim) for dim in modes.growth_rate.dims if dim != "mode"]


def figure(modes: xr.Dataset) -> Figure:
    """One panel of growth over frequency, or two: frequency and growth over a factor."""
    dims = _factors(modes)
    if not dims:
        made, axes = style.new_figure(style.COLUMN, 3.0)
        _draw_spectrum(axes[0, 0], modes)
        return made
    made, axes = style.new_figure(style.PAGE, 2.6, ncols=2)
    one = _one_way(modes, dims)
    for panel, name in zip(axes[0], ("frequency", "growth_rate"), strict=True):
        _draw_along(panel, one, name, dims[0])
    if dims[1:]:
        chosen = ", ".join(
            f"{label(one[dim])} = {one[dim].item():g}" for dim in dims[1:]
        )
        axes[0, 0].set_title(fill(f"at {chosen}", 50), fontsize="small")
    return made


def _one_way(modes: xr.Dataset, dims: list[str]) -> xr.Dataset:
    """Along the first factor, at the first values of the others."""
    return modes.isel(dict.fromkeys(dims[1:], 0))


def _draw_spectrum(axes: Axes, modes: xr.Dataset) -> None:
    unstable = modes.unstable.values
    frequency, growth = modes.frequency.values, modes.growth_rate.values
    if not np.isfinite(growth).any():
        style.say_instead(axes, "no mode within the limits")
        return
    factor, unit = frequency_unit(frequency)
    frequency = frequency * factor
    draw_stability(axes, frequency, growth, unstable)
    if (lowest := show_what_grows(axes, growth)) is not None:
        below = growth < lowest
        axes.plot(
            frequency[below],
            np.full(below.sum(), 0.97 * lowest),
            "v",
            color=style.Colour.blue,
            label=f"stable, below {number(lowest, 2)} 1/s",
        )
    axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    axes.set(xlabel=f"frequency ({unit})", ylabel="growth rate (1/s)")
    axes.legend()


def draw_stability(
    axes: Axes, frequency: np.ndarray, height: np.ndarray, unstable: np.ndarray
) -> None:
    """Draw modes over frequency, stable and unstable ones, as far as there are any."""
    axes.axhline(0.0, color=style.Colour.grey, linewidth=0.6)
    for which, mark, colour, words in (
        (~unstable, ".", style.Colour.blue, "stable"),
        (unstable, "o", style.Colour.red, "unstable"),
    ):
        if which.any():
            axes.plot(
                frequency[which], height[which], mark, ms=4, color=colour, label=words
            )


def own_friction(modes: xr.Dataset) -> int:
    """Return the place of the structure's own friction among those of a study."""
    if "mu_of" in modes.attrs:  # half of the largest of the face that was varied
        return modes.sizes["mu"] // 2
    return int(np.abs(modes.mu.values - parameter(modes, "mu")).argmin())


def figure_of_damping(modes: xr.Dataset) -> Figure:
    """One panel of damping ratio over frequency, at the structure's own friction."""
    made, axes = style.new_figure(style.COLUMN, 2.6)
    panel = axes[0, 0]
    now = modes.isel(mu=own_friction(modes))
    known = np.isfinite(now.damping_ratio.values) & (now.frequency.values > 0)
    if not known.any():
        style.say_instead(panel, "no mode that oscillates within the limits")
        return made
    now = now.isel(mode=known)
    factor, unit = frequency_unit(now.frequency.values)
    frequency, ratio = now.frequency.values * factor, 100.0 * now.damping_ratio.values
    unstable = now.unstable.values
    draw_stability(panel, frequency, ratio, unstable)
    panel.set(xlabel=f"frequency ({unit})", ylabel="damping ratio (%)")
    panel.legend()
    return made


def _draw_along(axes: Axes, modes: xr.Dataset, name: str, dim: str) -> None:
    """All modes along a factor; where one is unstable it is red, its onset a mark."""
    values = modes[name].transpose(dim, "mode").values
    unstable = modes.unstable.transpose(dim, "mode").values
    x = modes[dim].values
    if not np.isfinite(values).any():
        style.say_instead(axes, "no mode within the limits")
        return
    words = "growth rate (1/s)"
    if name == "frequency":
        factor, unit = frequency_unit(values)
        values, words = values * factor, f"frequency ({unit})"
    onsets = np.full(modes.sizes["mode"], np.nan)
    if dim == "mu":
        onsets = modes.critical_mu.values
    for values_of_mode, grows, onset in zip(values.T, unstable.T, onsets, strict=True):
        places, heights = x, values_of_mode
        if np.isfinite(onset):
            # a straight line between two frictions would pass zero beside the onset
            at = np.interp(onset, x, heights) if name == "frequency" else 0.0
            behind = int(np.searchsorted(x, onset))
            places, heights = (
                np.insert(np.asarray(each, float), behind, value)
                for each, value in ((x, onset), (heights, at))
            )
            grows = np.insert(grows, behind, True)
            axes.plot(onset, at, "D", color=style.Colour.black, ms=3, zorder=3)
        axes.plot(places, heights, color=style.Colour.blue, linewidth=0.7)
        axes.plot(
            places, np.where(grows, heights, np.nan), ".-", color=style.Colour.red, ms=3
        )
    if name == "growth_rate":
        axes.axhline(0.0, color=style.Colour.grey, linewidth=0.6)
        show_what_grows(axes, values)
    varied = (
        f" of {modes.attrs['mu_of']}" if dim == "mu" and "mu_of" in modes.attrs else ""
    )
    axes.set(xlabel=label(modes[dim]) + varied, ylabel=words)


def frequency_unit(frequencies: np.ndarray) -> tuple[float, str]:
    """Factor and unit in which people write frequencies up to the largest of some in Hz."""
    finite = frequencies[np.isfinite(frequencies)]
    return shown_in(float(finite.max(initial=0.0)), "Hz")


def show_what_grows(axes: Axes, growth: np.ndarray) -> float | None:
    """Cut off decay that is much faster than the growth, which would not be seen beside it.

    Returns:
        The lowest growth rate that is shown, 1/s; None: all are.
    """
    largest, fastest = float(np.nanmax(growth)), -float(np.nanmin(growth))
    # decay deeper than this, over the fastest growth, would flatten the curves of growth
    deepest = 1.5
    if 0 < deepest * largest < fastest:
        axes.set_ylim(-deepest * largest, 1.15 * largest)
        return -deepest * largest
    return None
