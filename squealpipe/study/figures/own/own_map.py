"""A map of squeal and hammering over both spring angles, and the nearest quiet angles."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.codes import Verdict
from squealpipe.plotting.style import (
    PAGE,
    Colour,
    category_colours,
    new_figure,
    patches,
    white_halo,
)
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("verdict_map", "assess/*"),
    caption=(
        "What becomes of steady sliding after a small push, over both spring angles (in degrees; "
        "alpha1 is counted from +x, the way the belt runs, alpha2 from −x). Crosses: the scenes "
        "whose angles lie in the map; arrows lead from each to the nearest angles at which its "
        "verdict changes between quiet and noise. Undetermined: not settled in 1,600 periods."
    ),
    alt="A map over both spring angles in white, orange, red and grey with crosses and arrows.",
)
def draw(verdicts: xr.Dataset, answers: Mapping[str, xr.Dataset]) -> Figure:
    """The map with the scenes."""
    figure, axes = new_figure(0.62 * PAGE, 4.1)
    panel = axes[0, 0]
    degrees = [np.degrees(verdicts[name].values) for name in ("alpha1", "alpha2")]
    tones = {
        Verdict.quiet: Colour.white,
        Verdict.squeals: Colour.orange,
        Verdict.hammers: Colour.red,
        Verdict.undetermined: Colour.light,
    }
    panel.pcolormesh(
        *degrees,
        verdicts.verdict.values.T,
        shading="nearest",
        rasterized=True,
        **category_colours(list(tones.values())),
    )
    limits = [(axis[0], axis[-1]) for axis in degrees]
    panel.set(
        xlim=limits[0],
        ylim=limits[1],
        aspect="equal",
        xlabel="alpha1 (degrees)",
        ylabel="alpha2 (degrees)",
        xticks=range(0, 181, 30),
        yticks=range(0, 181, 30),
    )
    panel.spines[["top", "right"]].set_visible(True)
    for name, answer in answers.items():
        at = [float(np.degrees(answer[key])) for key in ("alpha1", "alpha2")]
        if not all(
            low <= here <= high for here, (low, high) in zip(at, limits, strict=True)
        ):
            continue
        to = [float(np.degrees(answer[f"quiet_{key}"])) for key in ("alpha1", "alpha2")]
        if np.isfinite(to).all():
            look = {
                "arrowstyle": "-|>",
                "color": Colour.black,
                "lw": 1.2,
                "shrinkA": 0,
                "shrinkB": 0,
            }
            arrow = panel.annotate(
                "", to, at, arrowprops=look, zorder=5, annotation_clip=False
            )
            arrow.arrow_patch.set_clip_path(panel.patch)  # it may lead out of the map
        panel.plot(*at, "x", color="white", markersize=8, markeredgewidth=3)
        panel.plot(*at, "x", color=Colour.blue, markersize=6, markeredgewidth=1.5)
        # the name of the scene stays in the map
        is_right = 2.0 * at[0] > sum(limits[0])
        panel.annotate(
            name.removeprefix("assess/"),
            at,
            (-6 if is_right else 6, -10),
            textcoords="offset points",
            ha="right" if is_right else "left",
            color=Colour.blue,
            path_effects=white_halo,
        )
    figure.legend(
        handles=patches((tone, each.words) for each, tone in tones.items()),
        loc="outside lower center",
        ncols=len(tones),
    )
    return figure
