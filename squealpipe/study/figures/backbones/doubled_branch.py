"""Branches of doubled period beside the backbones that they leave."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.study.figures.parts.backbone_panels import (
    STABLE_TO_ROUND_OFF,
    key_entries,
    say_why_empty,
)
from squealpipe.study.figures.parts.origin import angle_pair
from squealpipe.study.figures.parts.style import (
    BLUE,
    GREEN,
    LIGHT,
    ORANGE,
    PAGE,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

READS = ("backbone/[a-z]*_mode1", "doubled_branch/*")
CAPTION = (
    "Branches of doubled period of model A4, one row for each spring arrangement, mode 1, around "
    "the doublings if there are any. Left: y of the backbone, the larger of the two at which the "
    "mass rests, and largest y of the doubled branches, over the frequency, twice their own one "
    "for the latter. Dotted: unstable; circles: period doublings of the backbone, where its index "
    "is −2 and that of the doubled branch starts at 2; a row without any has no doubling on the "
    "branch followed. Right: the stability index over the same y; the grey band holds the stable "
    "orbits."
)
ALT = (
    "For each spring arrangement two panels: largest displacement over frequency for the backbone "
    "and its doubled branches, and their stability indices over the displacement."
)
_COLOURS = (ORANGE, GREEN)
_SHOWN = 1.25
"""Largest y shown, over that of the backbone."""


def draw(backbones: Mapping[str, xr.Dataset], doubled: Mapping[str, xr.Dataset]) -> Figure:
    """Two panels a scene, from datasets ``backbone/<scene>_mode1`` and ``doubled_branch/…``."""
    figure, axes = new_figure(PAGE, 0.5 + 2.5 * len(backbones), nrows=len(backbones), ncols=2)
    letters = iter("abcdefghijklmnopqrst")
    for (left, right), (name, simple) in zip(axes, backbones.items(), strict=True):
        scene = name.removeprefix("backbone/").removesuffix("_mode1")
        leaving = [
            branch
            for key, branch in doubled.items()
            if key.removeprefix("doubled_branch/").rpartition("_")[0] == scene
        ]
        _draw_scene(left, right, simple, leaving)
        angles = angle_pair(simple.attrs["alpha1"], simple.attrs["alpha2"])
        panel_letter(left, next(letters), angles)
        panel_letter(right, next(letters), "stability index")
    handles, labels = key_entries(axes.ravel())
    if labels:
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _draw_scene(left: Axes, right: Axes, simple: xr.Dataset, doubled: list[xr.Dataset]) -> None:
    if not simple.sizes["point"]:
        for panel in (left, right):
            say_why_empty(panel, simple)
        return
    top = _SHOWN * float(simple.y_peak.max())
    right.axhspan(-2, 2, color=LIGHT, alpha=0.4, linewidth=0)
    corners = []
    _draw_branch(left, right, simple, 1, simple.y_peak.values, BLUE, "backbone")
    for number, (branch, colour) in enumerate(zip(doubled, _COLOURS, strict=False), start=1):
        if not branch.sizes["point"]:
            continue
        shown = branch.isel(point=branch.y_largest.values <= top)
        label = f"doubled branch {number}"
        corners += [(2 * shown.omega, shown.y_largest), (branch.doubling_omega, shown.y_largest[0])]
        _draw_branch(left, right, shown, 2, shown.y_largest.values, colour, label)
        left.plot(
            branch.doubling_omega, branch.y_largest[0], linestyle="none", marker="o",
            markersize=5, markerfacecolor="white", markeredgecolor=colour, zorder=3,
            label="period doubling",
        )  # fmt: skip
    left.set(xlabel="ω, twice ω of doubled branches (rad/s)", ylabel="y (m)")
    right.set(xlabel="y (m)", ylabel="stability index", ylim=(-3, 3.5))
    if corners:
        left.set(xlim=_framed([x for x, _ in corners]), ylim=_framed([y for _, y in corners]))
        right.set_xlim(left.get_ylim())


def _framed(values: Sequence[xr.DataArray]) -> tuple[float, float]:
    """Least and largest of several arrays with a margin."""
    least = min(float(array.min()) for array in values)
    largest = max(float(array.max()) for array in values)
    margin = 0.15 * (largest - least)
    return least - margin, largest + margin


def _draw_branch(
    left: Axes, right: Axes, branch: xr.Dataset, times: int, y: np.ndarray, colour: str, label: str
) -> None:
    """A branch at ``times`` its frequency, dotted where unstable, and its index."""
    index = branch.stability_index.values
    omega = times * branch.omega.values
    unstable = np.abs(index) > STABLE_TO_ROUND_OFF
    near = unstable | np.roll(unstable, 1) | np.roll(unstable, -1)
    left.plot(omega, np.where(unstable, np.nan, y), color=colour, linewidth=1.4, label=label)
    left.plot(omega, np.where(near & unstable.any(), y, np.nan), color=colour, linestyle=":")
    right.plot(y, index, color=colour, linewidth=1.2)
