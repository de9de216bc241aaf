"""Runs and ensembles of systems."""

import json

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from squealpipe.plotting.cycles import say_why_empty
from squealpipe.plotting.quantities import draw_quantity, label
from squealpipe.plotting.style import BLUE, GREY, PALETTE, say_instead

FEW_EVENTS = 60
"""Events up to which each is marked."""


def draw_states(axes: Axes, run: xr.Dataset) -> None:
    """The states that have the first one's unit over time, events as thin lines."""
    states = [run[name] for name in _states(run)]
    alike = [state for state in states if state.units == states[0].units]
    if np.isfinite(alike[0].values).sum() < 2:
        say_instead(axes, "the run ended before its second sample")
        return
    if run.sizes["event"] <= FEW_EVENTS:
        for instant in run.event_time.values:
            axes.axvline(instant, color=GREY, linewidth=0.4)
    for state, colour in zip(alike, PALETTE * len(alike), strict=False):
        axes.plot(run.time, state, color=colour, label=str(state.name))
    names = ", ".join(str(state.name) for state in alike)
    axes.set(xlabel=label(run.time), ylabel=f"{names} ({states[0].units})")
    if len(alike) > 1:
        axes.legend()


def draw_ensemble(axes: Axes, runs: xr.Dataset) -> None:
    """Late extremes of the first state: a band over one dimension, the larger over two."""
    first = _states(runs)[0]
    low, high = runs[f"late_{first}_min"], runs[f"late_{first}_max"]
    if high.ndim != 1:
        draw_quantity(axes, high)
        return
    x = runs[high.dims[0]]
    axes.fill_between(x, low, high, color=BLUE, alpha=0.15, linewidth=0)
    for extreme in (low, high):
        axes.plot(x, extreme, ".", color=BLUE, markersize=3)
    axes.set(xlabel=label(x), ylabel=f"{first}, late extremes ({high.units})")


def draw_path(axes: Axes, cycle: xr.Dataset) -> None:
    """A cycle in the plane of the first two states, or of the only one over time."""
    if say_why_empty(axes, cycle):
        return
    first, *others = [cycle[f"{name}_path"] for name in _states(cycle)]
    x, y = (first, others[0]) if others else (cycle.time, first)
    axes.plot(x, y, color=BLUE)
    axes.set(xlabel=label(x), ylabel=label(y))


def _states(dataset: xr.Dataset) -> list[str]:
    rates = (
        name for name in json.loads(dataset.attrs["system"]) if name.endswith("/dt")
    )
    return [name.removeprefix("d").removesuffix("/dt") for name in rates]
