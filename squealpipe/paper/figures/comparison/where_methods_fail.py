"""Failures at a glance: how often each integrator is silently wrong, by class of problem."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.benchmark.schema import Reliability
from squealpipe.paper.figures.comparison.work_precision_benchmark import knowable
from squealpipe.plotting import style
from squealpipe.plotting.work_precision import rule_table
from squealpipe.study.figures.declared import report_figure


def answers(benchmark: xr.Dataset) -> xr.Dataset:
    """``asked``, ``right`` and ``silent``: numbers of answers over class and solver."""
    known = benchmark.isel(problem=knowable(benchmark).values)
    counts = {
        "asked": known.verdict != Reliability.not_applicable,
        "right": known.verdict == Reliability.right,
        "silent": known.verdict == Reliability.silently_wrong,
    }
    table = xr.Dataset(counts).sum("tol").groupby(known.group).sum()
    order = list(dict.fromkeys(known.group.values.tolist()))
    summed: xr.Dataset = table.sel(group=order)
    return summed


def substitutes(benchmark: xr.Dataset) -> list[str]:
    """Return the methods that smooth or step over events in place of locating them."""
    return [
        name
        for name in benchmark.solver.values.tolist()
        if name.startswith("tanh") or name == "Moreau–Jean"
    ]


@report_figure(
    reads=("benchmark",),
    caption=(
        "How often an integrator is silently wrong: wrong answers that nothing was said of, over "
        "all answers at tolerances from 10⁻⁶ to 10⁻¹², by what makes a problem hard. White: all "
        "right; bluish: some wrong or without an answer, and said so; the darker the red, the "
        "more are silently wrong; a dash: cannot be asked. Problems without "
        "an answer are left out. Ours is in bold."
    ),
    alt=(
        "A table of integrators in rows and classes of problems in columns; red cells are failures."
    ),
)
def draw(benchmark: xr.Dataset) -> Figure:
    """The table, from dataset ``benchmark``."""
    table = answers(benchmark).transpose("solver", "group")
    asked, right, silent = (table[n].values for n in ("asked", "right", "silent"))
    share = silent / np.maximum(asked, 1)
    colours = np.ones((*asked.shape, 3))
    light_blue = np.array([0.86, 0.93, 0.97])
    colours[(right < asked) & (silent == 0)] = light_blue
    # strength of the red where a single answer is silently wrong: weaker is not seen
    faintest = 0.25
    strength = (faintest + (1.0 - faintest) * share)[..., None]
    red = silent > 0
    vermilion = np.array([213, 94, 0]) / 255
    colours[red] = (1.0 - strength[red]) + strength[red] * vermilion
    rows, columns = asked.shape
    figure, axes = style.new_figure(style.PAGE, 0.21 * rows + 1.1)
    panel = axes[0, 0]
    panel.imshow(colours, aspect="auto", interpolation="nearest")
    for row, column in np.ndindex(rows, columns):
        number = f"{silent[row, column]}/{asked[row, column]}"
        words = number if silent[row, column] else "" if asked[row, column] else "–"
        style.write(panel, column, row, words, fontsize=6.5)
    panel.set_xticks(
        range(columns),
        table.group.values.tolist(),
        rotation=30,
        ha="left",
        rotation_mode="anchor",
    )
    panel.xaxis.tick_top()
    rule_table(panel, benchmark, columns, color=style.Colour.light, lw=0.6)
    return figure
