"""Speed against accuracy at a glance: hard scenes of A1, asked of every integrator."""

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.paper.figures.comparison.work_precision_benchmark import (
    COST_NAMES,
    knowable,
    medians,
    where_solvers_ran,
)
from squealpipe.plotting.style import PAGE, new_figure, panel_letter
from squealpipe.plotting.work_precision import METHOD_MARKS, SMALLEST, draw_methods
from squealpipe.study.figures.declared import report_figure


def scenes_of_a1(benchmark: xr.Dataset) -> xr.Dataset:
    """The problems of model A1 that have an answer: every method can be asked all of them."""
    of_a1 = benchmark.problem.str.startswith("A1: ") & knowable(benchmark)
    chosen: xr.Dataset = benchmark.isel(problem=of_a1.values)
    return chosen


def caption(benchmark: xr.Dataset) -> str:
    """Describe the charts, and count the scenes behind them."""
    return (
        f"Median error and cost over {scenes_of_a1(benchmark).sizes['problem']} hard scenes of "
        "A1, the same for all integrators; left and low is better. A line runs from a tolerance "
        "of 10⁻⁶ to 10⁻¹²; thin upright lines: from the cheapest scene to the dearest. Ours and "
        "heyoka compile the equations, ours with the growth of a perturbation; the others call a "
        "field in interpreted Python, DOP853 also a compiled one. SciPy bounds no step by default; "
        "bounded: 1 % of the run. Filled: right in all scenes; hollow: not in all, and said so; "
        "crossed out: silently wrong in one or more, so no bargain at any price. Grey band: the "
        "filled points that no other beats; red ring: the setting of our maps. "
        f"{where_solvers_ran(benchmark)}"
    )


@report_figure(
    reads=("benchmark",),
    caption=caption,
    alt="Two charts, CPU time and evaluations of every integrator against its error.",
)
def draw(benchmark: xr.Dataset) -> Figure:
    """One panel for each cost, from dataset ``benchmark``."""
    figure, axes = new_figure(PAGE, 3.8, ncols=2, sharex=True)
    scenes = scenes_of_a1(benchmark)
    runs = medians(scenes)
    methods = benchmark.solver.values.tolist()
    titles = {"cpu_ratio": "CPU time", "evaluations": "evaluations of the field"}
    labels = {
        "cpu_ratio": "CPU time over that of DOP853 at 10⁻⁸",
        "evaluations": "calls",
    }
    for panel, letter, cost in zip(axes[0], "ab", sorted(COST_NAMES), strict=True):
        draw_methods(panel, runs, cost, 1.0, methods)
        _draw_spread(panel, scenes, runs, cost)
        panel.set(xlabel="median error over growth", ylabel=labels[cost])
        panel_letter(panel, letter, titles[cost])
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(),
        loc="outside lower center",
        ncols=4,
        fontsize=7,
    )
    return figure


def _draw_spread(axes: Axes, scenes: xr.Dataset, runs: xr.Dataset, cost: str) -> None:
    """Draw from the cheapest to the dearest scene, one thin line for each solver and tolerance."""
    costs = scenes[cost].where(scenes.error.notnull()).stack(run=("solver", "tol"))
    low, high = costs.min("problem").values, costs.max("problem").values
    methods = scenes.solver.values.tolist()
    for i, name in enumerate(runs.method.values.tolist()):
        colour, _, dash = METHOD_MARKS[methods.index(name) % len(METHOD_MARKS)]
        error = max(float(runs.error[i]), SMALLEST)
        look = {"color": colour, "ls": dash, "lw": 0.5, "alpha": 0.5, "zorder": 1}
        axes.plot([error, error], [low[i], high[i]], **look)
