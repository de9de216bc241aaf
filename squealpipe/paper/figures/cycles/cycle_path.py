"""One limit cycle in the plane and in time, its regimes coloured."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.cycles import draw_regimes, key_entries
from squealpipe.plotting.origin import parameter
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("cycles/limit_F3",),
    caption=(
        "The limit cycle of the scene of Fig. 3 with dashpots, at the study's friction, if there "
        "is one. (a) Path of the mass; the line is l_pre, above which contact is lost. (b) "
        "Velocity along the belt over one period; the dashed line is belt speed. Colours: the "
        "regime, slower or faster than the belt."
    ),
    alt="Left, the path of the cycle, to scale; right, its velocity; both coloured by regime.",
)
def draw(cycle: xr.Dataset) -> Figure:
    """Two panels."""
    figure, axes = style.new_figure(style.PAGE, 3.0, ncols=2)
    path, rate = axes[0]
    if not cycle.sizes["sample"]:
        for panel in (path, rate):
            style.say_instead(panel, "no cycle")
    else:
        draw_regimes(path, cycle.x_path.values, cycle.y_path.values, cycle)
        draw_regimes(rate, cycle.time.values, cycle.vx_path.values, cycle)
        height, speed = parameter(cycle, "preload"), parameter(cycle, "belt_speed")
        path.axhline(
            height,
            color=style.Colour.grey,
            lw=0.6,
            label=r"$l_\mathrm{pre}$: contact is lost above",
        )
        path.set(aspect="equal", adjustable="datalim")
        rate.axhline(
            speed, color=style.Colour.grey, lw=0.6, ls="--", label="belt speed"
        )
        handles, words = key_entries((path, rate))
        figure.legend(handles, words, loc="outside lower center", ncols=len(words))
    path.set(xlabel="x (m)", ylabel="y (m)")
    rate.set(xlabel="t (s)", ylabel="velocity along the belt (m/s)")
    style.panel_letters((path, rate), ("path", "velocity"))
    return figure
