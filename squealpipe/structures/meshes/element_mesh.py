"""A mesh of finite elements with named surfaces, whichever program wrote it."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from squealpipe.structures.meshes.finite_elements import CORNERS, ELEMENTS
from squealpipe.systems.inputs.words import suggestion

Facets = dict[int, np.ndarray]
"""Number of nodes of a facet → indices of its nodes, (facets, that number), outwards."""


class Surface(NamedTuple):
    """A surface of a mesh.

    Attributes:
        facets: outward order where the surface has a side.
        has_side: False of a shell of which no side is said.
    """

    facets: Facets
    has_side: bool = True


class Elements(NamedTuple):
    """Elements of one kind: their numbers, (m,), and the indices of their nodes, (m, nodes)."""

    numbers: np.ndarray
    nodes: np.ndarray


@dataclass(frozen=True, eq=False)
class ElementMesh:
    """Nodes, elements and surfaces.

    Args:
        numbers: of the nodes in their program, (n,).
        nodes: positions, (n, 3).
        elements: by meshio's name of their kind.
        surfaces: by name; each is made when it is asked for.
        source: file or argument, for messages.
        bound: names of constraints that take degrees of freedom out, like *EQUATION.
        turned: numbers of nodes whose directions are not those of the mesh (*TRANSFORM).
        counts_nodes: whether numbers of nodes only count them: an assembly of 3 rows a node may
            have no names.
        node_sets: indices of nodes by the name of their set or surface.
    """

    numbers: np.ndarray
    nodes: np.ndarray
    elements: Mapping[str, Elements] = field(default_factory=dict)
    surfaces: Mapping[str, Callable[["ElementMesh"], Surface]] = field(
        default_factory=dict
    )
    source: str = "mesh"
    bound: tuple[str, ...] = ()
    turned: frozenset[int] = frozenset()
    counts_nodes: bool = False
    node_sets: Mapping[str, np.ndarray] = field(default_factory=dict)

    @cached_property
    def index_of(self) -> dict[int, int]:
        """Number of a node → its index."""
        return {number: index for index, number in enumerate(self.numbers.tolist())}

    def surface(self, name: str) -> Surface:
        """Return a surface by its name; capitals do not matter.

        Raises:
            ValueError: there is none of that name, or it has no facet.
        """
        names = {surface.upper(): surface for surface in self.surfaces}
        own = names.get(name.upper())
        if own is None:
            raise ValueError(
                f"{self.source} has no surface or node set {name!r}; "
                + (
                    suggestion(name, sorted(self.surfaces))
                    if self.surfaces
                    else "it has none at all"
                )
            )
        surface = self.surfaces[own](self)
        if not any(map(len, surface.facets.values())):
            raise ValueError(
                f"{self.source}: surface or node set {name} has no facets: no facet of the mesh's "
                "skin has all of its nodes in it; name one that holds whole facets"
            )
        return surface

    @cached_property
    def solid_skin(self) -> Facets:
        """Facets of solids that belong to one element alone, outwards."""
        return joined(
            _used_once(
                [
                    faces_of(self, name, np.arange(len(block.numbers)), index)
                    for name, block in self.elements.items()
                    if not ELEMENTS[name].is_shell
                    for index in range(len(ELEMENTS[name].faces))
                ]
            )
        )

    @cached_property
    def skin(self) -> Facets:
        """Facets of the skin of solids, and shells that are not on it."""
        shells = [
            rows[self._on_solids(rows) < 0]
            for name, block in self.elements.items()
            if ELEMENTS[name].is_shell
            for rows in [block.nodes]
        ]
        return joined([*self.solid_skin.values(), *shells])

    @cached_property
    def _solid_facets(self) -> dict[tuple[int, ...], int]:
        """Nodes of a facet of the skin of solids, ascending → its place among those of its size."""
        return {
            tuple(row): index
            for rows in self.solid_skin.values()
            for index, row in enumerate(np.sort(rows, axis=1).tolist())
        }

    def _on_solids(self, rows: np.ndarray) -> np.ndarray:
        """Return the place of the same facet in the skin of solids; −1 where there is none.

        Meshers mark surfaces of solids by shells or plane elements.
        """
        places = self._solid_facets
        return np.array(
            [places.get(tuple(row), -1) for row in np.sort(rows, axis=1).tolist()], int
        )

    def of_shells(self, blocks: Iterable[np.ndarray]) -> Surface:
        """Return a surface of shells, or of facets that mark the skin of solids.

        Args:
            blocks: facets, (facets, nodes) each.
        """
        kept, has_side = [], True
        for rows in blocks:
            places = self._on_solids(rows)
            marks = places >= 0
            if marks.any():
                kept.append(self.solid_skin[rows.shape[1]][places[marks]])
            kept.append(rows[~marks])
            has_side = has_side and bool(marks.all())
        return Surface(joined(kept), has_side)

    @property
    def drawn(self) -> Facets:
        """Facets of a picture: the skin, or all surfaces where there are no elements."""
        if self.elements:
            return self.skin
        return joined(
            rows
            for name in self.surfaces
            for rows in self.surface(name).facets.values()
        )

    def within(self, members: np.ndarray) -> Surface:
        """Return the facets of the skin that have all their nodes among these.

        Args:
            members: indices of nodes.
        """
        is_member = np.zeros(len(self.nodes), bool)
        is_member[members] = True
        chosen = {size: is_member[rows].all(axis=1) for size, rows in self.skin.items()}
        facets = {
            size: rows[chosen[size]]
            for size, rows in self.skin.items()
            if chosen[size].any()
        }
        has_side = all((self._on_solids(rows) >= 0).all() for rows in facets.values())
        return Surface(facets, has_side)

    @cached_property
    def volume(self) -> float:
        """Volume of all solid elements, by the flux of the position through their skin."""
        total = 0.0
        for size, rows in self.solid_skin.items():
            corners = self.nodes[rows[:, : CORNERS[size]]]
            middle = corners.mean(axis=1)
            total += float((middle * vector_areas(corners)).sum()) / 3.0
        return total


def faces_of(
    mesh: ElementMesh, kind: str, chosen: np.ndarray, place: int
) -> np.ndarray:
    """Return one face of chosen elements of a solid kind, outwards, (chosen, nodes of the face).

    Args:
        chosen: indices of elements of that kind.
        place: of the face in the kind's table.
    """
    nodes = mesh.elements[kind].nodes[chosen]
    rows = nodes[:, ELEMENTS[kind].faces[place]]
    corners = mesh.nodes[rows[:, : CORNERS[rows.shape[1]]]]
    # programs number some faces inwards, and elements may be numbered as their mirror images
    outwards = corners.mean(axis=1) - mesh.nodes[nodes].mean(axis=1)
    inward = (vector_areas(corners) * outwards).sum(axis=1) < 0
    rows = rows.copy()
    rows[inward] = turned(rows[inward])
    return np.asarray(rows)


def turned(rows: np.ndarray) -> np.ndarray:
    """Return facets seen from their other side, (facets, nodes)."""
    corners = CORNERS[rows.shape[1]]
    order = [0, *range(corners - 1, 0, -1)]
    # the middle of an edge follows the corner where the edge begins
    middles = range(rows.shape[1] - 1, corners - 1, -1)
    return np.asarray(rows[:, [*order, *middles]])


def vector_areas(corners: np.ndarray) -> np.ndarray:
    """Return ∫ n dA of straight-edged facets, (facets, 3), from corners (facets, 3 or 4, 3)."""
    diagonal = corners[:, 2] - corners[:, 0]
    if corners.shape[1] == 3:
        return np.asarray(0.5 * np.cross(corners[:, 1] - corners[:, 0], diagonal))
    return np.asarray(0.5 * np.cross(diagonal, corners[:, 3] - corners[:, 1]))


def joined(blocks: Iterable[np.ndarray]) -> Facets:
    """Return facets by their number of nodes."""
    by_size: dict[int, list[np.ndarray]] = {}
    for rows in blocks:
        if len(rows):
            by_size.setdefault(rows.shape[1], []).append(rows)
    return {size: np.concatenate(rows) for size, rows in sorted(by_size.items())}


def _used_once(blocks: list[np.ndarray]) -> list[np.ndarray]:
    """Return the faces whose corners no other face has."""
    kept = []
    for size in (3, 4):
        group = [
            rows for rows in blocks if len(rows) and CORNERS[rows.shape[1]] == size
        ]
        if not group:
            continue
        corners = np.sort(np.concatenate([rows[:, :size] for rows in group]), axis=1)
        _, place, counts = np.unique(
            corners, axis=0, return_inverse=True, return_counts=True
        )
        once = counts[place.ravel()] == 1
        start = 0
        for rows in group:
            kept.append(rows[once[start : start + len(rows)]])
            start += len(rows)
    return kept
