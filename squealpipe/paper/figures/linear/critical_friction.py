"""Maps of the critical friction: over both angles, its change by dashpots, over both dashpots."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.origin import angle_pair, parameter
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.words import number

LARGEST_SHOWN = 1.5
"""Upper end of the colours of (a)."""


def caption(angles: xr.Dataset, dashpots: xr.Dataset) -> str:
    """Describe the maps, with their dashpots and angles."""
    c1, c2 = (number(parameter(angles, f"damping{i}")) for i in (1, 2))
    return (
        "Friction coefficient of Coulomb's law at which steady sliding on a linear contact spring "
        "turns unstable by A3 (Routh–Hurwitz). (a) Over both spring angles without dashpots. "
        f"(b) Its change by dashpots c₁ = {c1} and c₂ = {c2} N s/m: red, they lower it "
        "and make sliding unstable sooner; blue, they raise it; grey, it is above "
        f"{LARGEST_SHOWN:g} with them and without. (c) Over both dashpots at "
        f"{angle_pair(dashpots.alpha1, dashpots.alpha2)}, "
        "on a scale of its own; black line: as without dashpots."
    )


@report_figure(
    reads=("critical_friction_map", "critical_damping_map"),
    caption=caption,
    alt="Two maps over both spring angles and one over both dashpots, of the critical friction.",
)
def draw(angles: xr.Dataset, dashpots: xr.Dataset) -> Figure:
    """Draw the three maps side by side."""
    figure, axes = style.new_figure(style.PAGE, 3.1, ncols=3)
    without, change, plane = axes[0]
    undamped, damped = angles.critical_mu_undamped.values, angles.critical_mu.values
    mesh = style.draw_map(
        without,
        angles,
        np.minimum(undamped, 2 * LARGEST_SHOWN),
        cmap="viridis",
        vmin=0.0,
        vmax=LARGEST_SHOWN,
    )
    figure.colorbar(
        mesh, ax=without, label="critical μ", extend="max", location="bottom"
    )
    shown = np.fmin(undamped, damped) < LARGEST_SHOWN
    moved = np.minimum(damped, LARGEST_SHOWN) - np.minimum(undamped, LARGEST_SHOWN)
    limit = float(np.percentile(abs(moved[shown]), 95)) if shown.any() else 0.0
    change.set_facecolor(style.Colour.light)
    mesh = style.draw_map(
        change,
        angles,
        np.where(shown, moved, np.nan),
        cmap="RdBu",
        vmin=-limit or -1.0,
        vmax=limit or 1.0,
    )
    change.set_ylabel("")
    figure.colorbar(
        mesh, ax=change, label="change of critical μ", extend="both", location="bottom"
    )
    plane.set(xlabel="dashpot c₁ (N s/m)", ylabel="dashpot c₂ (N s/m)", box_aspect=1)
    _draw_plane(figure, plane, dashpots)
    style.panel_letters(axes[0], ("no dashpots", "change", "over dashpots"))
    return figure


def _draw_plane(figure: Figure, plane: Axes, dashpots: xr.Dataset) -> None:
    """Draw the critical friction over both dashpots, or write that it is too high or constant."""
    c1, c2 = dashpots.damping1.values, dashpots.damping2.values
    values = dashpots.critical_mu.values
    # no brake has a friction coefficient of 10; beyond it round-off decides the digits
    unreached = 10.0
    reached = values[values < unreached]
    if not reached.size:
        style.say_instead(plane, f"above {unreached:g}\neverywhere")
        return
    low, high = np.percentile(reached, [0, 98])
    # round-off alone makes them differ by less
    if reached.max() - low < 1e-9 * high:
        style.say_instead(plane, f"{number(high)}\nwith any dashpots")
        return
    mesh = plane.pcolormesh(
        c1,
        c2,
        np.minimum(values, 10 * high).T,
        shading="nearest",
        rasterized=True,
        cmap="viridis",
        vmin=low,
        vmax=high,
    )
    level = float(dashpots.critical_mu_undamped)
    if values.min() < level < values.max():
        plane.contour(
            c1,
            c2,
            values.T,
            levels=[level],
            colors=[style.Colour.black],
            linewidths=1.0,
        )
    figure.colorbar(mesh, ax=plane, label="critical μ", extend="max", location="bottom")
