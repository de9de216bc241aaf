"""Fig. 4: orbit and displaced springs at (0.2π, 0.8π)."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from squealpipe.plotting.mechanism import SPRING_COLOURS, displaced_springs
from squealpipe.plotting.style import PAGE, Colour, new_figure
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("simulate/F4",),
    caption=(
        "Orbit of model A1, started at rest at α₁ = 0.2π, α₂ = 0.8π, coloured by time, with both "
        "springs drawn at the start (grey) and at the end of the run; triangle: their fixed ends. "
        "Dotted: l_pre, above which contact is lost."
    ),
    alt="Path of the mass in the x–y plane, coloured by time, with the springs at two instants.",
)
def draw(run: xr.Dataset) -> Figure:
    """The plane of motion, to scale."""
    figure, axes = new_figure(PAGE, 3.9)
    panel = axes[0, 0]
    x, y = run.x.values, run.y.values
    points = np.stack([x, y], axis=-1)
    pieces = list(np.stack([points[:-1], points[1:]], axis=1))
    time = run.time.values[:-1]
    orbit = LineCollection(
        pieces, cmap="viridis", array=time, linewidths=0.5, rasterized=True
    )
    panel.add_collection(orbit)
    _springs(panel, run, 0.0, 0.0, (Colour.light, Colour.light))
    _springs(panel, run, x[-1], y[-1], SPRING_COLOURS)
    label = r"$l_\mathrm{pre}$: contact is lost above"
    panel.axhline(
        float(run.preload), color="black", linestyle=":", linewidth=0.8, label=label
    )
    panel.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
    panel.autoscale_view()
    panel.legend(loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0)
    figure.colorbar(orbit, ax=panel, label="t (s)", shrink=0.8)
    return figure


def _springs(
    axes: Axes, run: xr.Dataset, x: float, y: float, colours: tuple[str, str]
) -> None:
    """Both springs and the mass, displaced to (x, y)."""
    lengths = float(run.length1), float(run.length2)
    angles = float(run.alpha1), float(run.alpha2)
    width = 0.06 * min(lengths)
    for path, colour in zip(
        displaced_springs(x, y, *angles, lengths, width), colours, strict=True
    ):
        axes.plot(*path.T, color=colour, linewidth=1.0, zorder=3)
        axes.plot(*path[-1], "^", color=Colour.grey, markersize=5, zorder=4)
    axes.plot(
        x,
        y,
        "o",
        color=Colour.red if colours == SPRING_COLOURS else Colour.light,
        markersize=7,
        zorder=5,
    )
