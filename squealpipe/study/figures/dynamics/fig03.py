"""Fig. 3: x(t) and y(t) at (0.4π, 0.6π)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.study.figures.dynamics.fig02 import inset_mechanism
from squealpipe.study.figures.parts.style import (
    BLACK,
    GREY,
    PAGE,
    X_COLOUR,
    Y_COLOUR,
    new_figure,
    panel_letter,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr
    from matplotlib.figure import Figure

READS = ("*simulate/F3",)
CAPTION = (
    "Displacements of model A1, started at rest at α₁ = 0.4π, α₂ = 0.6π: (a) x, along the belt, "
    "and (b) y, away from it. Orange and blue: friction as the study reads the paper; black, where "
    "drawn: with the sign of Eq. (4) mended. Dotted: l_pre, above which contact is lost."
)
ALT = (
    "Two time histories, x above y, with a drawing of the springs and a dotted line at the "
    "precompression in the lower panel."
)
TITLES = {"x": "x, along the belt", "y": r"y, away from the belt (dotted: $l_\mathrm{pre}$)"}


def draw(runs: Mapping[str, xr.Dataset]) -> Figure:
    """Two panels.

    Args:
        runs: dataset ``simulate/F3``, and ``corrected/simulate/F3``.
    """
    figure, axes = new_figure(PAGE, 3.6, nrows=2, sharex=True)
    run, *mended = (runs[name] for name in sorted(runs, key=len))
    for panel, letter, name, colour in zip(
        axes[:, 0], "ab", ("x", "y"), (X_COLOUR, Y_COLOUR), strict=True
    ):
        panel.plot(run.time, run[name], color=colour, linewidth=0.7, label="as printed")
        for other in mended:
            panel.plot(other.time, other[name], color=BLACK, lw=0.6, label="sign mended")
        panel.axhline(0.0, color=GREY, linewidth=0.5)
        panel.set(ylabel=f"{name} (m)", xlim=(0.0, float(run.time[-1])))
        panel_letter(panel, letter, TITLES[name])
    if mended:
        axes[0, 0].legend(loc="upper left", ncols=2)
    axes[1, 0].axhline(float(run.preload), color="black", ls=":", lw=0.8)
    axes[1, 0].set_xlabel("t (s)")
    inset_mechanism(axes[0, 0], run, (1.0, 0.3, 0.14, 0.4))
    return figure
