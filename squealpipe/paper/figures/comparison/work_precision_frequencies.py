"""Work–precision of harmonic balance against exact orbits."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.benchmark.schema import Reliability
from squealpipe.plotting.style import PAGE, new_figure
from squealpipe.plotting.work_precision import draw_methods, foot
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("work_precision_frequencies",),
    caption=(
        "Harmonic balance on model A4: median error of ω at equal peak of y against exact orbits, "
        "over the wall time of a point; points of a line run over N_h or σ. The exact orbit itself "
        "is shown with the velocity left after half a period. Crossed out: off by more than 1 %, "
        "which no setting mends. Grey band: Pareto front of the others; red rings: our settings. "
        "Machine and versions are named below."
    ),
    alt="Chart of frequency error against time for forms of harmonic balance.",
)
def draw(frequencies: xr.Dataset) -> Figure:
    """The chart, from dataset ``work_precision_frequencies``."""
    figure, axes = new_figure(PAGE, 3.4)
    methods = list(dict.fromkeys(frequencies.method.values.tolist()))
    panel = axes[0, 0]
    # a frequency off by more than 1 % belongs to another motion
    wrong = frequencies.error > 0.01
    worth = wrong * (Reliability.silently_wrong - Reliability.right) + Reliability.right
    draw_methods(panel, frequencies.assign(worth=worth), "wall_time", 1e3, methods)
    panel.set(xlabel="error of ω, relative", ylabel="wall time per point (ms)")
    if panel.get_legend_handles_labels()[0]:
        figure.legend(loc="outside right center", fontsize=6.5)
    foot(figure, frequencies)
    return figure
