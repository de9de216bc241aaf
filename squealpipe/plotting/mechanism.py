"""The mechanism as a schematic: mass, two inclined springs, contact spring, belt."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Rectangle

from squealpipe.plotting.style import Colour

SPRING_COLOURS = (Colour.blue, Colour.orange)
"""Springs 1 and 2, here and in every schematic."""


def coil(
    start: tuple[float, float],
    end: tuple[float, float],
    *,
    turns: int = 7,
    width: float = 0.1,
) -> np.ndarray:
    """Points (n, 2) of a zigzag spring between two points, with straight ends."""
    along = np.subtract(end, start)
    length = float(np.hypot(*along))
    unit = along / length if length else np.array([1.0, 0.0])
    across = np.array([-unit[1], unit[0]])
    position = np.concatenate([[0.0], np.linspace(0.2, 0.8, 2 * turns + 1), [1.0]])
    offset = np.zeros(position.size)
    offset[2:-2] = width * np.where(np.arange(position.size - 4) % 2, -1.0, 1.0)
    points: np.ndarray = (
        np.asarray(start) + position[:, None] * along + offset[:, None] * across
    )
    return points


def draw_belt_motion(
    axes: Axes, middle: tuple[float, float], size: float, belt_speed: float, head: float
) -> None:
    """Draw the direction of a belt that moves, from the middle of a picture of a size."""
    if not belt_speed:
        return
    ahead = np.copysign(size, belt_speed)
    x, y = middle
    arrow(axes, (x - 0.1 * ahead, y), (x + 0.1 * ahead, y), head, "black")
    side = "left" if ahead > 0 else "right"
    axes.text(x + 0.13 * ahead, y, "belt", fontsize=8, va="center", ha=side)


def draw_mechanism(
    axes: Axes,
    alpha1: float,
    alpha2: float,
    *,
    labels: bool = False,
    direction: float = 1.0,
) -> None:
    """Draw an arrangement at its true angles; both springs have length 1, the mass radius 0.12.

    Args:
        direction: of the belt, +1 or −1.
    """
    radius = 0.12
    directions = (
        np.array([np.cos(alpha1), np.sin(alpha1)]),
        np.array([-np.cos(alpha2), np.sin(alpha2)]),
    )
    belt_top = -0.62
    line = 1.2 if labels else 0.8
    aside = apart(*directions, 0.1)
    for towards, shift, colour in zip(directions, aside, SPRING_COLOURS, strict=True):
        path = coil(tuple(towards * radius), tuple(towards), width=0.07)
        path[1:-1] += shift
        axes.plot(
            *path.T, color=colour, linewidth=line, solid_joinstyle="round", zorder=2
        )
        axes.add_patch(Circle(tuple(towards), 0.04, color="black", zorder=3))
    contact = coil((0.0, -radius), (0.0, belt_top), turns=4, width=0.07)
    axes.plot(*contact.T, color=Colour.grey, linewidth=line, zorder=1)
    axes.add_patch(
        Circle((0.0, 0.0), radius, facecolor="white", edgecolor="black", zorder=4)
    )
    half = 1.25 if labels else 0.8
    look: dict[str, Any] = {"facecolor": "#E8E8E8", "hatch": "////" if labels else None}
    axes.add_patch(
        Rectangle((-half, belt_top - 0.12), 2 * half, 0.12, lw=0.6, ec="black", **look)
    )
    start, end = ((direction * share * half, belt_top - 0.27) for share in (0.30, 0.85))
    arrow(axes, start, end, 11 if labels else 6, Colour.red)
    if labels:
        _label(axes, directions, (alpha1, alpha2), belt_top)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.margins(0.04)


def _label(
    axes: Axes,
    directions: tuple[np.ndarray, np.ndarray],
    angles: tuple[float, float],
    belt_top: float,
) -> None:
    text: dict[str, Any] = {"fontsize": 10, "ha": "center", "va": "center"}
    axes.text(0, 0, "$m$", zorder=5, **text)
    for index, direction in enumerate(directions, start=1):
        side = np.array([-direction[1], direction[0]]) * (1 if index == 1 else -1)
        place = 0.58 * direction + 0.27 * side
        name = f"$k_{index},\\ L_{index}$"
        axes.text(place[0], place[1], name, color=SPRING_COLOURS[index - 1], **text)
    # y = 0 at the start, contact is lost at y = l_pre
    top, aside = 0.28, 1.08
    for height in (0.0, top):
        axes.plot(
            [aside - 0.14, aside + 0.14],
            [height, height],
            color=Colour.grey,
            linewidth=0.6,
        )
    look: dict[str, Any] = {
        "arrowstyle": "<|-|>",
        "mutation_scale": 7,
        "color": "black",
    }
    axes.add_patch(
        FancyArrowPatch(
            (aside, 0.0), (aside, top), shrinkA=0, shrinkB=0, lw=0.6, **look
        )
    )
    axes.text(aside - 0.27, 0.5 * top, r"$l_\mathrm{pre}$", **text)
    span = 0.42
    axes.plot([-0.62, 0.62], [0, 0], color=Colour.grey, linewidth=0.6, linestyle=":")
    degrees = np.degrees(angles)
    for ends in ((0, degrees[0]), (180 - degrees[1], 180)):
        axes.add_patch(
            Arc((0, 0), 2 * span, 2 * span, theta1=ends[0], theta2=ends[1], lw=0.8)
        )
    for index, mid in ((1, angles[0] / 2), (2, np.pi - angles[1] / 2)):
        place = 1.3 * span * np.array([np.cos(mid), np.sin(mid)])
        axes.text(place[0], place[1], f"$\\alpha_{index}$", **text)
    axes.text(0.26, 0.5 * belt_top - 0.06, "$k_3$", color=Colour.grey, **text)
    axes.text(-0.75, belt_top + 0.1, "friction $\\mu$", **text)
    axes.text(1.14, belt_top - 0.27, "$V$", color=Colour.red, **text)
    origin = np.array([-1.2, 0.02])
    for step, name in (((0.3, 0.0), "x"), ((0.0, 0.3), "y")):
        tip = origin + step
        arrow(axes, origin, tip, 8, "black")
        label = tip + 0.3 * np.subtract(tip, origin)
        axes.text(label[0], label[1], f"${name}$", **text)


def arrow(axes: Axes, start: Any, end: Any, size: float, colour: str) -> None:
    """A full arrow head at ``end``."""
    look: dict[str, Any] = {
        "arrowstyle": "-|>",
        "mutation_scale": size,
        "color": colour,
    }
    axes.add_patch(FancyArrowPatch(tuple(start), tuple(end), **look))


def displaced_springs(
    x: float,
    y: float,
    alpha1: float,
    alpha2: float,
    lengths: tuple[float, float],
    width: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Zigzag points of both springs with the mass displaced to (x, y), in metres."""
    end1 = (lengths[0] * np.cos(alpha1), lengths[0] * np.sin(alpha1))
    end2 = (-lengths[1] * np.cos(alpha2), lengths[1] * np.sin(alpha2))
    springs = coil((x, y), end1, width=width), coil((x, y), end2, width=width)
    aside = apart(np.subtract(end1, (x, y)), np.subtract(end2, (x, y)), 2.1 * width)
    for path, shift in zip(springs, aside, strict=True):
        path[1:-1] += shift
    return springs


def apart(first: np.ndarray, second: np.ndarray, distance: float) -> np.ndarray:
    """Sideways shifts of two springs that would hide one another, in rows; else zero."""
    lengths = np.hypot(*np.transpose([first, second]))
    if not lengths.all() or not np.allclose(
        first / lengths[0], second / lengths[1], atol=1e-6
    ):
        return np.zeros((2, 2))
    across = np.array([-first[1], first[0]]) / lengths[0]
    return np.array([0.5 * distance * across, -0.5 * distance * across])
