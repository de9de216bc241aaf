"""A mesh as a structure keeps it: nodes, the facets that a picture draws, and what moves."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

NO_NODE = -1
"""Index where a facet has fewer corners, or where a degree of freedom is at no node."""
AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class StructureMesh:
    """Nodes and facets of a structure, with the node and direction of each degree of freedom.

    Args:
        nodes: positions, (nodes, 3), m; two columns are a plane, z = 0.
        facets: surface facets or lines by the indices of their corners from 0, one row each; rows
            may differ in length, or be filled with −1.
        degree_of_freedom: (n, 2): index of the node and direction of each degree of freedom;
            directions 1 to 3 are displacements along x, y, z, and 4 to 6 rotations about them. The
            index is −1 where a degree of freedom is at no node.
        numbers: of the nodes in their program, (nodes,); 1, 2, … by default.
        sets: node sets, name → numbers of nodes.

    Raises:
        ValueError: indices of nodes that there are not, or arrays of another shape.
    """

    nodes: Any
    facets: Any
    degree_of_freedom: Any
    numbers: Any = None
    sets: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        nodes = np.asarray(self.nodes, dtype=float)
        if nodes.ndim != 2 or nodes.shape[1] not in (2, 3):
            raise ValueError(
                f"mesh: nodes have shape {nodes.shape}; (nodes, 3) is needed, in m"
            )
        nodes = np.pad(nodes, ((0, 0), (0, 3 - nodes.shape[1])))
        if not np.isfinite(nodes).all():
            raise ValueError(
                f"mesh: node {int(np.argwhere(~np.isfinite(nodes))[0, 0])}, counted from 0, has a "
                "position that is not finite"
            )
        facets = padded(self.facets)
        freedoms = np.asarray(self.degree_of_freedom, dtype=int)
        if freedoms.ndim != 2 or freedoms.shape[1] != 2:
            raise ValueError(
                f"mesh: degree_of_freedom has shape {freedoms.shape}; (n, 2) is needed, index of "
                "the node and direction"
            )
        numbers = np.arange(1, len(nodes) + 1) if self.numbers is None else self.numbers
        numbers = np.asarray(numbers, dtype=int)
        if numbers.shape != (len(nodes),):
            raise ValueError(
                f"mesh: {numbers.size} numbers of {len(nodes)} nodes; one each is needed"
            )
        for what, indices in (
            ("facets", facets),
            ("degree_of_freedom", freedoms[:, 0]),
        ):
            if indices.size and not NO_NODE <= indices.min() <= indices.max() < len(
                nodes
            ):
                raise ValueError(
                    f"mesh: {what} name nodes {indices.min()} to {indices.max()}; there are 0 to "
                    f"{len(nodes) - 1}"
                )
        for key, value in (
            ("nodes", nodes),
            ("facets", facets),
            ("degree_of_freedom", freedoms),
            ("numbers", numbers),
        ):
            object.__setattr__(self, key, value)

    @property
    def names(self) -> list[str]:
        """Names ``node.direction`` of all degrees of freedom; ``row 12`` where one is at no node.

        CalculiX adds nodes of its own, which no mesh lists, for the incompatible modes of C3D8I.
        """
        return [
            f"row {row}" if node == NO_NODE else f"{self.numbers[node]}.{direction}"
            for row, (node, direction) in enumerate(self.degree_of_freedom.tolist(), 1)
        ]

    def rows_at(self, place: str | None = None) -> np.ndarray:
        """Return the rows that are displacements, of all nodes or of one: ``"12"``, ``"12.3"``."""
        node, direction = self.degree_of_freedom.T
        moves = (node != NO_NODE) & (direction <= len(AXES))
        if place is not None:
            number, _, way = place.partition(".")
            moves &= self.numbers[node] == (int(number) if number.isdigit() else -1)
            if way:
                moves &= direction == (int(way) if way.isdigit() else 0)
        return np.flatnonzero(moves)

    def displacements(self, values: Any) -> np.ndarray:
        """Return displacements of the nodes, (nodes, 3, …), from values of all degrees of freedom.

        Nodes that do not move (held ones) and rotations have none.

        Args:
            values: (n, …), real or complex.
        """
        values = np.asarray(values)
        rows = self.rows_at()
        node, direction = self.degree_of_freedom[rows].T
        moved = np.zeros((len(self.nodes), len(AXES), *values.shape[1:]), values.dtype)
        moved[node, direction - 1] = values[rows]
        return moved

    def center(self, direction: np.ndarray) -> np.ndarray:
        """Return the mean position of the nodes that a direction over all degrees of freedom moves.

        Args:
            direction: (n,); each node counts by its coefficients.

        Returns:
            (3,), m; NaN where it moves no node of the mesh.
        """
        node = self.degree_of_freedom[:, 0]
        weights = np.where(node == NO_NODE, 0.0, np.abs(direction))
        if not weights.any():
            return np.full(3, np.nan)
        return np.average(self.nodes[node], axis=0, weights=weights)


def padded(rows: Any) -> np.ndarray:
    """Return rows of indices as one array, (rows, longest), filled with −1.

    Args:
        rows: an array, or a sequence of sequences or of arrays (facets, corners).
    """
    if isinstance(rows, np.ndarray):
        return np.asarray(rows, dtype=int).reshape(len(rows), -1)
    flat: list[Sequence[int]] = []
    for each in rows:
        block = np.asarray(each, dtype=int)
        flat += [block.tolist()] if block.ndim == 1 else block.tolist()
    longest = max(map(len, flat), default=0)
    return np.array(
        [[*row, *[NO_NODE] * (longest - len(row))] for row in flat], int
    ).reshape(len(flat), longest)
