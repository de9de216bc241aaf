"""Fig. 3: x(t) and y(t) at (0.4π, 0.6π)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.figures.fig02 import inset_mechanism
from squealpipe.figures.style import BLUE, GREY, ORANGE, PAGE, new_figure, panel_letter

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "Displacements of model A1 at α₁ = 0.4π, α₂ = 0.6π. Both springs share one pivot; pushed off "
    "the belt, the mass goes round it, and each pass over the belt adds energy. (a) x grows "
    "throughout the time shown, as the paper says; it does not grow for ever (see the whirl "
    "figure). (b) y grows far less; the dotted line is l_pre, above which contact is lost."
)
ALT = (
    "Two time histories to t = 500: x oscillates with an amplitude growing from 3 to about 32; y "
    "oscillates between about minus 8 and 15, mostly above the dotted line at 1."
)


def draw(run: xr.Dataset) -> Figure:
    """Two panels.

    Args:
        run: dataset ``simulate/F3``.
    """
    figure, axes = new_figure(PAGE, 3.6, nrows=2, sharex=True)
    time = run.time.values
    for panel, letter, name, colour in zip(
        axes[:, 0], "ab", ("x", "y"), (BLUE, ORANGE), strict=True
    ):
        panel.plot(time, run[name], color=colour, linewidth=0.7)
        panel.axhline(0.0, color=GREY, linewidth=0.5)
        panel.set(ylabel=f"{name} (m)", xlim=(0.0, time[-1]))
        panel_letter(panel, letter)
    axes[1, 0].axhline(float(run.preload), color="black", linestyle=":", linewidth=0.8)
    axes[1, 0].set_xlabel("t (s)")
    inset_mechanism(axes[0, 0], float(run.alpha1), float(run.alpha2), (0.005, 0.62, 0.14, 0.4))
    return figure
