"""The failure atlas: verdicts of every method on every hard scene."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.schema.comparison import Reliability, Role
from squealpipe.text import number

READS = ("benchmark", "failure_atlas")
CAPTION = (
    "(a) Integrators on problems with events: each cell is divided by "
    "tolerance, the loosest on the left; numbers count missed (−) and spurious (+) events at their "
    "worst; empty: not asked. Chattering and the run beyond the horizon have no answer: a flag is "
    "right there. (b) Methods for frequencies and stability on hard scenes: verdict "
    "and error against a reference of sixty digits or 128 harmonics. The last columns count silent "
    "errors. Ours are in bold."
)
ALT = "Two tables of coloured verdicts, methods in rows and problems in columns."

_COLOURS = [style.WHITE, (style.BLUE, 0.25), style.ORANGE, style.RED]
"""The worse, the darker: greyscale tells them apart."""
_SIGNS = {
    Reliability.right: "✓ right",
    Reliability.flagged: "! wrong, but said so",
    Reliability.silently_wrong: "✗ silently wrong",
}
"""Each verdict's sign, and what it means."""
_ROW, _HEADS = 0.2, 1.2
"""Heights of a row, and of the names of the columns, inches."""


def draw(benchmark: xr.Dataset, atlas: xr.Dataset) -> Figure:
    """Both tables, from datasets ``benchmark`` and ``failure_atlas``."""
    heights = [_ROW * each.sizes["solver"] + _HEADS for each in (benchmark, atlas)]
    figure, axes = style.new_figure(
        style.PAGE, sum(heights) + 0.3, nrows=2, height_ratios=heights
    )
    _draw_benchmark(axes[0, 0], benchmark.transpose("solver", "problem", "tol"))
    _draw_atlas(axes[1, 0], atlas.transpose("solver", "scene"))
    style.panel_letter(axes[0, 0], "a", "integrators with events")
    style.panel_letter(axes[1, 0], "b", "frequencies and stability")
    tones = ((_COLOURS[verdict], words) for verdict, words in _SIGNS.items())
    keys = style.patches(tones, edgecolor="none")
    figure.legend(handles=keys, loc="outside upper right", ncols=3)
    return figure


def _draw_benchmark(axes: Axes, found: xr.Dataset) -> None:
    rows, columns, parts = found.verdict.shape
    strips = found.verdict.values.reshape(rows, columns * parts)
    _paint(axes, strips, columns)
    wrong = found.verdict > Reliability.right
    for name, sign, shift in (("missed", "−", -0.22), ("spurious", "+", 0.22)):
        worst = found[name].where(wrong, 0).max("tol").values
        for row, column in np.argwhere(worst > 0):
            axes.text(
                column,
                row + shift,
                f"{sign}{worst[row, column]}",
                ha="center",
                va="center",
                fontsize=5,
                color=style.BLACK,
            )
    silent = (
        (found.verdict == Reliability.silently_wrong).sum(["problem", "tol"]).values
    )
    _label(axes, found, found.problem.values.tolist(), silent)


def _draw_atlas(axes: Axes, found: xr.Dataset) -> None:
    verdict, error = found.verdict.values, found.error.values
    _paint(axes, verdict, verdict.shape[1])
    for row, column in np.argwhere(verdict > 0):
        words = [_SIGNS[Reliability(int(verdict[row, column]))][0]]
        if 0 < error[row, column] < np.inf:
            words.append(number(error[row, column], 1))
        text = "\N{THIN SPACE}".join(words)
        axes.text(
            column, row, text, ha="center", va="center", fontsize=5, color=style.BLACK
        )
    silent = (verdict == Reliability.silently_wrong).sum(axis=1)
    _label(axes, found, found.scene.values.tolist(), silent)


def _paint(axes: Axes, verdict: np.ndarray, columns: int) -> None:
    axes.imshow(
        verdict,
        aspect="auto",
        extent=(-0.5, columns - 0.5, len(verdict) - 0.5, -0.5),
        interpolation="nearest",
        **style.category_colours(_COLOURS),
    )


def _label(axes: Axes, found: xr.Dataset, names: list[str], silent: np.ndarray) -> None:
    columns, rows = len(names), len(silent)
    for row, count in enumerate(silent):
        axes.text(columns, row, str(count), ha="center", va="center", fontsize=6)
    axes.axvline(columns - 0.5, color=style.GREY, lw=0.8)
    texts = [*map(style.symbols, names), "silently wrong"]
    axes.set_xticks(
        range(columns + 1),
        texts,
        rotation=40,
        ha="right",
        rotation_mode="anchor",
        fontsize=5.5,
    )
    axes.set_yticks(
        range(rows), [style.symbols(each) for each in found.solver.values.tolist()]
    )
    for label, role in zip(axes.get_yticklabels(), found.role.values, strict=True):
        label.set_fontweight("bold" if role != Role.public else "normal")
    axes.set_xlim(-0.5, columns + 0.5)
    axes.set_xticks(np.arange(columns + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(rows + 1) - 0.5, minor=True)
    axes.grid(visible=True, which="minor", color=style.WHITE, lw=1.0)
    axes.tick_params(which="both", length=0)
