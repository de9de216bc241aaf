"""The paper's limit cycle at (0.2π, 0.8π) is a transient: how long it lasts."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from squealpipe.parameters import SCENES
from squealpipe.plotting import style
from squealpipe.plotting.origin import time_unit
from squealpipe.schema.inference import wilson_interval
from squealpipe.text import number

READS = ("transient",)
CAPTION = (
    "How long the bounded motion of Fig. 4 lasts. Share of runs that still swing to and fro after "
    "a time, over perturbations of the start up to a billionth of l_pre: Kaplan–Meier estimate. "
    "Where runs end: its 95 % band, and dashed the decay at one hazard for all ages. Orange: the "
    "time of Fig. 4."
)
ALT = "A survival curve of the bounded motion on a logarithmic axis."


def draw(transient: xr.Dataset) -> Figure:
    """The survival curve.

    Args:
        transient: dataset ``transient``.
    """
    figure, axes = style.new_figure(0.7 * style.PAGE, 2.9)
    _survival(axes[0, 0], transient)
    return figure


def _survival(axes: Axes, transient: xr.Dataset) -> None:
    lifetime, t_end = transient.lifetime.values, float(transient.t_end)
    count, ended = lifetime.size, np.count_nonzero(np.isfinite(lifetime))
    age = transient.survival_time.values
    axes.step(
        age,
        transient.survival,
        where="post",
        color=style.BLUE,
        label=f"{count} runs, V = {number(float(transient.belt_speed))} m/s",
    )
    if ended:  # before the first end the estimate has no band
        axes.fill_between(
            age, transient.survival_low, transient.survival_high, step="post", color=style.BLUE,
            alpha=0.25, linewidth=0, label="95 % band",
        )  # fmt: skip
    _constant_hazard(axes, transient)
    shown = SCENES["F4"].t_end * time_unit(transient)
    axes.axvspan(0, shown, color=style.ORANGE, alpha=0.3, linewidth=0, label="shown in Fig. 4")
    axes.set(xlabel="t (s)", ylabel="share still bounded", yscale="log", xlim=(0, t_end))
    positive = transient.survival.values[transient.survival.values > 0]
    axes.set_ylim(bottom=0.5 * positive.min(), top=1.6)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.legend(loc="lower left")
    most = "" if ended else f" (95 %: at most {100 * wilson_interval(0, count)[1]:.3g} %)"
    axes.set_title(f"{ended} of {count} end in the whirl{most}", loc="left")


def _constant_hazard(axes: Axes, transient: xr.Dataset) -> None:
    """What the mean hazard of all ages would give: ends over time at risk."""
    lifetime = transient.lifetime.fillna(transient.t_end).values
    exposure = lifetime.sum()
    ended = np.count_nonzero(np.isfinite(transient.lifetime.values))
    if ended:
        rate = ended / exposure
        age = transient.survival_time.values
        label = f"constant hazard, mean {number(1 / rate, 4)} s"
        axes.plot(age, np.exp(-rate * age), "--", color=style.BLACK, label=label)
