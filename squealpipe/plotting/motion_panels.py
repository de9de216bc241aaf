"""Draw the frames of a film: what moves, and beside it force and path of a contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

from squealpipe.codes import Regime
from squealpipe.plotting import style
from squealpipe.plotting.cycles import joined
from squealpipe.systems.inputs.units import engineering, shown_in
from squealpipe.systems.inputs.words import number

CONTACT_LOOKS = {
    Regime.slip_slower: ("slip", style.REGIME_COLOURS["slip_slower"]),
    Regime.slip_faster: ("faster than the belt", style.REGIME_COLOURS["slip_faster"]),
    Regime.stick: ("stick", style.REGIME_COLOURS["stick"]),
    Regime.separated: ("open", style.REGIME_COLOURS["separated"]),
}
"""State of a contact in words, and its colour."""
COLOURS_IN_WORDS = (
    "Blue: the contact slips; green: it is faster than the belt; orange: it sticks; red: it is "
    "open."
)


@dataclass(frozen=True)
class Traces:
    """Motion of one contact.

    Attributes:
        time: (n,), s.
        force: over the preload, (n,).
        place: along and across the belt, (n, 2), m.
        regimes: codes, (n,).
        limit: height at which contact is lost, m; NaN: it is not known.
    """

    time: np.ndarray
    force: np.ndarray
    place: np.ndarray
    regimes: np.ndarray
    limit: float = np.nan


class Panels:
    """Force and path of one contact in a column of axes.

    Args:
        column: axes that both panels take the place of.
        motion: all that the path shows.
        shown: instants of the frames.
        force_label: of the force.
    """

    def __init__(
        self,
        figure: Figure,
        column: Axes,
        motion: Traces,
        shown: Traces,
        force_label: str,
    ) -> None:
        spec = column.get_subplotspec()
        assert spec is not None  # noqa: S101 (axes of a grid have one)
        grid = spec.subgridspec(2, 1, height_ratios=[1, 1.25])
        column.remove()
        force, path = (figure.add_subplot(grid[row, 0]) for row in (0, 1))
        self.shown = shown
        last = float(shown.time[-1])
        self.factor, self.unit = (1e3, "ms") if last < 10.0 else (1.0, "s")
        self.digits = max(5 - len(str(int(self.factor * last))), 0)
        self.past, self.now = self._draw_force(force, motion, force_label)
        self.dot = self._draw_path(path, motion)
        self.moving = [self.past, self.now, self.dot]

    def told(self, frame: int) -> str:
        """Return the instant of a frame in words that keep their length."""
        time = self.factor * float(self.shown.time[frame])
        return f"t = {time:.{self.digits}f} {self.unit}"

    def _draw_force(
        self, axes: Axes, motion: Traces, label: str
    ) -> tuple[Line2D, Line2D]:
        first, last = self.shown.time[0], self.shown.time[-1]
        kept = (motion.time >= first) & (motion.time <= last)
        self.force_time = self.factor * motion.time[kept]
        self.force = motion.force[kept]
        top = 1.1 * max(float(np.nanmax(self.force)), 1e-12)
        axes.plot(self.force_time, self.force, color=style.Colour.light, lw=0.8)
        axes.axhline(0.0, color=style.Colour.grey, lw=0.5)
        margin = 0.03 * self.factor * (last - first)
        axes.set(
            xlim=(self.factor * first - margin, self.factor * last + margin),
            ylim=(-0.06 * top, top),
            xlabel=f"time ({self.unit})",
            ylabel=label,
        )
        axes.locator_params(axis="x", nbins=4)
        past: Line2D = axes.plot([], [], color=style.Colour.black, lw=1.0)[0]
        now: Line2D = axes.plot([], [], "o", color=style.Colour.black, ms=5)[0]
        return past, now

    def _draw_path(self, axes: Axes, motion: Traces) -> Line2D:
        self.unit_factor, unit = shown_in(float(np.abs(motion.place).max()), "m")
        x, y = self.unit_factor * motion.place.T
        for regime, (_, colour) in CONTACT_LOOKS.items():
            shown = np.where(joined(motion.regimes == regime), y, np.nan)
            axes.plot(x, shown, color=colour, lw=0.7)
        limit = self.unit_factor * motion.limit
        if y.min() < limit < 1.2 * max(y.max(), 0.0):
            axes.axhline(limit, color=style.Colour.grey, lw=0.8, linestyle=":")
        axes.set(xlabel=f"along the belt ({unit})", ylabel=f"away from it ({unit})")
        axes.set_aspect("equal", adjustable="datalim")
        axes.locator_params(nbins=5)
        dot: Line2D = axes.plot([], [], "o", color=style.Colour.black, ms=6, zorder=5)[
            0
        ]
        return dot

    def show(self, frame: int) -> None:
        """Move all to an instant of the film."""
        shown = self.shown
        time, force = self.factor * float(shown.time[frame]), float(shown.force[frame])
        before = self.force_time <= time
        self.past.set_data(
            np.append(self.force_time[before], time),
            np.append(self.force[before], force),
        )
        self.now.set_data([time], [force])
        x, y = self.unit_factor * shown.place[frame]
        self.dot.set_data([x], [y])
        for mark in (self.now, self.dot):
            mark.set_color(CONTACT_LOOKS[Regime(int(shown.regimes[frame]))][1])


class Artists(Protocol):
    """Artists that move from frame to frame."""

    moving: list[Any]

    def show(self, frame: int) -> None:
        """Move them to where they are in a frame."""


class FilmScene:
    """A film: what moves and a clock at the left, force and path of one contact at the right.

    Args:
        axes: of the left and of the right, of :func:`film_axes`.
        drawn: what moves at the left.
        motion: all that the path shows.
        shown: instants of the frames.

    Attributes:
        moving: artists that :meth:`show` changes, in the order in which they are drawn.
        caption: words for what is seen, with the scale of time and of motion.
        alt: words for those who do not see it.
    """

    def __init__(
        self,
        figure: Figure,
        axes: np.ndarray,
        drawn: Artists,
        motion: Traces,
        shown: Traces,
        *,
        title: str,
        caption: str,
        alt: str,
        force_label: str = "contact force over preload",
    ) -> None:
        self.figure, self.caption, self.alt = figure, caption, alt
        self.drawn, self.shown = drawn, shown
        left, right = axes
        left.legend(
            handles=[
                Patch(color=colour, label=word)
                for word, colour in CONTACT_LOOKS.values()
            ],
            loc="lower center",
            bbox_to_anchor=(0.5, -0.02),
            ncols=4,
            columnspacing=1.0,
            title="contact",
        )
        left.set_title(title, fontsize=8)
        self.clock: Text = left.text(
            0.0, 0.98, "", transform=left.transAxes, va="top", fontsize=10
        )
        self.panels = Panels(figure, right, motion, shown, force_label)
        self.moving = [*drawn.moving, self.clock, *self.panels.moving]

    def show(self, frame: int) -> None:
        """Move all to an instant of the film."""
        self.drawn.show(frame)
        self.panels.show(frame)
        self.clock.set_text(self.panels.told(frame))


def film_axes() -> tuple[Figure, np.ndarray]:
    """Return a figure for a film, and its two axes."""
    figure, axes = style.new_figure(8.0, 4.5, ncols=2, width_ratios=[1.35, 1.0])
    return figure, axes[0]


def length_in_words(time: np.ndarray, slower: float) -> str:
    """Return how much of a motion a film shows, and how many times slower or faster than it is."""
    pace = "slower" if slower >= 1.0 else "faster"
    factor = number(max(slower, 1.0 / slower), 2)
    return (
        f"{engineering(float(time[-1] - time[0]), 's', 3)} of the motion, played "
        f"{factor} times {pace} than in reality"
    )


def round_down(value: float) -> float:
    """Return the largest of 1, 2 and 5 times a power of ten that is no larger than a value."""
    power = 10.0 ** np.floor(np.log10(value))
    steps = (step for step in (1.0, 2.0, 5.0) if step * power <= value * 1.000001)
    return float(power) * max(steps)
