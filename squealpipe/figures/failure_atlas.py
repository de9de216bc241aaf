"""The failure atlas: verdicts of every method on every hard scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squealpipe.figures.style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    PAGE,
    RED,
    WHITE,
    category_colours,
    new_figure,
    panel_letter,
)
from squealpipe.schema.comparison import Role, Verdict

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAPTION = (
    "Every method on every hard scene, (a) in time and (b) of frequencies and stability. A "
    "verdict is computed from the error against a reference (long double, sixty digits, or a "
    "balance of 128 harmonics), which is printed in the cell: right (✓), wrong but flagged (!), "
    "silently wrong (✗); empty: the question cannot be put. The last column but one counts silent"
    " errors, the last one right answers that were flagged, which also count against a method. "
    "Ours are in bold."
)
ALT = "Two tables of coloured verdicts, methods in rows and hard scenes in columns."

_COLOURS = [WHITE, BLUE, ORANGE, RED]
_SIGNS = {Verdict.right: "✓", Verdict.flagged: "!", Verdict.silently_wrong: "✗"}


def draw(atlas: xr.Dataset) -> Figure:
    """Both tables, from dataset ``failure_atlas``: rows that share scenes stand together."""
    asked = atlas.verdict.values > 0
    last = int(np.flatnonzero(asked[0]).max())
    in_time = np.arange(atlas.sizes["solver"]) <= last
    figure, axes = new_figure(PAGE, 6.6, nrows=2)
    for letter, panel, columns in zip("ab", axes[:, 0], (in_time, ~in_time), strict=True):
        part = atlas.isel(solver=columns)
        _draw(panel, part.isel(scene=(part.verdict.values > 0).any(axis=1)))
        panel_letter(panel, letter)
    return figure


def _draw(axes: Axes, part: xr.Dataset) -> None:
    verdict, error = part.verdict.values.T, part.error.values.T
    flagged = part.flagged.values.T > 0
    axes.imshow(verdict, aspect="auto", alpha=0.75, **category_colours(_COLOURS))
    rows, columns = verdict.shape
    for row, column in np.argwhere(verdict > 0):
        kind = Verdict(int(verdict[row, column]))
        digits = error[row, column]
        size = f"{digits:.0e}" if np.isfinite(digits) and digits > 0 else ""
        axes.text(
            column, row, f"{_SIGNS[kind]}\n{size}".rstrip(), ha="center", va="center", fontsize=6,
            color=BLACK,
        )  # fmt: skip
    totals = {
        "silently\nwrong": (verdict == Verdict.silently_wrong).sum(axis=1),
        "right but\nflagged": ((verdict == Verdict.right) & flagged).sum(axis=1),
    }
    for offset, counts in enumerate(totals.values()):
        for row, count in enumerate(counts):
            axes.text(columns + offset, row, str(count), ha="center", va="center", fontsize=7)
    axes.axvline(columns - 0.5, color=GREY, lw=0.8)
    names = [*part.scene.values.tolist(), *totals]
    axes.set_xticks(range(len(names)), names, rotation=40, ha="right", rotation_mode="anchor")
    axes.set_yticks(range(rows), part.solver.values.tolist())
    for label, role in zip(axes.get_yticklabels(), part.role.values, strict=True):
        label.set_fontweight("bold" if role != Role.public else "normal")
    axes.set_xlim(-0.5, columns + 1.5)
    axes.set_xticks(np.arange(columns + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(rows + 1) - 0.5, minor=True)
    axes.grid(visible=True, which="minor", color=WHITE, lw=1.0)
    axes.tick_params(which="both", length=0)
