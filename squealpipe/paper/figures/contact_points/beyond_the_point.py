"""An elastic pad on one, two and more contact points: critical friction, contact loss, timing."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.codes import Verdict
from squealpipe.plotting import style
from squealpipe.plotting.contact_points import draw_onsets
from squealpipe.structures.schema.contact_points import MOST_FRICTION
from squealpipe.study.figures.declared import report_figure


def _quiet(pads: xr.Dataset) -> str:
    quiet = pads.design.values[pads.verdict.values == Verdict.quiet]
    return "; ".join(map(str, quiet)) or "none"


def caption(pads: xr.Dataset) -> str:
    """Describe the panels, and name the pads that are quiet."""
    return (
        "An elastic pad on several contact points of equal total stiffness and preload, and a "
        "stiff one. (a) Friction at which the first mode turns unstable; dashed: friction of the "
        f"runs; triangles: none up to {MOST_FRICTION:g}. (b) Share of the time without contact, "
        "over the pad's length from the edge that the belt meets first, of the pads that do not "
        f"stay quiet (quiet: {_quiet(pads)}). Then, of the last two of these: which point is open "
        "(white) when, over four periods of the strongest line."
    )


@report_figure(
    reads=("contact_points",),
    caption=caption,
    alt=(
        "Critical friction by pad; share of time without contact over the pad's length; open and "
        "closed contact points over time."
    ),
)
def draw(pads: xr.Dataset) -> Figure:
    """Critical friction, contact loss along the pad, and its timing in the last two that sound."""
    loud = np.flatnonzero(np.isfinite(pads.dominant_frequency.values))
    shown = loud[-2:]
    count = max(len(shown), 1)
    figure, axes = style.new_figure(
        style.PAGE, 2.6, ncols=2 + count, width_ratios=[1.0, 1.2, *[1.2] * count]
    )
    draw_onsets(axes[0, 0], pads)
    _draw_loss(axes[0, 1], pads, loud)
    if not len(shown):
        all_quiet = (pads.verdict == Verdict.quiet).all()
        said = "every pad is quiet" if all_quiet else "no pad has a settled motion"
        style.say_instead(axes[0, 2], said)
    for panel, place in zip(axes[0, 2:], shown, strict=False):
        _draw_timing(panel, pads.isel(design=int(place)))
    titles = ["first onset", "contact loss", *_titles(pads, shown)]
    style.panel_letters(axes[0], titles)
    return figure


def _titles(pads: xr.Dataset, shown: np.ndarray) -> list[str]:
    return [
        f"points: {pads.design.values[place]}; "
        f"{float(pads.dominant_frequency[place]) / 1e3:.3g} kHz"
        for place in shown
    ]


def _draw_loss(axes: Axes, pads: xr.Dataset, loud: np.ndarray) -> None:
    for place, colour in zip(loud, style.Colour.palette, strict=False):
        one = pads.isel(design=int(place))
        axes.plot(
            one.position,
            one.separated_fraction,
            "o-",
            color=colour,
            ms=3,
            label=f"points: {one.design.item()}",
        )
    if len(loud):
        axes.legend()
    axes.set(xlabel="place along the pad", ylabel="share of time open", ylim=(0.0, 1.0))


def _draw_timing(axes: Axes, pad: xr.Dataset) -> None:
    count = int(pad.contacts)
    is_open = pad.force.values[:count] <= 0.0
    axes.imshow(
        ~is_open,
        aspect="auto",
        cmap="Greys",
        vmin=0,
        vmax=1.6,
        interpolation="nearest",
        extent=(0.0, float(pad.instant[-1]), count + 0.5, 0.5),
    )
    for edge in np.arange(1.5, count):
        axes.axhline(edge, color=style.Colour.light, linewidth=0.5)
    axes.set_yticks(np.arange(1, count + 1))
    axes.set(xlabel="periods", ylabel="point, leading first")
