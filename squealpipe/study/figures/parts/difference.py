"""Two versions of a map side by side, and where they differ."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from squealpipe.schema import Variable, flag_table
from squealpipe.store.comparison.differences import outside_tolerance
from squealpipe.study.figures.parts.style import (
    BLACK,
    PAGE,
    RED,
    WHITE,
    category_colours,
    draw_map,
    new_figure,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAPTION = (
    "Both maps on one scale, and their difference: for numbers its size where it is beyond the "
    "tolerance (white: within), for flags the cells that flipped."
)
ALT = "Three square maps over both spring angles: first run, second run, difference."
MAP = ("alpha1", "alpha2")
BAR: dict[str, Any] = {"location": "bottom", "aspect": 40}


def drawable(array: xr.DataArray) -> bool:
    """Whether a variable is a map over both spring angles with more than one cell per side."""
    return array.dims[:2] == MAP and array.dtype.kind in "fiub" and min(array.shape[:2]) > 1


def draw(name: str, a: xr.DataArray, b: xr.DataArray, entry: Variable) -> Figure:
    """Draw a variable of two aligned datasets.

    Args:
        name: of the variable.
        a, b: maps over (alpha1, alpha2); of further dimensions the most different slice is shown.
        entry: its line in the schema.
    """
    left, right, chosen = _most_different(a, b, entry)
    differing = outside_tolerance(left, right, entry)
    figure, axes = new_figure(PAGE, 3.4, ncols=3, sharex=True, sharey=True)
    angles = (a.alpha1.values, a.alpha2.values)
    title = ", ".join([name, *(f"{key} = {value}" for key, value in chosen.items())])
    if entry.flags is not None:
        _draw_flags(axes[0], angles, (left, right), flag_table(entry.flags))
        mesh = draw_map(axes[0, 2], *angles, differing, **category_colours([WHITE, RED]))
        axes[0, 2].set_title(f"(c) {int(differing.sum())} flipped (red)", loc="left")
    else:
        finite = np.concatenate([values[np.isfinite(values)] for values in (left, right)])
        lower, upper = (finite.min(), finite.max()) if finite.size else (0.0, 1.0)
        for panel, values in zip(axes[0, :2], (left, right), strict=True):
            mesh = draw_map(panel, *angles, values.astype(float), vmin=lower, vmax=upper)
        figure.colorbar(mesh, ax=list(axes[0, :2]), label=f"{title} ({entry.units})", **BAR)
        with np.errstate(invalid="ignore"):
            gap = np.where(differing, np.abs(left.astype(float) - right), np.nan)
        mesh = draw_map(axes[0, 2], *angles, gap, cmap="Reds", vmin=0.0)
        axes[0, 2].set_title(f"(c) {int(differing.sum())} cells differ", loc="left")
        if np.isfinite(gap).any():
            figure.colorbar(mesh, ax=axes[0, 2], label=f"difference ({entry.units})", **BAR)
        _mark_one_sided(axes[0, 2], angles, differing & ~np.isfinite(gap))
    axes[0, 0].set_title(f"(a) first: {title}", loc="left")
    axes[0, 1].set_title("(b) second", loc="left")
    axes[0, 1].set_ylabel("")
    axes[0, 2].set_ylabel("")
    return figure


def _most_different(
    a: xr.DataArray, b: xr.DataArray, entry: Variable
) -> tuple[np.ndarray, np.ndarray, dict[str, object]]:
    """Both sides as plain maps; along further dimensions where most cells differ."""
    left, right = a.values, b.values
    if left.ndim == len(MAP):
        return left, right, {}
    counts = outside_tolerance(left, right, entry).sum(axis=(0, 1))
    place = np.unravel_index(int(counts.argmax()), counts.shape)
    chosen: dict[str, object] = {}
    for dim, index in zip(map(str, a.dims[2:]), place, strict=True):
        chosen[dim] = a.coords[dim].values[index].item() if dim in a.coords else int(index)
    at: Any = (..., *place)
    return left[at], right[at], chosen


def _draw_flags(
    axes: np.ndarray,
    angles: tuple[np.ndarray, np.ndarray],
    sides: tuple[np.ndarray, np.ndarray],
    meanings: dict[int, str],
) -> None:
    """Flags that occur, each with a tone of its own, named in a legend below."""
    from matplotlib import colormaps
    from matplotlib.patches import Patch

    present = np.unique(np.concatenate([values.ravel() for values in sides]))
    tones = [
        colormaps["cividis"](0.1 + 0.85 * i / max(len(present) - 1, 1)) for i in range(len(present))
    ]
    for panel, values in zip(axes[:2], sides, strict=True):
        draw_map(panel, *angles, np.searchsorted(present, values), **category_colours(tones))
    handles = [
        Patch(
            facecolor=tone, edgecolor=BLACK, linewidth=0.4, label=meanings.get(int(flag), str(flag))
        )
        for flag, tone in zip(present, tones, strict=True)
    ]
    axes[0].figure.legend(handles=handles, loc="outside lower left", ncols=min(len(handles), 6))


def _mark_one_sided(
    axes: Axes, angles: tuple[np.ndarray, np.ndarray], one_sided: np.ndarray
) -> None:
    """Crosses where a number stands on one side only."""
    rows, columns = np.nonzero(one_sided)
    if rows.size:
        axes.plot(
            angles[0][rows], angles[1][columns], "x", color=BLACK, markersize=2, markeredgewidth=0.5
        )
