"""One run: contact force, displacements, orbit and spectrum."""

from dataclasses import dataclass
from functools import partial

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.brake.schema.dynamics.intervals import intervals
from squealpipe.codes import Regime
from squealpipe.plotting import style
from squealpipe.plotting.mechanism import SPRING_COLOURS, displaced_springs
from squealpipe.plotting.quantities import label
from squealpipe.schema import meanings
from squealpipe.vibration.spectrum import (
    FEWEST,
    amplitude_spectrum,
    highest_peaks,
    lasts,
    strongest_lines,
)

Window = tuple[float, float]
"""First and last instant that are shown, s."""

FORCE_LABEL = r"$N\,/\,(k_3\,l_\mathrm{pre})$"


@dataclass(frozen=True)
class RunPictures:
    """Choices in the pictures of a run."""

    spectrum_padding: int = 8
    """Frequencies computed for each that the run resolves: smooth peaks, and no cost that is
    felt."""
    last_periods_shown: int = 12
    """Periods at the end of a long run that get panels of their own."""


def figure(run: xr.Dataset) -> Figure:
    """Four panels of one run; of a long one six, two of which show its last periods."""
    end = last_periods(run)
    panels = [
        (draw_force, "contact force"),
        (draw_displacements, "displacements"),
        (draw_orbit, "path of the mass"),
        (draw_spectrum, "spectrum of the contact force"),
    ]
    if end is not None:
        last = f"last {RunPictures.last_periods_shown} periods"
        panels[1:1] = [(partial(draw_force, window=end), f"contact force, {last}")]
        panels[3:3] = [(partial(draw_displacements, window=end), last)]
    rows = len(panels) // 2
    drawn, axes = style.new_figure(style.PAGE, 2.4 * rows, nrows=rows, ncols=2)
    for panel, (draw, _) in zip(axes.flat, panels, strict=False):
        draw(panel, run)
    style.panel_letters(axes.flat, [title for _, title in panels])
    drawn.suptitle(
        ", ".join(
            style.angle_in_words(name, float(run[name])) for name in style.ANGLE_NAMES
        )
        + f", model {run.attrs.get('model', 'A1')}",
        fontsize=9,
    )
    return drawn


def last_periods(run: xr.Dataset) -> Window | None:
    """Return start and end (s) of the last periods of a long run, or None for a short one.

    A period is that of the strongest line of y in the second half of the run.
    """
    reached = np.flatnonzero(np.isfinite(run.x.values))
    late = reached[reached.size // 2 :]
    if late.size < FEWEST:
        return None
    time, y = run.time.values[late], run.y.values[late]
    steps = np.diff(time)
    if not _uniform(steps):
        return None
    omega, _ = highest_peaks(
        *amplitude_spectrum(y, float(steps[0]), padding=RunPictures.spectrum_padding), 1
    )
    length = (
        RunPictures.last_periods_shown * 2.0 * np.pi / omega[0]
        if omega.size
        else np.inf
    )
    end = float(time[-1])
    # a run only a little longer than its end needs no second panel
    return (end - length, end) if 3.0 * length < end else None


def _uniform(steps: np.ndarray) -> bool:
    # a spectrum needs equal steps; 1e-6 is far above the round-off of stored times
    return bool(np.ptp(steps) <= 1e-6 * steps[0])


def draw_force(axes: Axes, run: xr.Dataset, window: Window | None = None) -> None:
    """Contact force over its preload, with strips below zero where contact is lost.

    The strips are from event to event, and none is narrower than a pixel: the shortest loss of
    contact is seen in the longest run.

    Args:
        window: first and last instant that are shown, s; by default all.
    """
    if _too_short(axes, run):
        return
    shown = _shown(run, window)
    time, force = shown.time.values, shown.normalized_contact_force.values
    top = max(1.3, 1.1 * float(np.nanmax(force)))
    axes.plot(time, force, color=style.Colour.blue)
    apart = np.clip(intervals(run, Regime.separated), time[0], time[-1])
    apart = apart[apart[:, 1] > apart[:, 0]]
    # points: one pixel at 90 dots per inch, so that dense oscillations stay apart
    axes.broken_barh(
        list(zip(apart[:, 0], np.diff(apart)[:, 0], strict=True)),
        (-0.05 * top, 0.05 * top),
        color=style.Colour.red,
        linewidth=0.8,
        antialiased=False,
        label="separated",
    )
    axes.axhline(0.0, color=style.Colour.grey, linewidth=0.5)
    limits = (float(time[0]), float(time[-1])) if window is None else window
    axes.set(xlim=limits, ylim=(-0.065 * top, top))
    axes.set(xlabel="t (s)", ylabel=FORCE_LABEL)


def draw_displacements(
    axes: Axes, run: xr.Dataset, window: Window | None = None
) -> None:
    """Both displacements over time, or within a window of it, s."""
    if _too_short(axes, run):
        return
    shown = _shown(run, window)
    axes.plot(shown.time, shown.x, color=style.Colour.along, label="x")
    axes.plot(shown.time, shown.y, color=style.Colour.across, linestyle="--", label="y")
    style.preload_line(axes, float(run.preload))
    limits = (0.0, float(run.time_reached)) if window is None else window
    axes.set(xlabel="t (s)", ylabel="displacement (m)", xlim=limits)
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0, ncols=2)


def _shown(run: xr.Dataset, window: Window | None) -> xr.Dataset:
    return run if window is None else run.sel(time=slice(*window))


def draw_orbit(axes: Axes, run: xr.Dataset) -> None:
    """The path of the mass, with the springs at its end unless they dwarf it."""
    if _too_short(axes, run):
        return
    axes.plot(run.x, run.y, color=style.Colour.grey, linewidth=0.6)
    path = np.stack([run.x.values, run.y.values])
    path = path[:, np.isfinite(path[0])]
    x, y = path[:, -1]
    lengths = (float(run.length1), float(run.length2))
    # springs much longer than the path would shrink it to a dot
    if max(lengths) < 5.0 * np.hypot(*np.ptp(path, axis=1)):
        width = 0.05 * min(lengths)
        springs = displaced_springs(
            x, y, float(run.alpha1), float(run.alpha2), lengths, width
        )
        for spring, colour in zip(springs, SPRING_COLOURS, strict=True):
            axes.plot(*spring.T, color=colour, linewidth=0.9)
            axes.plot(*spring[-1], "s", color="black", markersize=3)
    axes.plot(x, y, "o", color="black", markersize=5)
    axes.axhline(
        float(run.preload), color=style.Colour.grey, linewidth=0.8, linestyle=":"
    )
    axes.set(xlabel="x (m)", ylabel="y (m)")
    axes.set_aspect("equal", adjustable="datalim")
    axes.locator_params(nbins=5)


def draw_spectrum(axes: Axes, dataset: xr.Dataset) -> None:
    """Amplitude spectrum of the contact force.

    Args:
        dataset: ``run_summary``, or ``simulation``, whose spectrum is then computed.
    """
    if "force_spectrum" in dataset:
        frequency, amplitude = dataset.frequency.values, dataset.force_spectrum.values
    elif _too_short(axes, dataset):
        return
    else:
        kept = np.isfinite(dataset.x.values)
        steps = np.diff(dataset.time.values[kept])
        if not _uniform(steps):
            style.say_instead(axes, "no spectrum:\nthe samples are not uniform in time")
            return
        force = dataset.normalized_contact_force.values[kept]
        if not lasts(force):
            style.say_instead(axes, "no contact in\nthe second half")
            return
        frequency, amplitude = amplitude_spectrum(
            force, float(steps[0]), padding=RunPictures.spectrum_padding
        )
    lines = strongest_lines(
        frequency, amplitude, 3, RunPictures.spectrum_padding * float(frequency[1])
    )
    if _draw_lines(axes, frequency, amplitude, lines):
        axes.set(xlabel="ω (rad/s)", ylabel=f"amplitude of {FORCE_LABEL}")


def draw_spectrum_in_hertz(axes: Axes, spectrum: xr.Dataset) -> None:
    """The contact force of a dataset ``spectrum``, up to where it is loud."""
    frequency, force = spectrum.frequency, spectrum.contact_force
    lines = spectrum.peak_frequency.values[:3], spectrum.peak_force.values[:3]
    if _draw_lines(axes, frequency.values, force.values, lines):
        axes.set(xlabel=label(frequency), ylabel=label(force))


def _draw_lines(
    axes: Axes,
    frequency: np.ndarray,
    amplitude: np.ndarray,
    lines: tuple[np.ndarray, np.ndarray],
) -> bool:
    """A spectrum with its strongest lines, where it has any."""
    # lines below 1 % of the strongest are left out of the drawn range
    loud = np.flatnonzero(amplitude > 0.01 * amplitude.max(initial=0.0))
    if not loud.size:
        style.say_instead(axes, "the contact force does not oscillate")
        return False
    axes.plot(frequency, amplitude, color=style.Colour.blue)
    axes.plot(*lines, "v", color=style.Colour.red, markersize=4)
    axes.set(xlim=(0, 1.2 * frequency[loud[-1]]), ylim=(0, None))
    return True


def _too_short(axes: Axes, run: xr.Dataset) -> bool:
    """Write into the panel that the run is too short to draw; return whether that is so."""
    reached = int(np.isfinite(run.x.values).sum())
    if reached >= FEWEST:
        return False
    end = meanings(run.outcome)[int(run.outcome)].replace("_", " ")
    style.say_instead(axes, f"too short for a picture:\n{reached} samples, then {end}")
    return True
