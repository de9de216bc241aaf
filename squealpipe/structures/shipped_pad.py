"""An elastic pad in plane strain on a belt, hung by springs along its upper edge."""

from functools import partial

import numpy as np
import scipy.sparse as sp

from squealpipe.structures.contact import Contact
from squealpipe.structures.meshes.structure_mesh import StructureMesh
from squealpipe.structures.multilinear_elements import mass_and_stiffness
from squealpipe.structures.structure import Structure
from squealpipe.validation import Natural, NotNegative, Number, Positive, checked

YOUNG = 8e9
"""Modulus, density and Poisson's ratio of a friction material: Pa, kg/m³, 1."""

PAD_UNITS = {
    **dict.fromkeys(("length", "height", "depth"), "m"),
    "young": "Pa",
    "contact_stiffness": "N m-1",
    "preload": "N",
    "mu": "1",
    "belt_speed": "m s-1",
    "modal_damping": "1",
}
"""CF units of the pad's numbers."""


@partial(checked, units=PAD_UNITS)
def elastic_pad(
    length: Positive = 0.06,
    height: Positive = 0.015,
    depth: Positive = 0.05,
    elements: tuple[Natural, Natural] = (24, 6),
    contacts: Natural = 4,
    *,
    young: Positive = YOUNG,
    contact_stiffness: Positive = 8e8,
    preload: NotNegative = 800.0,
    mu: NotNegative = 0.5,
    belt_speed: Number = 2.0,
    modal_damping: NotNegative = 0.0,
) -> Structure:
    """A rectangular pad of bilinear elements (2 × 2 points, consistent mass).

    Its upper edge is on springs of 3e7 N/m along the belt and 5e7 N/m across, spread over the
    nodes, half as much at both ends. Degrees of freedom are x and y of node after node.

    Args:
        length, height, depth: along, across and out of the plane, m.
        elements: along and across.
        contacts: points ``p1``… equally spaced from edge to edge, ``p1`` at x = 0, which the belt
            meets first; a single one is in the middle. Between nodes a point has both.
        young: modulus of elasticity, Pa.
        contact_stiffness, preload: of all points together, N/m and N.
        mu, belt_speed, modal_damping: as of :class:`Structure`.

    Raises:
        ValueError: an argument; more contacts than nodes along the edge.
    """
    if contacts > elements[0] + 1:
        raise ValueError(
            f"contacts = {contacts}: at most {elements[0] + 1}, one a node, are independent"
        )
    x = np.linspace(0.0, length, elements[0] + 1)
    y = np.linspace(0.0, height, elements[1] + 1)
    nodes = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    # nodes column by column, from the belt up
    grid = np.arange(len(nodes)).reshape(len(x), len(y))
    quads = [grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]]
    corners = np.stack(quads, axis=-1).reshape(-1, 4)
    # kg/m³, of a friction material
    density = 2500.0
    # of a friction material
    poisson_ratio = 0.25
    mass, stiffness = mass_and_stiffness(
        nodes, corners, young=young, poisson=poisson_ratio, density=density, depth=depth
    )
    share = np.full((len(x), 1), 1.0 / elements[0])
    share[[0, -1]] *= 0.5
    springs = np.zeros(nodes.shape)
    # total stiffness of the springs on the upper edge, along and across the belt, N/m
    support = (3e7, 5e7)
    springs[grid[:, -1]] = support * share
    lower = grid[:, 0]
    places = np.linspace(0.0, length, contacts) if contacts > 1 else [0.5 * length]
    points = []
    for number, place in enumerate(places, 1):
        weights = _between(float(place) / length * elements[0], len(lower))
        points.append(
            Contact(
                f"p{number}",
                # N acts away from the belt, along +y; friction along +x
                normal={int(2 * lower[i] + 1): w for i, w in weights.items()},
                tangential={int(2 * lower[i]): w for i, w in weights.items()},
                stiffness=contact_stiffness / contacts,
                preload=preload / contacts,
            )
        )
    directions = np.tile([1, 2], len(nodes))
    freedoms = np.column_stack([np.repeat(np.arange(len(nodes)), 2), directions])
    return Structure(
        mass,
        stiffness + sp.diags_array(springs.ravel()),
        mesh=StructureMesh(nodes, corners, freedoms),
        modal_damping=modal_damping,
        contacts=points,
        mu=mu,
        belt_speed=belt_speed,
    )


def _between(place: float, nodes: int) -> dict[int, float]:
    """Linear shape functions at a place in units of elements, without those that are 0."""
    place = round(place, 9)
    left = min(int(place), nodes - 2)
    weights = {left: left + 1 - place, left + 1: place - left}
    return {node: weight for node, weight in weights.items() if weight}
