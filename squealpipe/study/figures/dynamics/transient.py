"""The paper's limit cycle at (0.2π, 0.8π) is a transient: how long it lasts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import MaxNLocator

from squealpipe.parameters import SCENES
from squealpipe.schema.inference import wilson_interval
from squealpipe.study.figures.parts.origin import time_unit
from squealpipe.study.figures.parts.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PAGE,
    new_figure,
    panel_letter,
)
from squealpipe.text import number

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

READS = ("transient",)
CAPTION = (
    "How long the bounded motion of Fig. 4 lasts. (a) Share of runs that still swing to and fro "
    "after a time, over perturbations of the start up to a billionth of l_pre: Kaplan–Meier "
    "estimate. Where runs end: its 95 % band, and dashed the decay at one hazard for all ages. "
    "Orange: the time of Fig. 4. (b) Share of runs that leave it within the time run, and their "
    "median lifetime where half of them do, over belt speed."
)
ALT = (
    "Left, a survival curve on a logarithmic axis. Right, the share of runs that left and their "
    "median lifetime over belt speed."
)


def draw(transient: xr.Dataset) -> Figure:
    """Two panels.

    Args:
        transient: dataset ``transient``.
    """
    figure, axes = new_figure(PAGE, 2.9, ncols=2)
    _survival(axes[0, 0], transient)
    _speeds(axes[0, 1], transient)
    return figure


def _survival(axes: Axes, transient: xr.Dataset) -> None:
    lifetime, t_end = transient.shown_lifetime.values, float(transient.t_end)
    count, ended = lifetime.size, np.count_nonzero(np.isfinite(lifetime))
    age = transient.survival_time.values
    axes.step(
        age,
        transient.survival,
        where="post",
        color=BLUE,
        label=f"{count} runs, V = {number(float(transient.shown_belt_speed))} m/s",
    )
    if ended:  # before the first end the estimate has no band
        axes.fill_between(
            age, transient.survival_low, transient.survival_high, step="post", color=BLUE,
            alpha=0.25, linewidth=0, label="95 % band",
        )  # fmt: skip
    _constant_hazard(axes, transient)
    shown = SCENES["F4"].t_end * time_unit(transient)
    axes.axvspan(0, shown, color=ORANGE, alpha=0.3, linewidth=0, label="shown in Fig. 4")
    axes.set(xlabel="t (s)", ylabel="share still bounded", yscale="log", xlim=(0, t_end))
    positive = transient.survival.values[transient.survival.values > 0]
    axes.set_ylim(bottom=0.5 * positive.min(), top=1.6)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.legend(loc="lower left")
    most = "" if ended else f" (95 %: at most {100 * wilson_interval(0, count)[1]:.3g} %)"
    panel_letter(axes, "a", f"{ended} of {count} end in the whirl{most}")


def _constant_hazard(axes: Axes, transient: xr.Dataset) -> None:
    """What the mean hazard of all ages would give: ends over time at risk."""
    lifetime = transient.shown_lifetime.fillna(transient.t_end).values
    exposure = lifetime.sum()
    ended = np.count_nonzero(np.isfinite(transient.shown_lifetime.values))
    if ended:
        rate = ended / exposure
        age = transient.survival_time.values
        label = f"constant hazard, mean {number(1 / rate, 4)} s"
        axes.plot(age, np.exp(-rate * age), "--", color=BLACK, label=label)


def _speeds(axes: Axes, transient: xr.Dataset) -> None:
    lifetime, speed = transient.lifetime.values, np.abs(transient.belt_speed.values)
    left = np.isfinite(lifetime).mean(axis=1)
    axes.semilogx(speed, left, "o-", color=GREEN, markersize=4)
    axes.set(xlabel="belt speed |V| (m/s)", ylim=(-0.05, 1.1))
    axes.set_ylabel(f"share that left by t = {number(float(transient.t_end), 4)} s", color=GREEN)
    axes.axhline(0, color=GREY, linewidth=0.5)
    twin = axes.twinx()
    ordered = np.sort(np.where(np.isfinite(lifetime), lifetime, np.inf), axis=1)
    median = ordered[:, lifetime.shape[1] // 2]
    half = np.isfinite(median)
    panel_letter(axes, "b", "runs that left, and their median lifetime")
    if not half.any():
        twin.set_axis_off()
        return
    twin.plot(speed[half], median[half], "s--", color=BLUE, markersize=4)
    twin.set_ylabel("median lifetime (s)", color=BLUE)
    twin.set_ylim(0, 1.4 * max(median[half]))
    twin.spines["right"].set_visible(True)
