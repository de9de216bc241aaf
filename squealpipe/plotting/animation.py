"""Make films and strips of phases from the motion in a dataset."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.film import FRAMES_PER_SECOND, Film
from squealpipe.plotting.mesh_scene import StructureDrawing, structure_scene
from squealpipe.plotting.pad_motion import PadMotion
from squealpipe.plotting.pad_scene import PadDrawing, PadLayout, pad_scene
from squealpipe.plotting.structure_motion import SCHEMA as STRUCTURE_RUN
from squealpipe.plotting.structure_motion import StructureMotion
from squealpipe.systems.inputs.units import engineering
from squealpipe.vibration.spectrum import amplitude_spectrum, strongest_lines


def film_of(
    run: xr.Dataset,
    *,
    seconds: float = 3.0,
    periods: float | None = None,
    begin: float | None = None,
    again: Callable[[np.ndarray], xr.Dataset] | None = None,
    dpi: int = 120,
) -> Film:
    """Make a film of the end of a run.

    Args:
        run: dataset ``simulation``, ``assess`` or ``structure_run``.
        seconds: length of the film, s.
        periods: of the strongest line that are shown; by default one in each second of film.
        begin: instant of the run at which the film begins, s; by default so that it ends with the
            run.
        again: integrates the run again, given instants (n,), s; used where it is sampled too
            coarsely.
        dpi: pixels per inch of a picture of 8 by 4.5 inches.

    Raises:
        ValueError: an argument, or the dataset holds no motion.
    """
    if not (math.isfinite(seconds) and 0 < seconds <= 120):
        raise ValueError(f"seconds = {seconds!r}: a time up to 120 s is needed")
    periods = seconds if periods is None else periods
    if not (math.isfinite(periods) and periods > 0):
        raise ValueError(f"periods = {periods!r}: a number above 0 is needed")
    if run.attrs.get("schema") == STRUCTURE_RUN:
        return _film_of_structure(run, seconds, periods, begin, dpi)
    motion = PadMotion.read(run)
    period = period_of(motion)
    start, span, seconds = _part(motion.time, periods * period, begin, seconds)
    last = float(motion.time[-1])
    part = motion.from_(start - period)
    # between so many samples cubics with the right velocities miss nothing that is seen
    samples_per_period = 16
    if part.time.size * period < samples_per_period * (last - part.time[0]):
        if again is None:
            raise ValueError(
                "the run is sampled too coarsely for a film; simulate it with more --points"
            )
        count = math.ceil(4 * samples_per_period * (last - part.time[0]) / period)
        motion = PadMotion.read(
            again(np.linspace(max(start - period, motion.time[0]), last, count + 1))
        )
    count = max(round(seconds * FRAMES_PER_SECOND), 2)
    shown = motion.at(start + span * np.arange(count) / count)
    around = motion.from_(start - 1e-9 * span)
    around = around if around.time.size > 3 else motion
    return Film(pad_scene(around, shown, seconds / span), count, dpi)


def _film_of_structure(
    run: xr.Dataset, seconds: float, periods: float, begin: float | None, dpi: int
) -> Film:
    """Make a film of a structure of the stored instants that are nearest to its frames."""
    motion = StructureMotion.read(run)
    start, span, seconds = _part(
        motion.time, periods / motion.frequency, begin, seconds
    )
    count = max(round(seconds * FRAMES_PER_SECOND), 2)
    frames = motion.nearest(start + span * np.arange(count) / count)
    return Film(structure_scene(motion, frames, seconds / span), count, dpi)


def _part(
    time: np.ndarray, length: float, begin: float | None, seconds: float
) -> tuple[float, float, float]:
    """Return begin and length of the part of a run that is shown, and the time that it takes, s.

    Args:
        length: that is asked for, s; the pace stays what was asked for where the run is shorter.
    """
    first, last = float(time[0]), float(time[-1])
    span = min(length, last - first)
    start = last - span if begin is None else begin
    if not first <= start < last:
        raise ValueError(
            f"begin = {start!r} s: the run is from {first:.6g} to {last:.6g} s"
        )
    span = min(span, last - start)
    return start, span, seconds * span / length


def period_of(motion: PadMotion) -> float:
    """Return the period of the strongest line of the velocity in the later half, s.

    Of a motion without a line it is a twelfth of the whole.
    """
    late = motion.from_(0.5 * (motion.time[0] + motion.time[-1]))
    if motion.settled:
        late = motion
    length = float(late.time[-1] - late.time[0])
    uniform = np.linspace(late.time[0], late.time[-1], late.time.size)
    louder = int(late.velocity.std(axis=0).argmax())
    signal = np.interp(uniform, late.time, late.velocity[:, louder])
    omega, amplitude = amplitude_spectrum(
        signal, length / (late.time.size - 1), padding=4
    )
    lines, _ = strongest_lines(omega, amplitude, 1, 2.0 * math.pi / length)
    if lines.size:
        return 2.0 * math.pi / float(lines[0])
    return float(motion.time[-1] - motion.time[0]) / 12.0


def phases(run: xr.Dataset) -> Figure:
    """Draw the last period of a motion's strongest line as a strip of eight phases, for paper.

    Args:
        run: dataset ``simulation``, ``assess`` or ``structure_run``.
    """
    of_structure = run.attrs.get("schema") == STRUCTURE_RUN
    figure, axes = style.new_figure(
        style.PAGE, 2.5 if of_structure else 3.5, nrows=2, ncols=4
    )
    draw = _draw_phases_of_structure if of_structure else draw_phases
    figure.suptitle(draw(list(axes.flat), run), fontsize=8)
    return figure


def draw_phases(panels: list[Axes], run: xr.Dataset) -> str:
    """Draw the last period of a pad's strongest line, a phase a panel; return it and the scale.

    Args:
        run: dataset ``simulation`` or ``assess``.
    """
    motion = PadMotion.read(run)
    period, last = period_of(motion), float(motion.time[-1])
    count = len(panels)
    shown = motion.at(last - period * (1.0 - np.arange(count) / count))
    around = motion.from_(last - period)
    geometry = PadLayout(around if around.time.size > 3 else motion)
    for index, panel in enumerate(panels):
        PadDrawing(panel, geometry, shown, small=True).show(index)
        panel.set_title(engineering(period * index / count, "s"), fontsize=7)
    return f"{_in_words(period)}; motion drawn {geometry.told}"


def _draw_phases_of_structure(panels: list[Axes], run: xr.Dataset) -> str:
    motion = StructureMotion.read(run)
    period, last, count = 1.0 / motion.frequency, float(motion.time[-1]), len(panels)
    frames = motion.nearest(last - period * (1.0 - np.arange(count) / count))
    for index, panel in enumerate(panels):
        body = StructureDrawing(panel, motion, frames, small=True)
        body.show(index)
        panel.set_title(engineering(period * index / count, "s"), fontsize=7)
    return f"{_in_words(period)}; vibration drawn {body.told}"


def _in_words(period: float) -> str:
    # a motion that beats or is irregular has no period of its own
    return f"one period of its strongest line, {engineering(period, 's')}"
