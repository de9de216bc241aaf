"""Work–precision of integrators with events.

Each class of problems has two panels: evaluations of the field, and CPU time, against the error.
"""

import json

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.benchmark.schema import Role
from squealpipe.plotting.style import PAGE, new_figure, panel_letter
from squealpipe.plotting.work_precision import draw_methods, foot
from squealpipe.study.figures.declared import report_figure

COST_NAMES = {"evaluations": "evaluations", "cpu_ratio": "CPU time"}


def caption(benchmark: xr.Dataset) -> str:
    """Describe what is shown, where each solver ran, and which were left out."""
    missing = left_out(benchmark)
    shown = (
        "Error of the final state and of event times, over the growth of a perturbation, against "
        "two costs: evaluations of the field, which do not depend on machine or language, and CPU "
        "time over that of DOP853 at a tolerance of 10⁻⁸. Medians over the problems of a class "
        "that a method can be asked; no answer, or an error above 1, counts as 1. Points of a line "
        "run over the tolerance, the same for all solvers; a Taylor step of order p counts as p + "
        "1 evaluations, a Moreau–Jean step as one. Filled: right on every problem of the class; "
        "hollow: not on all, and said so; crossed out: silently wrong on at least one, by its "
        "events or its error. Grey band: Pareto front of the filled points; red ring: the setting "
        "that our maps use. Machine and versions are named below the panels."
    )
    return (
        f"{shown} {where_solvers_ran(benchmark)} Not installed and left out: "
        f"{', '.join(missing) or 'none'}."
    )


def where_solvers_ran(benchmark: xr.Dataset) -> str:
    """Say which answers are shipped, with packages and processors, and where the others ran."""
    if "shipped" not in benchmark or not (benchmark.shipped == 1).any():
        return "All solvers ran with this study."
    stored = benchmark.isel(solver=(benchmark.shipped == 1).values)
    places = [
        f"on {processor} ({', '.join(dict.fromkeys(each.package.values.tolist()))})"
        for processor, each in stored.groupby("processor")
    ]
    ran = benchmark.solver.values[benchmark.shipped.values == 0].tolist()
    here = (
        f"; {', '.join(ran)} ran with this study, on {benchmark.attrs['processor']}"
        if ran
        else ""
    )
    return (
        "Answers of the others are shipped with the package and were computed "
        f"{' and '.join(places)}{here}."
    )


def left_out(benchmark: xr.Dataset) -> list[str]:
    """Names of the solvers that the configuration asks for and that were not installed."""
    config = json.loads(benchmark.attrs.get("config", "{}"))
    asked = config.get("comparison.benchmark", {}).get("solvers", [])
    return [name for name in asked if name not in benchmark.solver]


def knowable(benchmark: xr.Dataset) -> xr.DataArray:
    """Tell for each problem whether the error of any answer to it is known, (problems,)."""
    known: xr.DataArray = benchmark.error.notnull().any(["solver", "tol"])
    return known


@report_figure(
    reads=("benchmark",),
    caption=caption,
    alt="Small charts of error against evaluations and CPU time, two for each class of problems.",
)
def draw(benchmark: xr.Dataset) -> Figure:
    """Draw evaluations and CPU time against the error, for each class of problems."""
    known = benchmark.isel(problem=knowable(benchmark).values)
    groups = list(dict.fromkeys(known.group.values.tolist()))
    classes_in_a_row = 2
    rows, width = -(-len(groups) // classes_in_a_row), len(COST_NAMES)
    figure, axes = new_figure(
        PAGE, 1.4 * rows + 1.2, nrows=rows, ncols=classes_in_a_row * width, sharex=True
    )
    methods = benchmark.solver.values.tolist()
    panels = axes.reshape(-1, width)
    for letter, pair, group in zip(
        "abcdefghijklmnopqrstuvwxyz", panels, groups, strict=False
    ):
        runs = medians(known.isel(problem=known.group.values == group))
        for panel, cost in zip(pair, COST_NAMES, strict=True):
            draw_methods(panel, runs, cost, 1.0, methods)
            panel.set_ylabel(COST_NAMES[cost], fontsize=6, labelpad=1)
            panel.tick_params(labelsize=6)
        panel_letter(pair[0], letter, group)
    for pair in panels[len(groups) :]:
        for panel in pair:
            panel.set_axis_off()
    for panel in axes[-1]:
        panel.set_xlabel("error over growth")
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(),
        loc="outside upper center",
        ncols=5,
        fontsize=6.5,
    )
    foot(figure, benchmark)
    return figure


def medians(benchmark: xr.Dataset) -> xr.Dataset:
    """Return medians of error and costs over the problems, and the worst verdict.

    The dataset returned is over ``run``, one for each pair of solver and tolerance.
    """
    asked = benchmark[["error", *COST_NAMES]].where(benchmark.error.notnull())
    asked["error"] = asked.error.clip(max=1.0)  # above, an answer says nothing
    runs = asked.median("problem")
    runs["worth"] = benchmark.verdict.max("problem")
    runs = runs.stack(run=("solver", "tol"))
    # the ring marks the tolerance of the package's maps
    ours = (runs.solver == "squealpipe") & (runs.tol == 1e-12)
    role = np.where(ours, Role.our_setting, Role.public)
    plain = runs.drop_vars(["run", "solver", "tol"])
    return plain.assign(method=("run", runs.solver.values), role=("run", role))
