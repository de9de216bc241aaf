"""Runs and ensembles of systems."""

import json

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from squealpipe.plotting.cycles import say_why_empty
from squealpipe.plotting.quantities import draw_quantity, label
from squealpipe.plotting.style import Colour, say_instead
from squealpipe.schema import meanings


def draw_states(axes: Axes, run: xr.Dataset) -> None:
    """The states that have the first one's unit over time, events as thin lines."""
    states = [run[name] for name in _states(run)]
    alike = [state for state in states if state.units == states[0].units]
    if np.isfinite(alike[0].values).sum() < 2:
        say_instead(axes, "the run ended before its second sample")
        return
    # more marks than this would hide the lines
    if run.sizes["event"] <= 60:
        for instant in run.event_time.values:
            axes.axvline(instant, color=Colour.grey, linewidth=0.4)
    dashes = ("-", "--", ":")
    for index, state in enumerate(alike):
        turn, colour = divmod(index, len(Colour.palette))
        axes.plot(
            run.time,
            state,
            color=Colour.palette[colour],
            label=str(state.name),
            linestyle=dashes[turn % len(dashes)],
        )
    names = [str(state.name) for state in alike]
    title = ", ".join(names)
    if len(names) > 6:
        title = f"{names[0]} to {names[-1]}"
    axes.set(xlabel=label(run.time), ylabel=f"{title} ({states[0].units})")
    patches = _draw_regimes(axes, run) if "component" in run.dims else []
    lines = axes.get_lines()[-len(alike) :]
    if patches:
        # a longer legend would be larger than the picture
        axes.legend(
            handles=[*lines[:10], *patches],
            loc="lower center",
            bbox_to_anchor=(0.5, 1.0),
            ncols=5,
        )
    elif len(alike) > 1:
        axes.legend()


def _draw_regimes(axes: Axes, run: xr.Dataset) -> list[Patch]:
    """The regime of each component over time as a band below the states, darker to lighter.

    Returns:
        What a legend shows of the regimes.
    """
    names = meanings(run.event_regime)
    components = [str(value) for value in run.component.values]
    # of components c and c_2, regime c_2_stick is one of the latter
    owners = {
        number: max((c for c in components if name.startswith(f"{c}_")), key=len)
        for number, name in names.items()
    }
    short = {
        n: names[n].removeprefix(f"{owner}_").replace("_", " ")
        for n, owner in owners.items()
    }
    regimes = list(dict.fromkeys(short.values()))
    shades = colormaps["cividis"](np.linspace(0.0, 1.0, len(regimes)))
    colours = dict(zip(regimes, shades, strict=True))
    bottom, top = axes.get_ylim()
    height = 0.06 * (top - bottom)
    end = float(run.end_time)
    for index, component in enumerate(components):
        mine = [owners[int(n)] == component for n in run.event_regime]
        times = [0.0, *run.event_time.values[mine], end]
        entered = [run.regime.values[0, index], *run.event_regime.values[mine]]
        base = bottom - (index + 1) * height
        axes.broken_barh(
            list(zip(times[:-1], np.diff(times), strict=True)),
            (base, 0.8 * height),
            facecolors=[colours[short[int(number)]] for number in entered],
        )
        axes.text(
            end, base + 0.4 * height, f" {component}", va="center", fontsize="small"
        )
    axes.set_ylim(bottom - (len(components) + 0.5) * height, top)
    axes.set_yticks([tick for tick in axes.get_yticks() if bottom <= tick <= top])
    return [Patch(color=colours[name], label=name) for name in regimes]


def draw_ensemble(axes: Axes, runs: xr.Dataset) -> None:
    """Late extremes of the first state: a band over one dimension, the larger over two."""
    first = _states(runs)[0]
    low, high = runs[f"late_{first}_min"], runs[f"late_{first}_max"]
    if high.ndim != 1:
        draw_quantity(axes, high)
        return
    x = runs[high.dims[0]]
    axes.fill_between(x, low, high, color=Colour.blue, alpha=0.15, linewidth=0)
    for extreme in (low, high):
        axes.plot(x, extreme, ".", color=Colour.blue, markersize=3)
    axes.set(xlabel=label(x), ylabel=f"{first}, late extremes ({high.units})")


def draw_path(axes: Axes, cycle: xr.Dataset) -> None:
    """A cycle in the plane of the first two states, or of the only one over time."""
    if say_why_empty(axes, cycle):
        return
    first, *others = [cycle[f"{name}_path"] for name in _states(cycle)]
    x, y = (first, others[0]) if others else (cycle.time, first)
    axes.plot(x, y, color=Colour.blue)
    axes.set(xlabel=label(x), ylabel=label(y))


def _states(dataset: xr.Dataset) -> list[str]:
    rates = (
        name for name in json.loads(dataset.attrs["system"]) if name.endswith("/dt")
    )
    return [name.removeprefix("d").removesuffix("/dt") for name in rates]
