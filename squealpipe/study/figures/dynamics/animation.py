"""A motion as a short animation: the mechanism, and its contact force as time goes on."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from squealpipe.plotting.mechanism import SPRING_COLOURS, coil, displaced_springs
from squealpipe.plotting.style import BLUE, GREEN, GREY, LIGHT, RED, new_figure, pi_label
from squealpipe.store.whole_files import whole_file

COLOURS = 64
DOTS_PER_INCH = 80


def animate(
    run: xr.Dataset, path: str | os.PathLike[str], *, start: float, end: float, frames: int
) -> None:
    """Write a GIF of a part of a run.

    Args:
        run: x, y, normalized_contact_force over ``time``, and alpha1, alpha2, length1, length2
            and preload, as in the datasets ``simulation`` and, for one pair, ``explorer``.
        path: the file; it appears whole or not at all.
        start, end: part of the run, s.
        frames: number of frames, evenly spaced in time.

    Raises:
        ValueError: the run does not hold that part.
    """
    inside = np.flatnonzero((run.time >= start) & (run.time <= end) & np.isfinite(run.x))
    if inside.size < frames:
        raise ValueError(
            f"the run has {inside.size} samples from t = {start:g} to {end:g}; "
            f"ask for at most so many frames, not {frames}"
        )
    part = run.isel(time=inside)
    figure, axes = new_figure(6.0, 3.0, ncols=2, width_ratios=(1.25, 1))
    figure.set_dpi(DOTS_PER_INCH)
    panels = (_Mechanism(axes[0, 0], part), _Force(axes[0, 1], part))
    chosen = np.linspace(0, inside.size - 1, frames).round().astype(int)
    pictures = list(_pictures(figure, panels, chosen))
    with whole_file(Path(path)) as temporary:
        _write(pictures, temporary)


class _Mechanism:
    """Springs, mass, belt and the orbit so far."""

    def __init__(self, axes: Axes, run: xr.Dataset) -> None:
        self.x, self.y = run.x.values.astype(float), run.y.values.astype(float)
        self.force = run.normalized_contact_force.values
        self.angles = float(run.alpha1), float(run.alpha2)
        self.lengths = float(run.length1), float(run.length2)
        self.preload = float(run.preload)
        # L3 is not part of the model; the drawn spring is longer than it is ever compressed.
        self.free = max(2.2 * self.preload, 1.2 * (self.preload - float(self.y.min())))
        self.belt = self.preload - self.free
        springs = displaced_springs(0.0, 0.0, *self.angles, self.lengths, 0.0)
        pivots = np.array([spring[-1] for spring in springs])
        wide = np.concatenate([self.x, pivots[:, 0]])
        high = np.concatenate([self.y, pivots[:, 1], [self.belt]])
        margin = 0.06 * max(np.ptp(wide), np.ptp(high))
        self.width = 0.5 * margin
        axes.set_xlim(wide.min() - margin, wide.max() + margin)
        axes.set_ylim(high.min() - margin, high.max() + margin)
        axes.set_aspect("equal")
        axes.axhline(self.belt, color="black", linewidth=2)
        axes.plot(*pivots.T, "s", color="black", markersize=4)
        (self.trail,) = axes.plot([], [], color=LIGHT, linewidth=0.8)
        self.springs = [axes.plot([], [], color=colour)[0] for colour in SPRING_COLOURS]
        (self.contact,) = axes.plot([], [], color=GREEN)
        (self.mass,) = axes.plot([], [], "o", color="black", markersize=8)
        self.moving = [self.trail, *self.springs, self.contact, self.mass]
        axes.set(xlabel="x (m)", ylabel="y (m)")
        axes.set_title(f"α₁ = {pi_label(self.angles[0])}, α₂ = {pi_label(self.angles[1])}")

    def show(self, index: int) -> None:
        """Move everything to one instant."""
        x, y = float(self.x[index]), float(self.y[index])
        touching = bool(self.force[index] > 0)
        foot = self.belt if touching else y - self.free
        paths = displaced_springs(x, y, *self.angles, self.lengths, self.width)
        for line, points in zip(self.springs, paths, strict=True):
            line.set_data(*points.T)
        self.contact.set_data(*coil((x, y), (x, foot), turns=4, width=0.6 * self.width).T)
        self.contact.set_color(GREEN if touching else RED)
        self.mass.set_data([x], [y])
        self.trail.set_data(self.x[: index + 1], self.y[: index + 1])


class _Force:
    """Contact force over time, with a dot at the instant shown."""

    def __init__(self, axes: Axes, run: xr.Dataset) -> None:
        self.time = run.time.values
        self.force = run.normalized_contact_force.values
        axes.plot(self.time, self.force, color=BLUE)
        (self.dot,) = axes.plot([], [], "o", color=RED, markersize=6)
        self.clock = axes.set_title("t = 0 s")
        self.moving = [self.dot, self.clock]
        axes.axhline(0, color=GREY, linewidth=0.6)
        axes.set(xlabel="t (s)", ylabel=r"$N / (k_3 l_\mathrm{pre})$")

    def show(self, index: int) -> None:
        """Move the dot to one instant."""
        self.dot.set_data([self.time[index]], [self.force[index]])
        apart = "" if self.force[index] > 0 else ", contact lost"
        self.clock.set_text(f"t = {self.time[index]:.1f} s{apart}")


def _pictures(
    figure: Figure, panels: Sequence[_Mechanism | _Force], chosen: np.ndarray
) -> Iterator[Image.Image]:
    """Frames; what stands still is drawn once."""
    canvas = FigureCanvasAgg(figure)
    moving = [artist for panel in panels for artist in panel.moving]
    for artist in moving:
        artist.set_animated(True)
    canvas.draw()  # type: ignore[no-untyped-call]
    still = canvas.copy_from_bbox(figure.bbox)  # type: ignore[no-untyped-call]
    for index in chosen:
        canvas.restore_region(still)  # type: ignore[attr-defined, no-untyped-call]
        for panel in panels:
            panel.show(int(index))
        for artist in moving:
            figure.draw_artist(artist)
        pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
        yield Image.fromarray(pixels[..., :3].copy())


def _write(pictures: Sequence[Image.Image], path: Path) -> None:
    """One palette for all frames keeps the file small and the colours still."""
    both = np.hstack([np.asarray(pictures[len(pictures) // 3]), np.asarray(pictures[-1])])
    palette = Image.fromarray(both).quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE)
    frames = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=80)
