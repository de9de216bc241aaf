"""Draw a moving pad: mass on two inclined springs above the belt, contact force, path."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from matplotlib.text import Text

from squealpipe.codes import Regime
from squealpipe.plotting import style
from squealpipe.plotting.mechanism import coil, displaced_springs, draw_belt_motion
from squealpipe.plotting.motion_panels import (
    COLOURS_IN_WORDS,
    CONTACT_LOOKS,
    FilmScene,
    Traces,
    film_axes,
    length_in_words,
    round_down,
)
from squealpipe.plotting.pad_motion import PadMotion
from squealpipe.systems.inputs.words import number


class PadLayout:
    """Places of the drawn mechanism for displacements of the mass.

    Displacements about their mean are drawn `scale` times larger, the springs at their true angles,
    so that 1 mm is seen beside a spring of 100 mm. A spring shorter than half the other one is
    drawn half as long, unless the motion is drawn at its true size.

    Attributes:
        scale: 1, 2 or 5 times a power of ten.
        size: of all that is drawn, m.
        radius: of the drawn mass, m.
        low, high: corners of all that is drawn, m.
        belt: height of the belt's surface, m.
    """

    def __init__(self, motion: PadMotion) -> None:
        self.angles = motion.angles
        self.mean = motion.place.mean(axis=0)
        longest = max(motion.lengths)
        first, second = (max(length, 0.5 * longest) for length in motion.lengths)
        # what has died out stays still: round-off is not drawn as a motion
        extent = float(np.abs(motion.place - self.mean).max())
        extent = max(extent, 1e-3 * motion.preload)
        # beside a spring the motion is seen well, and the mass stays off its pivots
        self.scale = max(round_down(0.22 * min(first, second) / extent), 1.0)
        # at its true size the motion turns springs, which then have their true lengths
        self.lengths = (first, second) if self.scale > 1.0 else motion.lengths
        shortest = min(self.lengths)
        points = np.concatenate([self.drawn(motion.place), self.ends])
        self.size = float(np.ptp(points, axis=0).max())
        self.radius = 0.04 * self.size
        top = min(motion.preload, float(motion.place[:, 1].max()))
        lowest = float(motion.place[:, 1].min())
        self.level = float(self.drawn(np.array([0.0, top]))[1])
        depth = self.level - float(self.drawn(np.array([0.0, lowest]))[1])
        self.free = max(0.5 * shortest, 1.4 * depth)
        self.belt = self.level - self.radius - self.free
        self.low = points.min(axis=0) - 0.08 * self.size
        self.high = points.max(axis=0) + 0.08 * self.size
        self.low[1] = self.belt - 0.13 * self.size

    @property
    def told(self) -> str:
        """The scale in words."""
        larger = f"{number(self.scale)} times larger"
        return larger if self.scale > 1.0 else "at its true size"

    def drawn(self, place: np.ndarray) -> np.ndarray:
        """Return where the middle of the mass is drawn, (…, 2), m."""
        return np.asarray(self.mean + self.scale * (place - self.mean))

    def foot(self, middle: np.ndarray, *, separated: bool) -> float:
        """Return the height of the lower end of the contact spring, m."""
        lifted = self.belt + max(float(middle[1]) - self.level, 0.0)
        return lifted if separated else self.belt

    @property
    def ends(self) -> np.ndarray:
        """Fixed ends of the springs, (2, 2), m."""
        (a, b), (first, second) = self.angles, self.lengths
        return np.array(
            [
                [first * math.cos(a), first * math.sin(a)],
                [-second * math.cos(b), second * math.sin(b)],
            ]
        )


class PadDrawing:
    """Mass, springs, contact and belt on axes.

    Args:
        geometry: of the whole motion, so that nothing leaves the axes.
        motion: instants that will be shown.
        small: for a strip of several: thinner lines, no legend.
    """

    def __init__(
        self, axes: Axes, geometry: PadLayout, motion: PadMotion, *, small: bool = False
    ) -> None:
        self.geometry, self.motion, self.axes = geometry, motion, axes
        self.middles = geometry.drawn(motion.place)
        low, high = geometry.low, geometry.high
        # limits that are set would be warned of where the aspect extends them
        axes.plot(*np.stack([low, high], axis=1), alpha=0.0)
        axes.margins(0.0)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_axis_off()
        width = 0.8 if small else 1.4
        deep = 0.09 * geometry.size
        axes.axhspan(
            geometry.belt - deep,
            geometry.belt,
            facecolor="#E8E8E8",
            edgecolor="black",
            lw=0.6,
        )
        for end in geometry.ends:
            axes.plot(*end, "s", color="black", markersize=3 if small else 6, zorder=3)
        if not small:
            middle = (0.5 * (low[0] + high[0]), geometry.belt - 0.5 * deep)
            draw_belt_motion(axes, middle, geometry.size, motion.belt_speed, 11)
        # colours tell what the contact does, so the springs have none
        look: dict[str, Any] = {"color": style.Colour.grey, "lw": width}
        self.springs = [
            axes.plot([], [], solid_joinstyle="round", zorder=2, **look)[0]
            for _ in motion.angles
        ]
        self.contact: Line2D = axes.plot(
            [], [], color=style.Colour.grey, lw=width, zorder=1
        )[0]
        self.foot: Line2D = axes.plot(
            [], [], lw=2.5 if small else 5, solid_capstyle="butt", zorder=3
        )[0]
        self.mass = Circle(
            (0, 0), geometry.radius, facecolor=style.Colour.black, lw=0, zorder=4
        )
        axes.add_patch(self.mass)
        self.state: Text = axes.text(
            0, 0, "", ha="left", va="center", fontsize=6 if small else 9, zorder=5
        )
        self.moving: list[Any] = [
            self.contact,
            *self.springs,
            self.foot,
            self.mass,
            self.state,
        ]

    def show(self, frame: int) -> None:
        """Move all to an instant of the motion."""
        geometry, middle = self.geometry, self.middles[frame]
        width = 0.03 * geometry.size
        paths = displaced_springs(
            float(middle[0]),
            float(middle[1]),
            *geometry.angles,
            geometry.lengths,
            width,
        )
        for line, path in zip(self.springs, paths, strict=True):
            line.set_data(*path.T)
        regime = Regime(int(self.motion.regimes[frame]))
        word, colour = CONTACT_LOOKS[regime]
        foot = geometry.foot(middle, separated=regime is Regime.separated)
        lower = (float(middle[0]), float(middle[1]) - geometry.radius)
        self.contact.set_data(
            *coil(lower, (lower[0], foot), turns=4, width=0.8 * width).T
        )
        half = 1.3 * geometry.radius
        self.foot.set_data([middle[0] - half, middle[0] + half], [foot, foot])
        self.foot.set_color(colour)
        self.mass.set_center(tuple(middle))
        self.state.set_position((middle[0] + 1.25 * half, foot + 0.6 * geometry.radius))
        self.state.set_text(word)
        self.state.set_color(colour)


def pad_scene(motion: PadMotion, shown: PadMotion, slower: float) -> FilmScene:
    """Draw the film of a pad.

    Args:
        motion: all of it that the panels show.
        shown: instants of the frames.
        slower: how many times slower than in reality the film is.
    """
    figure, axes = film_axes()
    geometry = PadLayout(motion)
    first, second = (f"{number(math.degrees(angle))}°" for angle in shown.angles)
    open_, stuck = (
        f"{100 * np.mean(shown.regimes == each):.0f} %"
        for each in (Regime.separated, Regime.stick)
    )
    return FilmScene(
        figure,
        axes,
        PadDrawing(axes[0], geometry, shown),
        *(
            Traces(each.time, each.force, each.place, each.regimes, each.preload)
            for each in (motion, shown)
        ),
        title=f"α₁ = {first}, α₂ = {second}; motion drawn {geometry.told}",
        caption=(
            f"{length_in_words(shown.time, slower)}; displacements are drawn {geometry.told} "
            f"beside the springs. {COLOURS_IN_WORDS}"
        ),
        alt=(
            f"Film of a mass on two springs at {first} and {second} above a moving belt; its "
            f"contact is open {open_} and sticks {stuck} of the time. Beside it the contact force "
            "over time and the path of the mass."
        ),
    )
