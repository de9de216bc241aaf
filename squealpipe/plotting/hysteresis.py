"""Squeal over friction: where it begins, and where it dies as friction falls."""

from itertools import cycle
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from squealpipe.plotting import style
from squealpipe.plotting.origin import parameter
from squealpipe.structures.schema.squealing import JUST_ABOVE
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number


def has_tracks(answer: xr.Dataset) -> bool:
    """Return whether the dataset holds motions followed over falling friction."""
    return "track_mu" in answer and bool(answer.sizes["track"])


def draw_hysteresis(axes: Axes, answer: xr.Dataset) -> None:
    """Level of each motion that was followed, over friction; dashed: the unstable cycle."""
    own_mu = parameter(answer, "mu")
    for friction, line, words in (
        (float(answer.onset_mu), ":", "critical"),
        (own_mu, "-.", "the structure's own"),
    ):
        if np.isfinite(friction):
            label = f"{words}, μ = {number(friction, 3)}"
            axes.axvline(
                friction,
                color=style.Colour.black,
                linewidth=0.8,
                linestyle=line,
                label=label,
            )
    attractor_colours = (style.Colour.blue, style.Colour.orange, style.Colour.purple)
    colours = cycle(attractor_colours)
    unstable: str | None = "unstable cycle"
    for index in range(answer.sizes["track"]):
        one = answer.isel(track=index)
        above = int(one.track_attractor) == JUST_ABOVE
        colour = style.Colour.light if above else next(colours)
        label = "from just above the onset" if above else _named(answer, one)
        frictions, speeds = one.track_mu.values, one.track_velocity_rms.values
        # what begins at the onset is often what squeals above: it stays visible below
        wide: dict[str, Any] = {"linewidth": 3.0, "zorder": 1.5} if above else {}
        axes.plot(frictions, speeds, ".-", ms=4, color=colour, label=label, **wide)
        if "turn" in one.sizes and np.isfinite(one.unstable_mu).any():
            axes.plot(
                one.unstable_mu,
                one.unstable_velocity_rms,
                "--",
                color=style.Colour.red,
                label=unstable,
            )
            unstable = None
        dies = float(one.mu_dies)
        if np.isfinite(dies):
            lowest = _level_at_end(one)
            axes.plot(dies, lowest, "x", color=style.Colour.black, ms=5)
            axes.plot(
                [dies, dies], [0.0, lowest], color=style.Colour.grey, linewidth=0.8
            )
    axes.set(xlabel="friction μ", ylabel="rms speed (m/s)")
    axes.set_ylim(bottom=0.0)
    axes.margins(x=0.04)
    # on white: lines at frictions may pass behind it
    axes.legend(loc="best", frameon=True, framealpha=0.9, edgecolor="none")


def _level_at_end(one: xr.Dataset) -> float:
    """Level where a motion dies: of the fold, or the last that lasts."""
    if bool(one.mu_dies_is_fold):
        return float(one.unstable_velocity_rms[0])
    speeds = one.track_velocity_rms.values
    return float(speeds[np.isfinite(speeds)][-1])


def _named(answer: xr.Dataset, one: xr.Dataset) -> str:
    motion = answer.isel(attractor=int(one.track_attractor))
    return f"motion at {engineering(float(motion.dominant_frequency), 'Hz', 4)}"
