"""Work–precision of integrators with events, a panel for each class of problems."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting.style import PAGE, new_figure, panel_letter
from squealpipe.schema.comparison import Role
from squealpipe.study.figures.panels.work_precision import draw_methods, foot

READS = ("benchmark",)
CAPTION = (
    "Error of the final state and of event times, over the growth of a perturbation, against "
    "evaluations of the field, which do not depend on machine or language: medians over the "
    "problems of a class that a method can be asked; no answer, or an error above 1, counts as 1. "
    "Points of a line run over the tolerance, the same for all solvers; a Taylor step of order p "
    "counts as p + 1 evaluations, a Moreau–Jean step as one. An error says "
    "nothing about missed events: those are in the failure atlas. Grey band: Pareto front; red "
    "ring: the setting that our maps use. Machine and versions are named below the panels."
)
ALT = "Small charts of error against evaluations of the field, one for each class of problems."
OUR_TOLERANCE = 1e-12
COLUMNS = 4


def draw(benchmark: xr.Dataset) -> Figure:
    """The charts, from dataset ``benchmark``."""
    known = benchmark.error.notnull().any(["solver", "tol"]).values
    groups = list(dict.fromkeys(benchmark.group.values[known].tolist()))
    rows = -(-len(groups) // COLUMNS)
    figure, axes = new_figure(
        PAGE, 1.6 * rows + 1.0, nrows=rows, ncols=COLUMNS, sharex=True
    )
    methods = benchmark.solver.values.tolist()
    for index, panel in enumerate(axes.flat):
        if index >= len(groups):
            panel.set_axis_off()
            continue
        of_group = benchmark.isel(problem=benchmark.group.values == groups[index])
        draw_methods(panel, _medians(of_group), "evaluations", 1.0, methods)
        panel_letter(panel, "abcdefghijklmnopqrstuvwxyz"[index], groups[index])
    figure.supylabel("evaluations of the field", fontsize=7)
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


def _medians(benchmark: xr.Dataset) -> xr.Dataset:
    """Medians over problems, a run for each solver and tolerance."""
    fine = benchmark[["error", "evaluations"]].where(benchmark.error.notnull())
    fine["error"] = fine.error.clip(max=1.0)  # above, an answer says nothing
    found = fine.median("problem").stack(run=("solver", "tol"))
    ours = (found.solver == "squealpipe") & (found.tol == OUR_TOLERANCE)
    role = np.where(ours, Role.our_setting, Role.public)
    plain = found.drop_vars(["run", "solver", "tol"])
    return plain.assign(method=("run", found.solver.values), role=("run", role))
