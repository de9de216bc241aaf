"""Contacts of two faces of a mesh.

Idea: each node of the rubbing surface carries its share of the area, the integral of its shape
function over the facets, and meets the nearest point of the other surface. Stiffness and preload
are shared by area; the normal is that of the other surface, and friction acts along its motion in
its tangent plane. Invariant: the forces of all points together are the integrals of pressure and
friction over a flat face, and with matching nodes so are their moments, since shape functions add
up to 1 and carry positions linearly. Cost: a search of the nearest facet for each node.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from squealpipe.laws.tables import scaled
from squealpipe.structures.contact import Contact, PointOrigin
from squealpipe.structures.meshes.element_mesh import ElementMesh, turned
from squealpipe.structures.meshes.faces import THE_BELT, Face, Rotation
from squealpipe.structures.meshes.merging import merged
from squealpipe.structures.meshes.pairing import FacetedSurface, Partner
from squealpipe.structures.meshes.shape_functions import shares
from squealpipe.systems.inputs.units import engineering


class _Point(NamedTuple):
    """One node of a face with what it meets.

    Attributes:
        node: index of the node.
        area: its share, m².
        partner: nearest point of the other surface; None on a rigid belt.
        normal, tangential: of the belt there, (3,).
        speed: at 1 rad/s, or of the belt over ``belt_speed``.
        pressure: Pa.
    """

    node: int
    area: float
    partner: Partner | None
    normal: np.ndarray
    tangential: np.ndarray
    speed: float
    pressure: float


class Freedoms:
    """Degrees of freedom of the matrices by node and direction.

    Args:
        mesh: nodes with their numbers.
        names: (n, 2), node number and direction of each row of the matrices.
    """

    def __init__(self, mesh: ElementMesh, names: np.ndarray) -> None:
        self.mesh = mesh
        self.row_of = {
            (node, direction): row
            for row, (node, direction) in enumerate(names.tolist())
        }

    def direction(self, node: int, vector: np.ndarray) -> dict[int, float]:
        """Return {row: coefficient} of a displacement of a node along a vector.

        Directions in which the node is held have no row: it does not move there.

        Args:
            node: index in the mesh.
            vector: (3,).
        """
        number = int(self.mesh.numbers[node])
        if number in self.mesh.turned:
            raise ValueError(
                f"node {number} has directions of its own (*TRANSFORM), which contacts do not "
                "know; leave that out for nodes of contacts"
            )
        rows: dict[int, float] = {}
        for axis, coefficient in enumerate(vector.tolist(), 1):
            row = self.row_of.get((number, axis))
            if row is not None:
                rows |= {row: coefficient} if coefficient else {}
            elif self.mesh.bound:
                raise ValueError(
                    f"node {number} has no degree of freedom {number}.{axis} in the matrices, "
                    f"which {', '.join(self.mesh.bound)} may have taken out; leave nodes of "
                    "contacts out of it"
                )
        return rows


def contacts_of(
    name: str,
    face: Face,
    mesh: ElementMesh,
    freedoms: Freedoms,
    rotation: Rotation | None,
) -> list[Contact]:
    """Return the contacts of a face, ``NAME_1`` and so on in ascending order of their nodes.

    Args:
        mesh: in m.

    Raises:
        ValueError: what is wrong, with the names of face, surfaces and nodes, and numbers.
    """
    points = _points(face, mesh, rotation)
    groups = _carriers(points, mesh, face)
    if face.points is not None and face.points < len(groups):
        groups = _merged(groups, points, mesh, face.points)
    area = sum(point.area for point in points)
    per_area = face.stiffness_per_area or (face.stiffness or 0.0) / area
    contacts = []
    for number, group in enumerate(groups, 1):
        label = f"{name}_{number}"
        members = [points[share] for share in group.shares]
        shared = np.array(list(group.shares.values()))
        forces = shared * [member.pressure for member in members]
        # several points act as one at the middle of their forces
        acting = forces if forces.sum() > 0 else shared
        weights = acting / acting.sum()
        normal: dict[int, float] = {}
        tangential: dict[int, float] = {}
        for each, weight in zip(members, weights, strict=True):
            _add(normal, freedoms, each, weight * each.normal)
            _add(tangential, freedoms, each, weight * each.tangential)
        for what, direction in (("normal", normal), ("sliding", tangential)):
            if not any(direction.values()):
                raise ValueError(
                    f"{label}: node {group.number} and what it meets are held along the {what} "
                    "direction; leave held nodes out of the surface, or give the matrices all "
                    "degrees of freedom of the faces"
                )
        contacts.append(
            Contact(
                label,
                normal,
                tangential,
                None if face.law else per_area * float(shared.sum()),
                float(forces.sum()),
                float(weights @ [member.speed for member in members]),
                mu=face.mu,
                origin=_origin(members, shared, weights, mesh),
                law=face.law and scaled(face.law, 1.0, area / float(shared.sum())),
                tangential_stiffness=face.tangential_stiffness
                and face.tangential_stiffness * float(shared.sum()) / area,
            )
        )
    return contacts


class _Group(NamedTuple):
    """Points that make one contact.

    Attributes:
        number: of the node that gives the contact its place in the order.
        shares: of the area, m², by place of the point; their sum is greater than 0.
    """

    number: int
    shares: dict[int, float]


def _carriers(points: list[_Point], mesh: ElementMesh, face: Face) -> list[_Group]:
    """Return the contacts before neighbours are merged, one for each node of positive area.

    Corners of quadratic quadrilaterals have negative shares, by which a force would pull. Each is
    carried by the middles of the edges beside it, half of a single facet's corner by each: the
    forces on all nodes stay the same.
    """
    place_of = {point.node: index for index, point in enumerate(points)}
    groups = {
        index: {index: point.area}
        for index, point in enumerate(points)
        if point.area > 0
    }
    rows = mesh.surface(face.surface).facets.get(8, np.empty((0, 8), int))
    beside: dict[int, dict[int, None]] = {}
    for corner in range(4):
        for middle in (4 + corner, 4 + (corner - 1) % 4):
            for node, carrier in zip(rows[:, corner], rows[:, middle], strict=True):
                beside.setdefault(int(node), {})[int(carrier)] = None
    for place, each in enumerate(points):
        if each.area > 0:
            continue
        carriers = [place_of[node] for node in beside[each.node]]
        for carrier in carriers:
            groups[carrier][place] = each.area / len(carriers)
    return [
        _Group(int(mesh.numbers[points[place].node]), shares)
        for place, shares in groups.items()
    ]


def _merged(
    groups: list[_Group], points: list[_Point], mesh: ElementMesh, count: int
) -> list[_Group]:
    """Return so many groups of neighbours."""
    positions = mesh.nodes[[point.node for point in points]]
    weights = np.array([sum(group.shares.values()) for group in groups])
    middles = np.array(
        [
            np.array(list(group.shares.values()))
            @ positions[list(group.shares)]
            / weight
            for group, weight in zip(groups, weights, strict=True)
        ]
    )
    numbers = np.array([group.number for group in groups])
    joined = []
    for members in merged(middles, weights, numbers, count):
        shares: dict[int, float] = {}
        for member in members:
            for place, share in groups[member].shares.items():
                shares[place] = shares.get(place, 0.0) + share
        joined.append(_Group(groups[members[0]].number, shares))
    return joined


def _add(
    direction: dict[int, float], freedoms: Freedoms, point: _Point, vector: np.ndarray
) -> None:
    """Add the motion of a point against what it meets."""
    terms = [(point.node, vector)]
    if point.partner is not None:
        terms += [
            (int(node), -weight * vector)
            for node, weight in zip(
                point.partner.nodes, point.partner.weights, strict=True
            )
        ]
    for node, part in terms:
        for row, coefficient in freedoms.direction(node, part).items():
            direction[row] = direction.get(row, 0.0) + coefficient


def _origin(
    points: list[_Point], shared: np.ndarray, weights: np.ndarray, mesh: ElementMesh
) -> PointOrigin:
    """Return how the contact of these points came about."""
    numbers = mesh.numbers
    partners = [(point, point.partner) for point in points if point.partner is not None]
    gaps = [
        (float((mesh.nodes[each.node] - met.position) @ each.normal), met.size)
        for each, met in partners
    ]
    gap, facet = max(gaps, key=lambda each: abs(each[0]), default=(0.0, np.nan))
    position = weights @ mesh.nodes[[point.node for point in points]]
    return PointOrigin(
        tuple(int(numbers[point.node]) for point in points),
        tuple(
            sorted({int(numbers[node]) for _, met in partners for node in met.nodes})
        ),
        float(shared.sum()),
        gap,
        tuple(position.tolist()),
        facet,
    )


def _points(face: Face, mesh: ElementMesh, rotation: Rotation | None) -> list[_Point]:
    """Return the nodes of the face with what they meet, in ascending order of their numbers."""
    surface = mesh.surface(face.surface)
    own = FacetedSurface(mesh.nodes, surface.facets)
    area = np.zeros(len(mesh.nodes))
    for rows in surface.facets.values():
        np.add.at(area, rows, shares(mesh.nodes[rows]))
    members = own.members[np.argsort(mesh.numbers[own.members])]
    # corners of quadratic triangles carry no area, but for round-off
    members = members[np.abs(area[members]) > 1e-9 * np.abs(area).max()]
    _refuse_opposite(own, members, mesh, face.surface)
    if face.against == THE_BELT:
        partners: list[Partner | None] = [None] * len(members)
        normals = -own.normals[members]
    else:
        other = mesh.surface(face.against)
        own, rubbed = _facing(own, surface.has_side, other, mesh)
        partners = list(rubbed.partners(mesh.nodes[members]))
        normals = np.array(
            [partner.normal for partner in partners if partner is not None]
        )
        _refuse_shared(partners, members, mesh, face)
        _refuse_gaps(partners, members, mesh, face)
        _refuse_facing(own.normals[members], normals, members, mesh, face)
    places = np.array(
        [
            mesh.nodes[node] if partner is None else partner.position
            for node, partner in zip(members, partners, strict=True)
        ]
    )
    sizes = own.node_sizes[members]
    tangentials, speeds = _motion(face, rotation, places, normals, sizes, members, mesh)
    pressures = _pressures(face, mesh.numbers[members], float(area[members].sum()))
    return [
        _Point(
            int(node),
            float(area[node]),
            partner,
            normals[index],
            tangentials[index],
            float(speeds[index]),
            float(pressures[index]),
        )
        for index, (node, partner) in enumerate(zip(members, partners, strict=True))
    ]


def _facing(own: FacetedSurface, has_side: bool, other: Any, mesh: ElementMesh) -> Any:
    """Return both surfaces; one of shells without a side is turned to face the other."""
    rubbed = FacetedSurface(mesh.nodes, other.facets)
    if has_side and other.has_side:
        return own, rubbed
    partners = rubbed.partners(mesh.nodes[own.members])
    towards = sum(
        float(own.normals[node] @ partner.normal)
        for node, partner in zip(own.members, partners, strict=True)
    )
    if towards <= 0:
        return own, rubbed
    if other.has_side:
        return FacetedSurface(mesh.nodes, _turned(own.facets)), rubbed
    return own, FacetedSurface(mesh.nodes, _turned(other.facets))


def _turned(facets: Mapping[int, np.ndarray]) -> dict[int, np.ndarray]:
    return {size: turned(rows) for size, rows in facets.items()}


def _refuse_opposite(
    surface: FacetedSurface, members: np.ndarray, mesh: ElementMesh, name: str
) -> None:
    # facets whose unit normals nearly cancel look opposite ways
    opposite = members[surface.agreement[members] < 0.2]
    if opposite.size:
        raise ValueError(
            f"{name}: facets at node {mesh.numbers[opposite[0]]} look in opposite directions "
            f"({opposite.size} nodes); give the surface one side of the body, and the nodes of its "
            "facets one sense"
        )


def _refuse_shared(
    partners: list[Partner | None], members: np.ndarray, mesh: ElementMesh, face: Face
) -> None:
    shared = [
        node
        for node, partner in zip(members, partners, strict=True)
        if partner is not None and node in partner.nodes
    ]
    if shared:
        first = mesh.numbers[shared[0]]
        raise ValueError(
            f"{face.surface} and {face.against} share {len(shared)} nodes, {first} the first, so "
            "that they cannot slide; give each body nodes of its own"
        )


def _refuse_gaps(
    partners: list[Partner | None], members: np.ndarray, mesh: ElementMesh, face: Face
) -> None:
    far = [
        (partner.distance, node, partner.size)
        for node, partner in zip(members, partners, strict=True)
        if partner is not None and partner.distance > partner.size
    ]
    if far:
        distance, node, size = max(far)
        raise ValueError(
            f"{face.surface}: {len(far)} of {len(members)} nodes have no partner on {face.against} "
            f"within the size of its facets; node {mesh.numbers[node]} is "
            f"{engineering(distance, 'm')} from it, its facet is {engineering(size, 'm')} long; "
            "move the bodies together, leave these nodes out of the surface, or state the units of "
            "the mesh"
        )


def _refuse_facing(
    own: np.ndarray,
    other: np.ndarray,
    members: np.ndarray,
    mesh: ElementMesh,
    face: Face,
) -> None:
    cosines = np.einsum("ij,ij->i", own, other)
    # cosine of 120°: normals of surfaces that face each other are within 60° of opposite
    wrong = np.flatnonzero(cosines > -0.5)
    if wrong.size:
        worst = wrong[cosines[wrong].argmax()]
        angle = np.degrees(np.arccos(np.clip(cosines[worst], -1.0, 1.0)))
        raise ValueError(
            f"{face.surface} and {face.against} do not face each other at {wrong.size} of "
            f"{len(members)} nodes: at node {mesh.numbers[members[worst]]} their outward normals "
            f"are {angle:.0f}° apart, where 180° is opposite; choose the faces that touch, or turn "
            "the order of the nodes of facets that you gave"
        )


def _motion(
    face: Face,
    rotation: Rotation | None,
    places: np.ndarray,
    normals: np.ndarray,
    sizes: np.ndarray,
    members: np.ndarray,
    mesh: ElementMesh,
) -> tuple[np.ndarray, np.ndarray]:
    """Return directions in which the belt moves, (points, 3), and its speeds, (points,)."""
    # a point nearer to the axis of rotation than this share of its facet's size has no direction
    # of sliding
    on_the_axis = 1e-6
    if face.direction is not None:
        if rotation is not None:
            raise ValueError(
                "direction and rotation are both given; leave out the direction, which follows "
                "from the rotation"
            )
        velocity = np.broadcast_to(
            np.asarray(face.direction) / np.linalg.norm(face.direction), places.shape
        )
        speeds = np.ones(len(places))
    elif rotation is not None:
        velocity = rotation.velocity(places)
        if rotation.body is not None and rotation.body.upper() == face.surface.upper():
            velocity = (
                -velocity
            )  # what rubs turns, and sees the other one move backwards
        speeds = np.linalg.norm(velocity, axis=1)
        on_axis = np.flatnonzero(speeds <= on_the_axis * sizes)
        if on_axis.size:
            raise ValueError(
                f"the axis of rotation goes through {face.surface} at node "
                f"{mesh.numbers[members[on_axis[0]]]} (radius "
                f"{engineering(float(speeds[on_axis[0]]), 'm')}), where nothing slides; check "
                "`axis` and `through`, or leave this node out of the surface"
            )
    else:
        raise ValueError(
            f"nothing says how {face.against} moves; give a rotation, or "
            "`direction: [1, 0, 0]` of the face"
        )
    along = np.einsum("ij,ij->i", velocity, normals)
    tangential = velocity - along[:, None] * normals
    lengths = np.linalg.norm(tangential, axis=1)
    across = np.flatnonzero(lengths <= on_the_axis * np.linalg.norm(velocity, axis=1))
    if across.size:
        raise ValueError(
            f"{face.against} moves along its normal at node "
            f"{mesh.numbers[members[across[0]]]} of {face.surface}, where it cannot slide; check "
            "the direction or the axis of rotation"
        )
    return tangential / lengths[:, None], speeds


def _pressures(face: Face, numbers: np.ndarray, area: float) -> np.ndarray:
    """Return the pressure at each node, Pa."""
    if face.pressure is not None:
        return np.full(len(numbers), face.pressure)
    if face.force is not None:
        return np.full(len(numbers), face.force / area)
    given: Any = face.pressures
    missing = [number for number in numbers.tolist() if number not in given]
    if missing:
        raise ValueError(
            f"pressures: {len(missing)} nodes of {face.surface} have none, node {missing[0]} the "
            "first; give 0 where nothing presses"
        )
    pressures = np.array([given[number] for number in numbers.tolist()], float)
    if not (pressures >= 0).all() or not pressures.any():
        lowest = int(numbers[pressures.argmin()])
        raise ValueError(
            f"pressures: {pressures.min():g} at node {lowest}; 0 or greater is needed, and greater "
            "than 0 somewhere"
        )
    return pressures
