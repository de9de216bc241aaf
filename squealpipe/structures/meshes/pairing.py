"""Nearest points of a surface: a node where one is there, else a point in a facet.

Idea: a node of one surface meets the node of the other that is at the same place; where meshes do
not match, it meets the point of the nearest facet, found by Newton's method in the facet's own
coordinates, kept within it. Facets are tried whose nodes are near, all at once. Invariant: weights
of a point add up to 1. Cost: a tree of the nodes, and some ten facets a point.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from squealpipe.structures.meshes.element_mesh import Facets
from squealpipe.structures.meshes.shape_functions import (
    is_triangle,
    normal_integrals,
    shape,
    sizes,
)


@dataclass(frozen=True)
class Pairing:
    """Thresholds of the search for partners on a faceted surface."""

    matching: float = 1e-6
    """Distance of matching nodes, over the size of a facet; meshers write six digits or more."""
    newton_steps: int = 30
    """Steps of Newton's method in a facet; a flat one needs one, a warped one three."""
    rounding: float = 1e-14
    """Change of ξ and η that is round-off."""


class Partner(NamedTuple):
    """The point of a surface that is nearest to another point.

    Attributes:
        nodes: indices of the nodes that carry it.
        weights: of these, their sum is 1.
        position: (3,).
        normal: outwards, (3,), of length 1.
        size: longest edge of its facets.
        distance: to the other point.
    """

    nodes: np.ndarray
    weights: np.ndarray
    position: np.ndarray
    normal: np.ndarray
    size: float
    distance: float


class _Candidate(NamedTuple):
    """Nearest place within one facet: its distance, the facet's nodes and index, ξ and η."""

    distance: float
    size: int
    facet: int
    place: np.ndarray


class FacetedSurface:
    """A surface with its normals, ready to be searched.

    Args:
        nodes: positions of all nodes of the mesh, (n, 3).
        facets: of the surface.
    """

    def __init__(self, nodes: np.ndarray, facets: Facets) -> None:
        self.nodes, self.facets = nodes, facets
        self.members = np.unique(
            np.concatenate([facet.ravel() for facet in facets.values()])
        )
        positions = {size: nodes[rows] for size, rows in facets.items()}
        self.areas = {
            size: normal_integrals(position) for size, position in positions.items()
        }
        self.sizes = {size: sizes(position) for size, position in positions.items()}
        total = np.zeros_like(nodes)
        largest = np.zeros(len(nodes))
        self.gross = np.zeros(len(nodes))
        for size, rows in facets.items():
            lengths = np.linalg.norm(self.areas[size], axis=1)
            for column in rows.T:
                np.add.at(total, column, self.areas[size])
                np.add.at(self.gross, column, lengths)
                np.maximum.at(largest, column, self.sizes[size])
        length = np.linalg.norm(total, axis=1)
        self.normals = total / np.where(length > 0, length, 1.0)[:, None]
        """Area-weighted mean normals of nodes, (n, 3); 0 where facets cancel."""
        self.agreement = length / np.where(self.gross > 0, self.gross, 1.0)
        """1 where all facets of a node look one way, 0 where they look in opposite ones."""
        self.node_sizes = largest
        """Longest edge of the facets of each node, (n,)."""
        self._tree = cKDTree(nodes[self.members])

    def partners(self, points: np.ndarray) -> list[Partner]:
        """Return the nearest point of the surface to each point.

        Args:
            points: (points, 3).
        """
        distances, places = self._tree.query(points)
        nearest = self.members[places]
        matches = distances <= Pairing.matching * self.node_sizes[nearest]
        found: dict[int, Partner] = {
            int(index): self._of_node(int(nearest[index]), float(distances[index]))
            for index in np.flatnonzero(matches)
        }
        others = np.flatnonzero(~matches)
        for index, candidates in self._candidates(points, others, distances).items():
            found[index] = self._in_facet(candidates)
        return [found[index] for index in range(len(points))]

    def _of_node(self, node: int, distance: float) -> Partner:
        return Partner(
            np.array([node]),
            np.ones(1),
            self.nodes[node],
            self.normals[node],
            float(self.node_sizes[node]),
            distance,
        )

    def _candidates(
        self, points: np.ndarray, chosen: np.ndarray, distances: np.ndarray
    ) -> dict[int, list[_Candidate]]:
        """Return the nearest places in the facets near each chosen point."""
        found: dict[int, list[_Candidate]] = {int(index): [] for index in chosen}
        if not chosen.size:
            return found
        # the nearest point of a facet is within its size of one of its nodes
        largest = max(float(size.max()) for size in self.sizes.values())
        near = self._tree.query_ball_point(points[chosen], distances[chosen] + largest)
        count = len(self.members)
        lengths = [len(each) for each in near]
        is_near = sp.csr_array(
            (
                np.ones(sum(lengths)),
                np.concatenate([np.asarray(each, int) for each in near]),
                np.concatenate([[0], np.cumsum(lengths)]),
            ),
            (len(chosen), count),
        )
        place_of = np.zeros(len(self.nodes), int)
        place_of[self.members] = np.arange(count)
        for size, rows in self.facets.items():
            has = sp.csr_array(
                (
                    np.ones(rows.size),
                    (place_of[rows.ravel()], np.repeat(np.arange(len(rows)), size)),
                ),
                (count, len(rows)),
            )
            of_point, of_facet = (is_near @ has).nonzero()
            of_point = chosen[of_point]
            # a facet that is farther than the nearest node is not tried
            middle = self.nodes[rows].mean(axis=1)
            radius = np.linalg.norm(self.nodes[rows] - middle[:, None], axis=2).max(
                axis=1
            )
            away = np.linalg.norm(points[of_point] - middle[of_facet], axis=1)
            tried = away <= 1.1 * radius[of_facet] + distances[of_point]
            of_point, of_facet = of_point[tried], of_facet[tried]
            places, gaps = nearest_places(self.nodes[rows[of_facet]], points[of_point])
            for index, facet, place, gap in zip(
                of_point.tolist(), of_facet.tolist(), places, gaps.tolist(), strict=True
            ):
                found[index].append(_Candidate(gap, size, facet, place))
        return found

    def _in_facet(self, candidates: list[_Candidate]) -> Partner:
        """Return the nearest of the places in facets."""
        best = min(candidates, key=lambda each: each.distance)
        distance, size, index, place = best
        extent = float(self.sizes[size][index])
        # on an edge the mean of the facets there, weighted by their areas
        # two facets whose distances differ by less than this share of their size have the point
        # on their common edge
        same_distance = 1e-9
        tied = [
            candidate
            for candidate in candidates
            if candidate.distance <= distance + same_distance * extent
            and np.linalg.norm(self._position(candidate) - self._position(best))
            <= Pairing.matching * extent
        ]
        if len(tied) == 1:
            normal = self._normal(best)
        else:
            normal = np.sum(
                [self.areas[each.size][each.facet] for each in tied], axis=0
            )
            normal = normal / np.linalg.norm(normal)
        rows = self.facets[size][index]
        weights, _ = shape(size, place)
        carries = np.abs(weights) > same_distance
        weights = weights[carries] / weights[carries].sum()
        return Partner(
            rows[carries], weights, self._position(best), normal, extent, distance
        )

    def _position(self, candidate: _Candidate) -> np.ndarray:
        _, size, facet, place = candidate
        return np.asarray(shape(size, place)[0] @ self.nodes[self.facets[size][facet]])

    def _normal(self, candidate: _Candidate) -> np.ndarray:
        _, size, facet, place = candidate
        _, slopes = shape(size, place)
        along = self.nodes[self.facets[size][facet]].T @ slopes
        normal = np.cross(along[:, 0], along[:, 1])
        return np.asarray(normal / np.linalg.norm(normal))


def nearest_places(
    positions: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the point within each facet that is nearest to a point of its own, and its distance.

    Args:
        positions: of the nodes, (facets, nodes, 3).
        points: (facets, 3).

    Returns:
        ξ and η, (facets, 2), and distances, (facets,).
    """
    nodes = positions.shape[1]
    start = 1.0 / 3.0 if is_triangle(nodes) else 0.0
    place = np.full((len(positions), 2), start)
    for _ in range(Pairing.newton_steps):
        moved = _within(nodes, place + _step(positions, points, place))
        change = np.abs(moved - place).max(initial=0.0)
        place = moved
        if change < Pairing.rounding:
            break
    nearest = _distances(positions, points, place)
    for edge in _edges(nodes):
        on_edge = _along_edge(positions, points, edge)
        distance = _distances(positions, points, on_edge)
        closer = distance < nearest
        place[closer], nearest[closer] = on_edge[closer], distance[closer]
    return place, nearest


def _gaps(positions: np.ndarray, points: np.ndarray, place: np.ndarray) -> np.ndarray:
    values, _ = shape(positions.shape[1], place)
    return np.asarray(np.einsum("fnx,fn->fx", positions, values) - points)


def _distances(
    positions: np.ndarray, points: np.ndarray, place: np.ndarray
) -> np.ndarray:
    return np.asarray(np.linalg.norm(_gaps(positions, points, place), axis=1))


def _step(positions: np.ndarray, points: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Return the step of Gauss and Newton towards the foot of the perpendicular."""
    _, slopes = shape(positions.shape[1], place)
    along = np.einsum("fnx,fnd->fxd", positions, slopes)
    gap = _gaps(positions, points, place)
    square = np.einsum("fxd,fxe->fde", along, along)
    right = -np.einsum("fxd,fx->fd", along, gap)
    return np.asarray(np.linalg.solve(square, right[..., None])[..., 0])


def _within(nodes: int, place: np.ndarray) -> np.ndarray:
    """Return places moved into the facet."""
    if not is_triangle(nodes):
        return np.asarray(np.clip(place, -1.0, 1.0))
    place = np.maximum(place, 0.0)
    beyond = np.maximum(place.sum(axis=1) - 1.0, 0.0)
    return np.asarray(np.clip(place - 0.5 * beyond[:, None], 0.0, 1.0))


def _edges(nodes: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return begin and direction of the edges of a facet, by ξ and η."""
    corners = (
        np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        if is_triangle(nodes)
        else np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    )
    following = np.roll(corners, -1, axis=0)
    return [(one, other - one) for one, other in zip(corners, following, strict=True)]


def _along_edge(
    positions: np.ndarray, points: np.ndarray, edge: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Return the nearest place of one edge of each facet, (facets, 2), by Newton's method."""
    start, direction = edge
    along = np.full(len(positions), 0.5)
    for _ in range(Pairing.newton_steps):
        place = start + along[:, None] * direction
        _, slopes = shape(positions.shape[1], place)
        slope = np.einsum("fnx,fnd,d->fx", positions, slopes, direction)
        gap = _gaps(positions, points, place)
        step = -(gap * slope).sum(axis=1) / (slope**2).sum(axis=1)
        moved = np.clip(along + step, 0.0, 1.0)
        if np.abs(moved - along).max(initial=0.0) < Pairing.rounding:
            break
        along = moved
    return np.asarray(start + along[:, None] * direction)
