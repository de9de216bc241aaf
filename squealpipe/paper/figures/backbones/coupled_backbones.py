"""Backbones of further scenes, with branches of doubled period as insets."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from squealpipe.paper.figures.panels.backbone_panels import (
    STABLE_TO_ROUND_OFF,
    draw_scenes,
    key,
)
from squealpipe.plotting.cycles import joined
from squealpipe.plotting.style import Colour
from squealpipe.study.figures.declared import report_figure


def caption(
    branches: Mapping[str, xr.Dataset], doubled: Mapping[str, xr.Dataset]
) -> str:
    """Describe the panels, and the marks that are drawn."""
    insets = (
        " Insets, where mode 1 has period doublings (black circles): largest y of the branches of "
        "doubled period in green and purple, at twice their frequency."
    )
    return (
        "Periodic motions of model A4 in further spring arrangements, one row for each, with the "
        f"mode of the lower frequency on the left. {key(branches)}"
        f"{insets if any(each.sizes['point'] for each in doubled.values()) else ''}"
    )


@report_figure(
    reads=("backbone/[a-z]*", "doubled_branch/*"),
    caption=caption,
    alt="Panels of largest y and amplitude of x over frequency, with insets of doubled branches.",
)
def draw(
    branches: Mapping[str, xr.Dataset], doubled: Mapping[str, xr.Dataset]
) -> Figure:
    """One row for each scene; see ``parts.backbone_panels.draw_scenes``."""
    scenes = dict.fromkeys(
        name.removeprefix("backbone/").rsplit("_mode", 1)[0] for name in branches
    )
    figure = draw_scenes(branches, 0.6 + 2.5 * len(scenes))
    for panel, scene in zip(figure.axes[::2], scenes, strict=True):
        leaving = [doubled.get(f"doubled_branch/{scene}_{number}") for number in (1, 2)]
        drawn = [
            branch for branch in leaving if branch is not None and branch.sizes["point"]
        ]
        if drawn:
            _draw_doubled(panel, branches[f"backbone/{scene}_mode1"], drawn)
    return figure


def _draw_doubled(panel: Axes, simple: xr.Dataset, doubled: list[xr.Dataset]) -> None:
    inset = panel.inset_axes((0.5, 0.44, 0.48, 0.5))
    inset.margins(0.12)
    # the inset ends a little above the backbone, where doubled branches go on
    top = 1.25 * float(simple.y_peak.max())
    for branch, colour in zip(doubled, (Colour.green, Colour.purple), strict=False):
        shown = branch.isel(point=branch.y_largest.values <= top)
        _line(inset, shown, shown.y_largest.values, 2, colour)
        at = float(branch.doubling_omega), float(branch.y_largest[0])
        inset.plot(
            *at,
            "o",
            markersize=4,
            markerfacecolor="white",
            markeredgecolor=Colour.black,
            zorder=3,
        )
    limits = inset.get_xlim(), inset.get_ylim()
    _line(inset, simple, simple.y_peak.values, 1, Colour.across)
    inset.set(
        xlim=limits[0], ylim=(limits[1][0], min(limits[1][1], panel.get_ylim()[1]))
    )
    inset.xaxis.set_major_locator(MaxNLocator(4))
    inset.tick_params(labelsize=5)
    panel.indicate_inset_zoom(inset, edgecolor=Colour.black, alpha=0.4)


def _line(
    inset: Axes, branch: xr.Dataset, y: np.ndarray, times: int, colour: str
) -> None:
    """A branch at ``times`` its frequency, dotted where unstable."""
    omega = times * branch.omega.values
    unstable = np.abs(branch.stability_index.values) > STABLE_TO_ROUND_OFF
    inset.plot(omega, np.where(unstable, np.nan, y), color=colour, linewidth=1.2)
    if unstable.any():
        inset.plot(
            omega,
            np.where(joined(unstable), y, np.nan),
            ":",
            color=colour,
            linewidth=1.2,
        )
