"""The settled motion of an answer: orbit, contact force, and spectrum in Hz."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.codes import Verdict, flag_words
from squealpipe.plotting import style
from squealpipe.plotting.cycles import joined
from squealpipe.plotting.origin import parameter, slip_along_belt
from squealpipe.schema import meanings
from squealpipe.systems.inputs.units import shown_in


def figure(answer: xr.Dataset) -> Figure:
    """Three panels."""
    drawn, axes = style.new_figure(style.PAGE, 2.3, ncols=3)
    draw_row(axes[0], answer)
    titles = ("settled orbit", "contact force", "velocity spectrum")
    style.panel_letters(axes[0], titles)
    return drawn


def draw_row(panels: np.ndarray, answer: xr.Dataset) -> None:
    """Orbit, force and spectrum of one answer into three panels."""
    draw_settled_orbit(panels[0], answer)
    draw_settled_force(panels[1], answer)
    draw_settled_spectrum(panels[2], answer)


def draw_settled_orbit(axes: Axes, answer: xr.Dataset) -> None:
    """The path of the mass in the colours of its regimes."""
    if _says_quiet(axes, answer):
        return
    x, y = answer.path_x.values, answer.path_y.values
    top = float(np.nanmax(np.abs([x, y])))
    factor, unit = shown_in(top, "m")
    flags, regimes = meanings(answer.path_regime), answer.path_regime.values
    if "alpha1" in answer:
        regimes = slip_along_belt(regimes, parameter(answer, "belt_speed"))
    words = {"slip_slower": "slip", "slip_faster": "faster than the belt"}
    for value in np.unique(regimes):
        name = flags[int(value)]
        if name not in style.REGIME_COLOURS:
            continue
        shown = np.where(joined(regimes == value), y, np.nan)
        axes.plot(
            factor * x,
            factor * shown,
            color=style.REGIME_COLOURS[name],
            linewidth=0.7,
            label=words.get(name, flag_words(name)),
        )
    # a structure's contacts are closed up to a displacement of their own
    limit = float(answer.preload) if "preload" in answer else np.inf
    if limit < 1.2 * float(np.nanmax(y)):
        axes.axhline(
            factor * limit, color=style.Colour.grey, linewidth=0.8, linestyle=":"
        )
    axes.set(xlabel=f"along the belt, x ({unit})", ylabel=f"away from it, y ({unit})")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(fontsize=6, loc="best", borderaxespad=0)


def draw_settled_force(axes: Axes, answer: xr.Dataset) -> None:
    """Contact force over the preload, red strips where contact is lost."""
    if _says_quiet(axes, answer):
        return
    time = answer.path_time.values
    factor, unit = shown_in(float(time[-1]), "s")
    time, force = factor * time, answer.path_force.values
    top = 1.15 * float(np.nanmax(force))
    axes.plot(time, force, color=style.Colour.blue)
    lost = meanings(answer.path_regime)
    off = [code for code, name in lost.items() if name == "separated"]
    axes.fill_between(
        time,
        -0.06 * top,
        0.0,
        where=np.isin(answer.path_regime.values, off),
        color=style.Colour.red,
        linewidth=0.8,
        step="mid",
    )
    axes.axhline(0.0, color=style.Colour.grey, linewidth=0.5)
    axes.set(
        xlim=(float(time[0]), float(time[-1])),
        ylim=(-0.065 * top, top),
        xlabel=f"time ({unit})",
        ylabel="contact force over preload",
    )


def draw_settled_spectrum(axes: Axes, answer: xr.Dataset) -> None:
    """Amplitude of both velocities over the frequency, the strongest line marked."""
    if _says_quiet(axes, answer):
        return
    strongest = float(answer.frequency)
    factor, unit = shown_in(strongest, "Hz")
    frequency = answer.line_frequency.values
    # the spectrum ends at six times the frequency of its strongest line
    shown_multiples = 6.0
    shown = frequency <= shown_multiples * strongest
    for name, colour, words in (
        ("along", style.Colour.along, "along the belt"),
        ("across", style.Colour.across, "across it"),
    ):
        values = np.maximum(answer[f"velocity_spectrum_{name}"].values[shown], 1e-300)
        axes.semilogy(factor * frequency[shown], values, color=colour, label=words)
    top = float(answer.harmonic_velocity[0])
    axes.plot(factor * strongest, top, "v", color=style.Colour.red, markersize=4)
    axes.set(
        ylim=(1e-4 * top, 5.0 * top),
        xlim=(0.0, factor * shown_multiples * strongest),
        xlabel=f"frequency ({unit})",
        ylabel="velocity (m/s)",
    )
    axes.legend(fontsize=6, loc="upper right", borderaxespad=0)


def _says_quiet(axes: Axes, answer: xr.Dataset) -> bool:
    """Write into the panel that there is no motion to draw; return whether that is so."""
    if int(answer.verdict) == Verdict.quiet:
        style.say_instead(axes, "the motion\ndies out")
        return True
    if not np.isfinite(answer.path_x.values).all():
        style.say_instead(axes, "the run ended early")
        return True
    return False
