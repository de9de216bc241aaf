"""The failure atlas: verdicts of every method on every hard scene."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.benchmark.schema import Reliability
from squealpipe.plotting import style
from squealpipe.plotting.work_precision import rule_table
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.words import number

_COLOURS = [
    style.Colour.white,
    (style.Colour.blue, 0.25),
    style.Colour.orange,
    style.Colour.red,
]
"""The worse, the darker: greyscale tells them apart."""
_VERDICT_SIGNS = {
    Reliability.right: "✓ right",
    Reliability.flagged: "! wrong, but said so",
    Reliability.silently_wrong: "✗ silently wrong",
}
"""Each verdict's sign, and what it means."""
_SMALL: dict[str, Any] = {"fontsize": 5, "color": style.Colour.black}


@report_figure(
    reads=("benchmark", "failure_atlas"),
    caption=(
        "(a) Integrators on problems with events: each cell is divided by "
        "tolerance, the loosest on the left; numbers count missed (−) and spurious (+) events at "
        "their worst; empty: not asked. Chattering and the run beyond the horizon have no answer: "
        "a flag is right there. (b) Methods for frequencies and stability on hard scenes: verdict "
        "and error against a reference of sixty digits or 128 harmonics. The last columns count "
        "silent errors. Ours are in bold."
    ),
    alt="Two tables of coloured verdicts, methods in rows and problems in columns.",
)
def draw(benchmark: xr.Dataset, atlas: xr.Dataset) -> Figure:
    """Both tables, from datasets ``benchmark`` and ``failure_atlas``."""
    # inches: 0.2 for each row, 1.2 for the slanted names of the columns
    heights = [0.2 * each.sizes["solver"] + 1.2 for each in (benchmark, atlas)]
    figure, axes = style.new_figure(
        style.PAGE, sum(heights) + 0.3, nrows=2, height_ratios=heights
    )
    _draw_benchmark(axes[0, 0], benchmark.transpose("solver", "problem", "tol"))
    _draw_atlas(axes[1, 0], atlas.transpose("solver", "scene"))
    titles = ("integrators with events", "frequencies and stability")
    style.panel_letters(axes.flat, titles)
    tones = ((_COLOURS[verdict], words) for verdict, words in _VERDICT_SIGNS.items())
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
            events = f"{sign}{worst[row, column]}"
            style.write(axes, column, row + shift, events, **_SMALL)
    silent = (
        (found.verdict == Reliability.silently_wrong).sum(["problem", "tol"]).values
    )
    _label(axes, found, found.problem.values.tolist(), silent)


def _draw_atlas(axes: Axes, found: xr.Dataset) -> None:
    verdict, error = found.verdict.values, found.error.values
    _paint(axes, verdict, verdict.shape[1])
    for row, column in np.argwhere(verdict > 0):
        words = [_VERDICT_SIGNS[Reliability(int(verdict[row, column]))][0]]
        if 0 < error[row, column] < np.inf:
            words.append(number(error[row, column], 1))
        text = "\N{THIN SPACE}".join(words)
        style.write(axes, column, row, text, **_SMALL)
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
    columns = len(names)
    for row, count in enumerate(silent):
        style.write(axes, columns, row, str(count), fontsize=6)
    axes.axvline(columns - 0.5, color=style.Colour.grey, lw=0.8)
    texts = [*map(style.symbols, names), "silently wrong"]
    axes.set_xticks(
        range(columns + 1),
        texts,
        rotation=40,
        ha="right",
        rotation_mode="anchor",
        fontsize=5.5,
    )
    axes.set_xlim(-0.5, columns + 0.5)
    rule_table(axes, found, columns, color=style.Colour.white, lw=1.0)
