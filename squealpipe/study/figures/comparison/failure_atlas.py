"""The failure atlas: verdicts of every method on every hard scene."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from squealpipe.plotting import style
from squealpipe.schema.comparison import Reliability, Role
from squealpipe.text import number

READS = ("failure_atlas",)
CAPTION = (
    "The failure atlas: every method on every hard scene, (a) in time and (b) of frequencies and "
    "stability. Tolerances stand after the names of the methods that take one; our maps use 10⁻¹². "
    "A cell gives the verdict on the error against a reference (long double, sixty digits, or a "
    "balance of 128 harmonics), that error, and in brackets the contact changes that the method "
    "missed; empty: not asked. The last columns count silent errors, right answers that were "
    "flagged, and missed contact changes. Ours are in bold."
)
ALT = "Two tables of coloured verdicts, methods in rows and hard scenes in columns."

_COLOURS = [style.WHITE, style.BLUE, style.ORANGE, style.RED]
_SIGNS = {Reliability.right: "✓", Reliability.flagged: "!", Reliability.silently_wrong: "✗"}
_WORDS = {
    Reliability.right: "right",
    Reliability.flagged: "wrong, but said so",
    Reliability.silently_wrong: "silently wrong",
}
_LONG = 11
"""Characters from which the text of a cell is set smaller."""
_ROW = 0.2
"""Height of a row, inches."""
_HEADS = 1.0
"""Height for the names of the scenes, inches."""


def draw(atlas: xr.Dataset) -> Figure:
    """Both tables, from dataset ``failure_atlas``: rows that share scenes stand together."""
    asked = atlas.verdict.values > 0
    last = int(np.flatnonzero(asked[0]).max())
    in_time = np.arange(atlas.sizes["solver"]) <= last
    heights = [_ROW * np.count_nonzero(rows) + _HEADS for rows in (in_time, ~in_time)]
    figure, axes = style.new_figure(style.PAGE, sum(heights) + 0.3, nrows=2, height_ratios=heights)
    titles = ("motion in time", "frequencies and stability")
    for panel, letter, title, rows in zip(
        axes[:, 0], "ab", titles, (in_time, ~in_time), strict=True
    ):
        part = atlas.isel(solver=rows)
        _draw(panel, part.isel(scene=(part.verdict.values > 0).any(axis=1)))
        style.panel_letter(panel, letter, title)
    keys = [
        Patch(facecolor=_COLOURS[verdict], alpha=0.75, label=f"{sign} {_WORDS[verdict]}")
        for verdict, sign in _SIGNS.items()
    ]
    figure.legend(handles=keys, loc="outside upper right", ncols=3)
    return figure


def _draw(axes: Axes, part: xr.Dataset) -> None:
    verdict, error = part.verdict.values.T, part.error.values.T
    flagged = part.flagged.values.T > 0
    missed = part.missed_events.values.T
    axes.imshow(verdict, aspect="auto", alpha=0.75, **style.category_colours(_COLOURS))
    rows, columns = verdict.shape
    for row, column in np.argwhere(verdict > 0):
        words = [_SIGNS[Reliability(int(verdict[row, column]))]]
        if 0 < error[row, column] < np.inf:
            words.append(number(error[row, column], 1))
        if missed[row, column] > 0:
            words.append(f"({missed[row, column]:.0f})")
        text = "\N{THIN SPACE}".join(words)
        size = 5 if len(text) < _LONG else 4.4
        axes.text(column, row, text, ha="center", va="center", fontsize=size, color=style.BLACK)
    totals = {
        "silently\nwrong": (verdict == Reliability.silently_wrong).sum(axis=1),
        "right but\nflagged": ((verdict == Reliability.right) & flagged).sum(axis=1),
        "contact\nmissed": np.nansum(missed, axis=1).astype(int),
    }
    for offset, counts in enumerate(totals.values()):
        for row, count in enumerate(counts):
            axes.text(columns + offset, row, str(count), ha="center", va="center", fontsize=7)
    axes.axvline(columns - 0.5, color=style.GREY, lw=0.8)
    names = [*map(style.symbols, part.scene.values.tolist()), *totals]
    axes.set_xticks(range(len(names)), names, rotation=40, ha="right", rotation_mode="anchor")
    axes.set_yticks(range(rows), list(map(style.symbols, part.solver.values.tolist())))
    for label, role in zip(axes.get_yticklabels(), part.role.values, strict=True):
        label.set_fontweight("bold" if role != Role.public else "normal")
    axes.set_xlim(-0.5, columns + len(totals) - 0.5)
    axes.set_xticks(np.arange(columns + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(rows + 1) - 0.5, minor=True)
    axes.grid(visible=True, which="minor", color=style.WHITE, lw=1.0)
    axes.tick_params(which="both", length=0)
