"""Cycles of the impact oscillator over the frequency of its forcing."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.cycles import key_entries, trace_branch
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("impact_branch",),
    caption=(
        "A system beside the brake: cycles of a forced linear oscillator that hits a stop at x = 1 "
        "m, of one forcing period, as one branch over the forcing's frequency: how far each goes "
        "away from the stop. Full blue lines: stable; dashed orange: unstable; marks: located "
        "special points. At a grazing the cycle touches the stop with no speed, so it hits it on "
        "one side only."
    ),
    alt="A chart of the largest distance from the stop over frequency: one line in two looks.",
)
def draw(branch: xr.Dataset) -> Figure:
    """One panel."""
    figure, axes = style.new_figure(style.COLUMN, 3.0)
    panel = axes[0, 0]
    trace_branch(panel, branch.omega.values, -branch.x_min.values, branch)
    panel.set(xlabel="ω (rad/s)", ylabel="−min x (m)", ylim=(0, None))
    figure.legend(*key_entries([panel]), loc="outside lower center", ncols=3)
    return figure
