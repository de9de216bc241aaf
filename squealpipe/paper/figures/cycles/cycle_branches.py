"""Amplitude of limit cycles over friction, stable and unstable, beside long runs."""

import json

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.cycles import key_entries, largest, trace_branch
from squealpipe.plotting.origin import angle_pair, parameter, scene_title
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=(
        "cycles/branch_F3_down",
        "cycles/branch_F3_up",
        "cycles/branch_flutter",
        "cycles/extremes",
    ),
    caption=(
        "Limit cycles of the full model with dashpots over the friction coefficient: largest |x| "
        "of the cycle, one panel for each spring arrangement in which cycles or different ends of "
        "long runs were found. Full blue lines: stable; dashed orange: unstable, if there are any; "
        "marks: located special points. Grey dots: largest |x| in the last fifth of long runs from "
        "starts near and far, cycles and states of rest alike."
    ),
    alt="Charts of largest |x| over friction: branches of cycles as lines, ends of runs as dots.",
)
def draw(
    down: xr.Dataset, up: xr.Dataset, flutter: xr.Dataset, extremes: xr.Dataset
) -> Figure:
    """A panel for each scene that moves at all."""
    unit = parameter(extremes, "preload")
    angles = json.loads(flutter.attrs["config"])["cycles"]["flutter"]
    onset = "flutter onset" if flutter.sizes["point"] else "no branch"
    panels = {
        "F3": (scene_title("F3"), (down, up)),
        "flutter": (
            f"{angle_pair(*(angle * np.pi for angle in angles))}, {onset}",
            (flutter,),
        ),
        "F2d": (scene_title("F2d"), ()),
    }
    sizes = {name: extremes.late_max_x.sel(scene=name).values / unit for name in panels}
    # in l_pre; where late |x| of all long runs agrees within it, they settle on the same motion
    moving = [
        name
        for name, (_, branches) in panels.items()
        if np.ptp(sizes[name]) > 0.5
        or any(branch.sizes["point"] for branch in branches)
    ] or ["F3"]
    figure, axes = style.new_figure(style.PAGE, 3.1, ncols=len(moving))
    for letter, panel, name in zip("abc", axes[0], moving, strict=False):
        title, branches = panels[name]
        friction = np.broadcast_to(extremes.mu.values[:, None], sizes[name].shape)
        runs = panel.plot(
            friction,
            sizes[name],
            ".",
            color=style.Colour.grey,
            markersize=2.5,
            zorder=1,
        )
        runs[0].set_label("long runs")
        for branch in branches:
            trace_branch(panel, branch.mu.values, largest(branch, "x") / unit, branch)
        _enlarge(panel, branches, unit)
        panel.set(xlabel="μ", ylim=(0, None))
        style.panel_letter(panel, letter, title)
    axes[0, 0].set_ylabel(r"largest |x| / $l_\mathrm{pre}$")
    figure.legend(*key_entries(axes[0]), loc="outside lower center", ncols=4)
    return figure


def _enlarge(panel: Axes, branches: tuple[xr.Dataset, ...], unit: float) -> None:
    """An inset of branches that would lie on the axis."""
    drawn = [branch for branch in branches if branch.sizes["point"] > 1]
    top = max(
        (float(np.abs(branch.x_max).max()) / unit for branch in drawn), default=0.0
    )
    if not 0.0 < top < 0.1 * panel.get_ylim()[1]:
        return
    inset = panel.inset_axes((0.12, 0.62, 0.45, 0.34))
    for branch in drawn:
        trace_branch(inset, branch.mu.values, largest(branch, "x") / unit, branch)
    inset.tick_params(labelsize=5)
