"""The paper's growing response until it saturates, and the size of the whirl over belt speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.figures.style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    PAGE,
    REGIME_COLOURS,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAPTION = (
    "The response of Fig. 3 does not grow for ever. (a) |x| at (0.4π, 0.6π) saturates once the "
    "mass passes the belt at belt speed, for friction then brakes as much as it drives; the band "
    "marks the time that the paper's kind of figure shows. (b) Size of the motion over belt speed: "
    "a limit cycle set by V. Dashed: the line that follows from the energy at speed V in springs "
    "of stiffness k₁ + k₂; full line: fit of the same form. At low speed there is no whirl."
)
ALT = (
    "Left, an oscillation whose amplitude rises to about 80 and then stays. Right, a log–log chart "
    "of the final amplitude over belt speed: flat near 7 below speed 1, then rising to a line of "
    "slope one."
)
PAPER_TIME = 500.0
"""Horizon of the paper's scene, in √(m/k1)."""


def draw(run: xr.Dataset, sizes: xr.Dataset) -> Figure:
    """Two panels.

    Args:
        run: dataset ``simulate/whirl``.
        sizes: dataset ``whirl``.
    """
    figure, axes = new_figure(PAGE, 2.9, ncols=2, width_ratios=(1.3, 1))
    panel = axes[0, 0]
    panel.plot(run.time, run.x, color=BLUE, linewidth=0.25, rasterized=True)
    panel.axvspan(0, PAPER_TIME, color=ORANGE, alpha=0.25, linewidth=0, label="shown in Fig. 3")
    panel.axhline(0, color=GREY, linewidth=0.5)
    panel.set(xlabel="t (s)", ylabel="x (m)", xlim=(0, float(run.time[-1])))
    panel.legend(loc="upper left")
    panel_letter(panel, "a", f"max |x| = {float(np.abs(run.x).max()):.4g} m")
    _sizes(axes[0, 1], sizes)
    return figure


def _sizes(axes: Axes, sizes: xr.Dataset) -> None:
    speed = sizes.belt_speed.values
    names = str(sizes.motion.attrs["flag_meanings"]).split()
    for k, name in enumerate(names):
        chosen = sizes.motion.values == k
        if chosen.any():
            axes.loglog(
                speed[chosen],
                sizes.amplitude.values[chosen],
                "o" if name == "whirl" else "s",
                color=REGIME_COLOURS[name],
                markersize=4,
                label=name.replace("_", " "),
            )
    line = np.geomspace(speed[0], speed[-1], 200)
    energy = float(sizes.energy_offset) + float(sizes.energy_slope) * line
    axes.loglog(line, energy, "--", color=GREY, label="energy at speed V")
    if np.isfinite(sizes.slope):
        fit = float(sizes.offset) + float(sizes.slope) * line
        label = f"{float(sizes.offset):.3g} m + {float(sizes.slope):.3g} s · V"
        axes.loglog(line, fit, color=BLACK, linewidth=0.8, label=label)
    axes.set(xlabel="belt speed V (m/s)", ylabel="largest |x|, late (m)")
    axes.legend(loc="upper left")
    panel_letter(axes, "b")
