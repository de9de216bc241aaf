"""Model A1 started on periodic motions of A4: y over time and its spectrum, beside those of A4."""

from itertools import cycle

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.origin import scene_name
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("a1_beside_a4",),
    caption=(
        "Model A1 started on periodic motions of A4 (grey), with both springs of the length L. "
        "Left: y over the first periods; right: amplitude spectrum of y over 32 periods."
    ),
    alt="Rows of two panels: time histories of y of both models, and their spectra.",
)
def draw(beside: xr.Dataset) -> Figure:
    """Draw one row for each scene: y over time, and its spectrum, for several spring lengths."""
    scenes = beside.scene.values
    figure, axes = style.new_figure(
        style.PAGE, 0.5 + 1.4 * len(scenes), text=1.36, nrows=len(scenes), ncols=2
    )
    letters = iter("abcdefghijklmnopqrst")
    columns = {"period": "y", "order": "spectrum"}
    for row, scene in zip(axes, scenes, strict=True):
        part = beside.sel(scene=scene)
        for panel, (axis, kind) in zip(row, columns.items(), strict=True):
            _draw(panel, part, axis)
            title = f"{scene_name(beside, str(scene))}: {kind}"
            style.panel_letter(panel, next(letters), title)
        row[0].set_ylabel("y (m)")
        row[1].set_ylabel("amplitude (m)")
    axes[-1, 0].set_xlabel("time / period of A4")
    axes[-1, 1].set_xlabel("frequency / ω of A4")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _draw(panel: Axes, part: xr.Dataset, axis: str) -> None:
    kind = "y" if axis == "period" else "spectrum"
    panel.plot(
        part[axis],
        part[f"{kind}_a4"],
        color=style.Colour.grey,
        lw=2.6,
        alpha=0.6,
        label="A4",
    )
    looks = (
        (style.Colour.red, "-"),
        (style.Colour.orange, "--"),
        (style.Colour.green, "-."),
        (style.Colour.blue, ":"),
    )
    for ratio, (colour, dash) in zip(
        part.length_ratio.values, cycle(looks), strict=False
    ):
        one = part.sel(length_ratio=ratio)
        label = f"A1, L = {ratio:g} $l_\\mathrm{{pre}}$"
        panel.plot(
            one[axis], one[f"{kind}_a1"], dash, color=colour, lw=0.9, label=label
        )
    panel.set_xlim(0, float(np.ceil(part[axis].values[-1])))
