"""The paper's limit cycle at (0.2π, 0.8π) is a transient: how long it lasts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PAGE,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAPTION = (
    "How long the bounded motion of Fig. 4 lasts. (a) Share of runs that still swing to and fro "
    "after a time, over perturbations of the start below 1e-9 l_pre: past an initial delay they "
    "decay exponentially, as chaotic transients do; the band is the time of Fig. 4. (b) Share of "
    "runs that end in the whirl within the time run, and their median lifetime, over belt speed: "
    "at the baseline none leaves below about V = 1. Where the mass never reaches belt speed before "
    "it leaves, V does not matter at all."
)
ALT = (
    "Left, a survival curve on a logarithmic axis, flat at first and then straight. Right, a share "
    "rising from 0 to 1 between belt speeds 1 and 2, and median lifetimes near 6000."
)
PAPER_TIME = 500.0
"""Horizon of the paper's scene, in √(m/k1)."""


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
    count = lifetime.size
    ends = np.sort(lifetime[np.isfinite(lifetime)])
    axes.step(
        np.append(0.0, ends),
        1.0 - np.arange(ends.size + 1) / count,
        where="post",
        color=BLUE,
        label=f"{count} runs, V = {float(transient.shown_belt_speed):g} m/s",
    )
    if ends.size > 1:
        # Maximum likelihood for a shifted exponential with runs cut off at t_end.
        delay = ends[0]
        exposure = np.sum(ends - delay) + (count - ends.size) * (t_end - delay)
        mean = exposure / ends.size
        time = np.linspace(delay, t_end, 100)
        label = f"exponential, mean {mean:.0f} s after {delay:.0f} s"
        axes.plot(time, np.exp(-(time - delay) / mean), "--", color=BLACK, label=label)
    axes.axvspan(0, PAPER_TIME, color=ORANGE, alpha=0.3, linewidth=0)
    axes.set(xlabel="t (s)", ylabel="share still bounded", yscale="log", xlim=(0, t_end))
    axes.set_ylim(top=1.6)
    axes.legend(loc="lower left")
    panel_letter(axes, "a", f"{ends.size} of {count} end in the whirl")


def _speeds(axes: Axes, transient: xr.Dataset) -> None:
    lifetime = transient.lifetime.values
    left = np.isfinite(lifetime).mean(axis=1)
    axes.semilogx(transient.belt_speed, left, "o-", color=GREEN, markersize=4)
    axes.set(xlabel="belt speed V (m/s)", ylim=(-0.05, 1.1))
    axes.set_ylabel(f"share that left by t = {float(transient.t_end):g} s", color=GREEN)
    axes.axhline(0, color=GREY, linewidth=0.5)
    twin = axes.twinx()
    ordered = np.sort(np.where(np.isfinite(lifetime), lifetime, np.inf), axis=1)
    median = ordered[:, lifetime.shape[1] // 2]
    half = np.isfinite(median)
    twin.plot(transient.belt_speed.values[half], median[half], "s--", color=BLUE, markersize=4)
    twin.set_ylabel("median lifetime (s)", color=BLUE)
    twin.set_ylim(0, 1.4 * max(median[half], default=1.0))
    twin.spines["right"].set_visible(True)
    panel_letter(axes, "b")
