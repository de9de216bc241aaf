"""Modifications of a structure that somebody names: masses, springs and dashpots."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import scipy.sparse as sp

from squealpipe.parameters import finite_number
from squealpipe.structures.definition import ContactStructure
from squealpipe.systems.inputs.values import brief, is_whole_number
from squealpipe.text import suggestion

MATRICES = {
    "added_mass": ("mass", "kg"),
    "spring": ("stiffness", "N m-1"),
    "dashpot": ("damping", "N s m-1"),
}
"""Kind of modification → the matrix that it changes, and its unit."""


@dataclass(frozen=True, eq=False)
class Modification:
    """A change of one matrix, up to an amount.

    Attributes:
        matrix: name of the matrix.
        change: of the matrix, per unit of the amount, (n, n).
        most: largest amount that is tried, at the first entry.
        unit: CF unit of the amount.
    """

    matrix: str
    change: sp.csr_array
    most: float
    unit: str

    @classmethod
    def read(cls, name: str, content: Any, structure: ContactStructure) -> Self:
        """Read a modification of a structure, like ``{"added_mass": {1: 0.1}}``.

        Args:
            content: ``added_mass``: {degree of freedom: kg}; ``spring`` or ``dashpot``: {(a, b):
                N/m or N s/m} between two degrees of freedom, or {a: …} to the ground. The largest
                amount is that of the first entry; the others go along in proportion.

        Raises:
            ValueError: names the modification, and what is wrong with it.
        """
        title = f"modifications: {name}"
        if not isinstance(content, Mapping) or len(content) != 1:
            raise ValueError(
                f"{title} = {brief(content)}: one of {', '.join(MATRICES)} is needed, like "
                "{'added_mass': {1: 0.1}}"
            )
        ((kind, entries),) = content.items()
        if kind not in MATRICES:
            raise ValueError(f"{title}: {suggestion(str(kind), list(MATRICES))}")
        if not isinstance(entries, Mapping) or not entries:
            raise ValueError(
                f"{title}: {kind} = {brief(entries)}: {{degree of freedom: amount}} is needed"
            )
        matrix, unit = MATRICES[kind]
        amounts = {
            place: finite_number(f"{title}: {kind}[{place!r}]", amount, unit)
            for place, amount in entries.items()
        }
        for place, amount in amounts.items():
            if not amount > 0.0:
                raise ValueError(
                    f"{title}: {kind}[{place!r}] = {amount!r}: it must be greater than 0"
                )
        most = next(iter(amounts.values()))
        change = sp.csr_array((structure.size, structure.size))
        for place, amount in amounts.items():
            for column in _columns(f"{title}: {kind}", kind, place, structure):
                part = sp.csr_array(column[:, None])
                change = change + (amount / most) * (part @ part.T)
        return cls(matrix, sp.csr_array(change), most, unit)

    def of(self, structure: ContactStructure, amount: float) -> ContactStructure:
        """Return the structure with so much of it."""
        matrix = getattr(structure, self.matrix) + amount * self.change
        return structure.with_(**{self.matrix: matrix})


def _columns(
    title: str, kind: str, place: Any, structure: ContactStructure
) -> list[np.ndarray]:
    """Return vectors v of the change Σ v vᵀ: of a mass one each, of a spring one between two."""
    if isinstance(place, tuple):
        if kind == "added_mass" or len(place) != 2:
            raise ValueError(
                f"{title}[{place!r}]: "
                + (
                    "a mass is at one degree of freedom"
                    if kind == "added_mass"
                    else "two degrees of freedom are needed, like (0, 5)"
                )
            )
        first, second = (
            freedoms_of(f"{title}[{place!r}]", each, structure) for each in place
        )
        if len(first) != len(second) or first == second:
            raise ValueError(
                f"{title}[{place!r}]: two different degrees of freedom, or two nodes, are needed"
            )
        return [
            _unit(one, structure.size) - _unit(other, structure.size)
            for one, other in zip(first, second, strict=True)
        ]
    return [_unit(one, structure.size) for one in freedoms_of(title, place, structure)]


def _unit(place: int, size: int) -> np.ndarray:
    vector = np.zeros(size)
    vector[place] = 1.0
    return vector


def freedoms_of(title: str, place: Any, structure: ContactStructure) -> list[int]:
    """Return the degrees of freedom of a place: a number from 0, or a node of the mesh.

    Args:
        place: 12 is the degree of freedom, counted from 0; ``"5005"`` is a node in all directions
            of displacement, ``"5005.3"`` one of them.

    Raises:
        ValueError: there is no such degree of freedom or node.
    """
    if is_whole_number(place):
        if not 0 <= place < structure.size:
            raise ValueError(
                f"{title}[{place!r}]: degrees of freedom are 0 to {structure.size - 1}"
            )
        return [int(place)]
    node, _, direction = str(place).partition(".")
    mesh = structure.mesh
    if not isinstance(place, str) or not node.isdigit():
        raise ValueError(
            f"{title}[{place!r}]: a degree of freedom counted from 0, or a node like '5005' or "
            "'5005.3' is needed"
        )
    if mesh is None:
        raise ValueError(
            f"{title}[{place!r}]: the structure has no mesh, so nodes have no numbers; give the "
            "degree of freedom, counted from 0, as a number"
        )
    index, way = mesh.degree_of_freedom.T
    numbers = np.where(index >= 0, np.asarray(mesh.numbers)[index], -1)
    chosen = (numbers == int(node)) & (way <= 3)
    if direction:
        chosen &= way == (int(direction) if direction.isdigit() else 0)
    if not chosen.any():
        raise ValueError(
            f"{title}[{place!r}]: the structure has no such node or direction"
        )
    return [int(each) for each in np.flatnonzero(chosen)]
