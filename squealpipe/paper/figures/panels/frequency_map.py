"""Maps of one natural frequency in both contact states: the paper's Figs. 8 and 9."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from squealpipe.plotting import style
from squealpipe.schema import Outcome

LINES_AND_HATCHING = (
    "Dashed: α₁ + α₂ = nπ, where det K = 0; dotted: α₁ + α₂ = nπ/2, n odd. Hatched: flutter, a "
    "complex pair, of which the common frequency is shown."
)
"""Key for captions: what the lines and the hatching mean."""

(hatch_key,) = style.patches(
    [(style.Colour.white, "flutter: common frequency")], hatch=style.HATCH
)
"""Key to what :func:`outline` draws."""


def draw_mode(frequencies: xr.Dataset, mode: int) -> Figure:
    """Two panels, in contact and separated, with one colour scale."""
    figure, axes = style.new_figure(style.PAGE, 3.45, ncols=2)
    omega = frequencies.omega.sel(mode=mode)
    upper = float(omega.max())
    lower = 0.0 if mode == 1 else float(omega.min())
    for panel, letter, state in zip(
        axes[0], "ab", ("contact", "separated"), strict=True
    ):
        values = omega.sel(contact_state=state).values
        scale = {"cmap": "cividis", "vmin": lower, "vmax": upper}
        mesh = style.draw_map(panel, frequencies, values, **scale)
        flutter = (
            frequencies.outcome.sel(mode=mode, contact_state=state)
            == Outcome.complex_pair
        )
        shown = np.where(flutter, np.nan, values)
        step = 0.2 if mode == 1 else 0.1
        levels = np.arange(lower + step, float(np.nanmax(shown)), step)
        dark = levels < 0.5 * (lower + upper)
        lines = isoline(  # to read in greyscale
            panel,
            frequencies,
            shown,
            levels,
            np.where(dark, style.Colour.white, style.Colour.black),
            0.5,
        )
        panel.clabel(
            lines,
            fontsize=5.5,
            fmt="%.1f",
            manual=_on_diagonal(frequencies, shown, levels),
        )
        outline(panel, frequencies, flutter.values)
        style.panel_letter(panel, letter, "in contact" if state == "contact" else state)
    draw_sums(axes[0, 1])
    lines, _ = axes[0, 1].get_legend_handles_labels()
    figure.legend(handles=[*lines, hatch_key], loc="outside lower center", ncols=3)
    figure.colorbar(mesh, ax=axes, label=f"ω{'₁₂'[mode - 1]} (rad/s)", shrink=0.8)  # type: ignore[arg-type]
    return figure


def _on_diagonal(
    frequencies: xr.Dataset, values: np.ndarray, levels: np.ndarray
) -> list[tuple[float, float]]:
    """Return where isolines cross the upper half of the diagonal away from gaps: labels there do
    not overlap.
    """
    angles, along = frequencies.alpha1.values, np.diagonal(values)
    near = len(along) // 15
    return [
        (angles[index], angles[index])
        for level in levels
        for index in np.flatnonzero(np.diff(along > level))
        if len(along) // 2 <= index < len(along) - 3
        and np.isfinite(
            values[index - near : index + near, index - near : index + near]
        ).all()
    ]


def draw_sums(axes: Axes) -> None:
    """The exact lines of the separated state: det K = 0, and smallest |Z| for any stiffnesses."""
    along = np.array([-np.pi, 2 * np.pi])
    look: dict[str, Any] = {
        "color": style.Colour.black,
        "lw": 1.1,
        "scalex": False,
        "scaley": False,
    }
    halo = [withStroke(linewidth=2.2, foreground=style.Colour.white)]
    for odd, label, dash in (
        (0, "α₁ + α₂ = nπ", "--"),
        (1, "α₁ + α₂ = nπ/2, n odd", ":"),
    ):
        for number in range(odd, 5, 2):
            line = number * np.pi / 2 - along
            axes.plot(along, line, ls=dash, label=label, path_effects=halo, **look)
            label = "_"


def isoline(
    axes: Axes,
    dataset: xr.Dataset,
    values: Any,
    levels: Any,
    colour: Any,
    width: float = 0.7,
) -> Any:
    """Lines on which values (alpha1, alpha2) are those of ``levels``."""
    angles = (dataset.alpha1.values, dataset.alpha2.values)
    levels = np.atleast_1d(levels)
    return axes.contour(
        *angles, values.T, levels=levels, colors=colour, linewidths=width
    )


def outline(axes: Axes, dataset: xr.Dataset, mask: np.ndarray) -> None:
    """Hatch the cells of a mask, with a line around them."""
    style.hatch(axes, dataset, mask)
    if mask.any():
        isoline(axes, dataset, mask.astype(float), 0.5, style.Colour.red)
