"""Kinds of finite elements: how many nodes they have, and which of them each face has.

Node orders are those of Abaqus and CalculiX, which for the kinds below are VTK's and meshio's too.
"""

import re
from itertools import pairwise
from typing import NamedTuple


class Kind(NamedTuple):
    """A kind of element.

    Attributes:
        nodes: number of nodes.
        faces: places of the nodes of each face, corners first and then the middles of its edges.
        is_shell: whether the element is a face itself, with two sides.
    """

    nodes: int
    faces: tuple[tuple[int, ...], ...]
    is_shell: bool = False


def _quadratic(
    faces: tuple[tuple[int, ...], ...], corners: int, edges: tuple[tuple[int, int], ...]
) -> tuple[tuple[int, ...], ...]:
    """Return faces with the middles of their edges.

    Args:
        edges: of the element, in the order in which their middles follow its corners.
    """
    middles = {frozenset(edge): corners + index for index, edge in enumerate(edges)}
    return tuple(
        (*face, *(middles[frozenset(edge)] for edge in pairwise((*face, face[0]))))
        for face in faces
    )


_TETRA = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))
_WEDGE = ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0))
_HEXA = (
    (0, 1, 2, 3),
    (4, 7, 6, 5),
    (0, 4, 5, 1),
    (1, 5, 6, 2),
    (2, 6, 7, 3),
    (3, 7, 4, 0),
)
_TETRA_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_WEDGE_EDGES = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
_HEXA_EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0)),
    *((4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
ELEMENTS = {
    "tetra": Kind(4, _TETRA),
    "wedge": Kind(6, _WEDGE),
    "hexahedron": Kind(8, _HEXA),
    "tetra10": Kind(10, _quadratic(_TETRA, 4, _TETRA_EDGES)),
    "wedge15": Kind(15, _quadratic(_WEDGE, 6, _WEDGE_EDGES)),
    "hexahedron20": Kind(20, _quadratic(_HEXA, 8, _HEXA_EDGES)),
    "triangle": Kind(3, (tuple(range(3)),), is_shell=True),
    "quad": Kind(4, (tuple(range(4)),), is_shell=True),
    "triangle6": Kind(6, (tuple(range(6)),), is_shell=True),
    "quad8": Kind(8, (tuple(range(8)),), is_shell=True),
}
"""Elements by meshio's name."""
CORNERS = {3: 3, 4: 4, 6: 3, 8: 4}
"""Number of nodes of a face → number of its corners."""


def kind_in_deck(element_type: str) -> str | None:
    """Return the kind of an element type of Abaqus or CalculiX; None if it makes no face."""
    # names of Abaqus and CalculiX → meshio's name; gmsh marks surfaces of solids by CPS3
    deck_types = {
        r"C3D4[A-Z]*": "tetra",
        r"C3D6[A-Z]*|SC6R[A-Z]*": "wedge",
        r"C3D8[A-Z]*|SC8R[A-Z]*": "hexahedron",
        r"C3D10[A-Z]*": "tetra10",
        r"C3D15[A-Z]*": "wedge15",
        r"C3D20[A-Z]*": "hexahedron20",
        r"S3[A-Z]*|STRI3|M3D3|CP[SE]3": "triangle",
        r"S4[A-Z]*5?|M3D4R?|CP[SE]4": "quad",
        r"S6|STRI65|M3D6|CP[SE]6": "triangle6",
        r"S8[A-Z]*5?|M3D8R?|CP[SE]8": "quad8",
    }
    for pattern, name in deck_types.items():
        if re.fullmatch(pattern, element_type):
            return name
    return None
