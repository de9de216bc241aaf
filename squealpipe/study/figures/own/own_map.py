"""Where contact is lost and sliding is unstable around the scenes of a study."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting.style import BLUE, HALO, PAGE, new_figure
from squealpipe.study.figures.linear.fig07 import draw_kinds, key

READS = ("validity_[bm]*", "own_scenes")
ALT = "A map over both spring angles in white, orange, grey and black with crosses at the scenes."


def caption(found: Mapping[str, xr.Dataset], scenes: xr.Dataset) -> str:  # noqa: ARG001
    """What is shown, with the boundary where the study has it."""
    lines = (
        " Blue lines: boundary of kept contact." if "validity_boundary" in found else ""
    )
    return (
        "Where the mass, started at rest, loses contact (white; orange where steady sliding is "
        "unstable too) and keeps it (grey; black where steady sliding is unstable), over both "
        f"spring angles.{lines} Crosses: the scenes whose angles lie in the map."
    )


CAPTION = caption


def draw(found: Mapping[str, xr.Dataset], scenes: xr.Dataset) -> Figure:
    """The map, with the boundary where the study has it, and the scenes."""
    figure, axes = new_figure(0.7 * PAGE, 3.9)
    panel = axes[0, 0]
    draw_kinds(panel, found["validity_map"], found.get("validity_boundary"))
    for scene in scenes.scene.values:
        here = scenes.sel(scene=scene)
        at = float(here.alpha1), float(here.alpha2)
        if not all(0.0 <= angle <= np.pi for angle in at):
            continue
        panel.plot(*at, "x", color="white", markersize=10, markeredgewidth=4)
        panel.plot(*at, "x", color=BLUE, markersize=8, markeredgewidth=2)
        panel.annotate(
            str(scene),
            at,
            (5, 5),
            textcoords="offset points",
            color=BLUE,
            path_effects=HALO,
        )
    figure.legend(
        handles=[*key(), *panel.get_legend_handles_labels()[0]],
        loc="outside lower center",
        ncols=2,
    )
    return figure
