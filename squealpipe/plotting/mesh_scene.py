"""Draw a vibrating structure: its deformed mesh with contacts, force and path of one of them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from squealpipe.codes import Regime
from squealpipe.plotting import style
from squealpipe.plotting.mechanism import draw_belt_motion
from squealpipe.plotting.motion_panels import (
    COLOURS_IN_WORDS,
    CONTACT_LOOKS,
    FilmScene,
    Traces,
    film_axes,
    length_in_words,
    round_down,
)
from squealpipe.plotting.structure_motion import StructureMotion
from squealpipe.structures.meshes.structure_mesh import NO_NODE, StructureMesh
from squealpipe.systems.inputs.units import shown_in
from squealpipe.systems.inputs.words import number


def projection(nodes: np.ndarray) -> np.ndarray:
    """Return the matrix (3, 3) from positions to right, up and towards the reader.

    A structure in the plane z = 0 is seen from ahead, others from a corner above.
    """
    if np.ptp(nodes[:, 2]) == 0.0:
        return np.eye(3)
    turn, rise = math.radians(-60.0), math.radians(30.0)
    across = np.array([-math.sin(turn), math.cos(turn), 0.0])
    ahead = np.array([math.cos(turn), math.sin(turn), 0.0])
    up = -math.sin(rise) * ahead + np.array([0.0, 0.0, math.cos(rise)])
    towards = math.cos(rise) * ahead + np.array([0.0, 0.0, math.sin(rise)])
    return np.stack([across, up, towards])


class Facets:
    """The facets of a mesh on axes, the nearest drawn last.

    Args:
        view: matrix of :func:`projection`.
    """

    def __init__(
        self, axes: Axes, mesh: StructureMesh, view: np.ndarray, **look: Any
    ) -> None:
        self.view = view
        used = mesh.facets[(mesh.facets != NO_NODE).sum(axis=1) > 1]
        corners = (used != NO_NODE).sum(axis=1)
        depth = np.array(
            [(mesh.nodes[row[row != NO_NODE]] @ view[2]).mean() for row in used]
        )
        # a quadratic facet names its corners first, then the middles of its edges
        plane = {6: 3, 8: 4, 7: 3, 9: 4}
        self.rows = [
            used[place, : plane.get(int(corners[place]), int(corners[place]))]
            for place in np.argsort(depth, kind="stable")
        ]
        kind = PolyCollection if corners.size and corners.max() > 2 else LineCollection
        self.drawn: Any = kind(self.polygons(mesh.nodes), **look)
        axes.add_collection(self.drawn, autolim=False)

    def polygons(self, nodes: np.ndarray) -> list[np.ndarray]:
        """Return corners of each facet as they are drawn, for positions (nodes, 3)."""
        flat = nodes @ self.view[:2].T
        return [flat[row] for row in self.rows]

    def show(self, nodes: np.ndarray) -> None:
        """Move the facets to where the nodes are."""
        polygons = self.polygons(nodes)
        if isinstance(self.drawn, LineCollection):
            self.drawn.set_segments(polygons)
        else:
            self.drawn.set_verts(polygons)


class StructureDrawing:
    """A structure on axes: facets, and contacts coloured by what they do.

    Without a mesh the contact points stand side by side.

    Args:
        motion: all of it.
        frames: indices of the instants that are shown.
    """

    def __init__(
        self,
        axes: Axes,
        motion: StructureMotion,
        frames: np.ndarray,
        *,
        small: bool = False,
    ) -> None:
        self.motion, self.frames = motion, frames
        self.has_mesh = motion.mesh is not None and motion.contact_position is not None
        # relative to the extent of the structure: large enough to be seen, small enough to keep
        # its form
        largest_deflection = 0.06
        largest = largest_deflection
        if motion.mesh is not None and motion.contact_position is not None:
            self.nodes, self.moved = motion.mesh.nodes, motion.nodes_at(frames)
            away = self.nodes - motion.contact_position[:, None]
            self.at = np.linalg.norm(away, axis=2).argmin(axis=1)
        else:
            count = len(motion.contacts)
            place = motion.contact_place - motion.contact_place.mean(axis=0)
            self.moved = np.pad(place[frames], ((0, 0), (0, 0), (0, 1)))
            self.nodes = np.zeros((count, 3))
            self.nodes[:, 0] = np.arange(count)
            self.at = np.arange(count)
            largest = 0.25 / max(count - 1, 1)
        self.extent = float(np.ptp(self.nodes, axis=0).max()) or 1.0
        moved = max(float(np.abs(self.moved).max()), 1e-300)
        self.scale = round_down(largest * self.extent / moved)
        view = projection(self.nodes)
        self.view = view
        self.facets = None
        if motion.mesh is not None and motion.contact_position is not None:
            Facets(
                axes,
                motion.mesh,
                view,
                facecolor="none",
                edgecolor=style.Colour.light,
                lw=0.3,
            )
            self.facets = Facets(
                axes,
                motion.mesh,
                view,
                facecolor="#DDE6EE",
                edgecolor="#5A6B7A",
                lw=0.3 if small else 0.5,
            )
        flat = self.nodes @ view[:2].T
        room = 1.3 * largest * self.extent
        low, high = flat.min(axis=0) - room, flat.max(axis=0) + room
        axes.plot(*np.stack([low, high], axis=1), alpha=0.0)
        axes.margins(0.02)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_axis_off()
        if self.plane:
            below = 0.025 if self.has_mesh else 0.3 / max(len(self.at) - 1, 1)
            self._draw_belt(axes, below * self.extent, small=small)
        if not self.has_mesh and not small:
            for name, at in zip(motion.contacts, flat, strict=True):
                axes.text(at[0], at[1] + 0.9 * room, name, ha="center", fontsize=8)
        many = len(self.at) > 30
        size = (8 if many else 25) * (0.4 if small else 1.0)
        self.marks = axes.scatter(flat[self.at, 0], flat[self.at, 1], s=size, zorder=5)
        self.edge = 0.6 if small else 1.5
        self.moving: list[Any] = [self.marks]
        if self.facets is not None:
            self.moving.insert(0, self.facets.drawn)

    def show(self, place: int) -> None:
        """Move all to an instant."""
        nodes = self.nodes + self.scale * self.moved[place]
        if self.facets is not None:
            self.facets.show(nodes)
        self.marks.set_offsets(nodes[self.at] @ self.view[:2].T)
        regimes = self.motion.regimes[self.frames[place]]
        colours = [CONTACT_LOOKS[Regime(int(regime))][1] for regime in regimes]
        # open contacts are hollow: they differ without colour too
        is_open = regimes == Regime.separated
        self.marks.set_facecolor(
            [
                "white" if each else colour
                for each, colour in zip(is_open, colours, strict=True)
            ]
        )
        self.marks.set_edgecolor(colours)
        self.marks.set_linewidth(self.edge)

    @property
    def plane(self) -> bool:
        """True if the structure lies in the plane z = 0."""
        return bool(np.ptp(self.nodes[:, 2]) == 0.0)

    def _draw_belt(self, axes: Axes, below: float, *, small: bool) -> None:
        """Draw the belt below the contacts of a structure in a plane, with its direction.

        Args:
            below: distance from the contacts at rest, m.
        """
        top = float(self.nodes[self.at, 1].min()) - below
        deep = 0.07 * self.extent
        axes.axhspan(
            top - deep, top, facecolor="#E8E8E8", edgecolor="black", lw=0.5, zorder=0
        )
        axes.plot([self.nodes[0, 0]], [top - 1.4 * deep], alpha=0.0)
        if not small:
            middle = (float(self.nodes[:, 0].mean()), top - 0.5 * deep)
            draw_belt_motion(axes, middle, self.extent, self.motion.belt_speed, 9)

    @property
    def told(self) -> str:
        """The scale in words."""
        return f"{number(self.scale)} times larger" if self.has_mesh else "not to scale"


def draw_forces(axes: Axes, run: xr.Dataset) -> None:
    """Draw the normal forces of a run of a structure over its last six periods."""
    if not run.sizes["time"]:
        style.say_instead(axes, "the motion dies out")
        return
    last = float(run.time[-1])
    shown = run.sel(time=slice(last - 6.0 / float(run.dominant_frequency), None))
    factor, unit = shown_in(last, "s")
    for index, name in enumerate(shown.contact.values[: len(style.Colour.palette)]):
        force = shown.normal_force[:, index]
        axes.plot(
            factor * shown.time, force, color=style.Colour.palette[index], label=name
        )
    axes.set(xlabel=f"time ({unit})", ylabel="normal force (N)")
    axes.legend(ncols=3)


def structure_scene(
    motion: StructureMotion, frames: np.ndarray, slower: float
) -> FilmScene:
    """Draw the film of a structure, with the force and path of the contact that opens most.

    Args:
        frames: indices of the instants of the motion that are shown.
        slower: how many times slower than in reality the film is.
    """
    figure, axes = film_axes()
    body = StructureDrawing(axes[0], motion, frames)
    chosen = motion.opens_most
    name = motion.contacts[chosen]
    open_ = 100 * np.mean(motion.regimes[:, chosen] == Regime.separated)
    return FilmScene(
        figure,
        axes,
        body,
        *(
            Traces(
                motion.time[part],
                motion.force[part, chosen],
                motion.contact_place[part, chosen],
                motion.regimes[part, chosen],
            )
            for part in (slice(int(frames[0]), int(frames[-1]) + 1), frames)
        ),
        title=f"vibration drawn {body.told}",
        force_label=f"{name}: force / preload",
        caption=(
            f"{length_in_words(motion.time[frames], slower)}; the "
            f"vibration is drawn {body.told}, without the static deformation. "
            f"{COLOURS_IN_WORDS} Force and path are those of contact {name}."
        ),
        alt=(
            f"Film of the vibrating structure with {len(motion.contacts)} contacts on a belt; "
            f"contact {name} is open {open_:.0f} % of the time. Beside it the normal force of "
            f"{name} over time and its path."
        ),
    )
