"""The paper's growing response until it saturates, and the size of the whirl over belt speed."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from squealpipe.brake.schema.dynamics.extremes import largest_size
from squealpipe.codes import flag_words
from squealpipe.parameters import SCENES
from squealpipe.plotting import style
from squealpipe.plotting.origin import time_unit
from squealpipe.schema import meanings
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.words import number


def caption(_: xr.Dataset, sizes: xr.Dataset) -> str:
    """Describe the panels; explain the fit and the late changes where there are any."""
    below = np.abs(sizes.belt_speed.values).min() < float(sizes.fit_range[0])
    fitted = (
        " Only where the mass whirls: a full line, fit of the same form, over the speeds that it "
        f"covers{', dotted below them' if below else ''}."
    )
    changed = " Cross: another kind of motion in the last quarter of the run."
    return (
        "The response of Fig. 3 followed further. (a) x at (0.4π, 0.6π); the band marks the time "
        "that Fig. 3 shows. (b) Largest |x| late in the run over belt speed. Dashed: the line "
        "that follows from the energy at speed V in springs of stiffness k₁ + k₂."
        f"{fitted if np.isfinite(sizes.slope) else ''}"
        f"{changed if (sizes.motion_changed == 1).any() else ''}"
    )


@report_figure(
    reads=("simulate/whirl", "whirl"),
    caption=caption,
    alt=(
        "Left, x over time; right, a log–log chart of its final size over belt speed with two "
        "lines."
    ),
)
def draw(run: xr.Dataset, sizes: xr.Dataset) -> Figure:
    """Two panels."""
    figure, axes = style.new_figure(style.PAGE, 2.9, ncols=2, width_ratios=(1.3, 1))
    panel = axes[0, 0]
    panel.plot(
        run.time, run.x, color=style.Colour.along, linewidth=0.25, rasterized=True
    )
    shown = SCENES["F3"].t_end * time_unit(run)
    panel.axvspan(
        0,
        shown,
        color=style.Colour.grey,
        alpha=0.25,
        linewidth=0,
        label="shown in Fig. 3",
    )
    panel.axhline(0, color=style.Colour.grey, linewidth=0.5)
    panel.set(xlabel="t (s)", ylabel="x (m)", xlim=(0, float(run.time[-1])))
    panel.legend(loc="lower right", bbox_to_anchor=(1, 0.98))
    largest = number(float(largest_size(run, "x").max()), 4)
    style.panel_letter(panel, "a", f"x in time, max |x| = {largest} m")
    _sizes(axes[0, 1], sizes)
    return figure


def _sizes(axes: Axes, sizes: xr.Dataset) -> None:
    speed = np.abs(sizes.belt_speed.values)
    kinds = [
        (
            sizes.motion.values == k,
            "o" if name == "whirl" else "s",
            style.REGIME_COLOURS[name],
            flag_words(name),
        )
        for k, name in meanings(sizes.motion).items()
    ]
    changed = sizes.motion_changed.values == 1
    kinds.append((changed, "x", style.Colour.black, "another kind in the last quarter"))
    for chosen, marker, colour, words in kinds:
        if chosen.any():
            points = speed[chosen], sizes.amplitude.values[chosen]
            axes.loglog(*points, marker, color=colour, markersize=4, label=words)
    line = np.geomspace(speed[0], speed[-1], 200)
    energy = float(sizes.energy_offset) + float(sizes.energy_slope) * line
    axes.loglog(line, energy, "--", color=style.Colour.grey, label="energy at speed V")
    if np.isfinite(sizes.slope):
        fit = float(sizes.offset) + float(sizes.slope) * line
        label = (
            f"{number(float(sizes.offset))} m + {number(float(sizes.slope))} s · |V|"
        )
        low, high = sizes.fit_range.values
        inside = (line >= low) & (line <= high)
        axes.loglog(
            line[inside],
            fit[inside],
            color=style.Colour.black,
            linewidth=0.8,
            label=label,
        )
        axes.loglog(
            line[line <= low],
            fit[line <= low],
            ":",
            color=style.Colour.black,
            linewidth=0.8,
        )
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set(xlabel="belt speed |V| (m/s)", ylabel="largest |x|, late (m)")
    axes.legend(loc="upper left")
    style.panel_letter(axes, "b", "size over belt speed")
