"""The same structure with fewer contacts: neighbours of each face merged."""

from dataclasses import replace
from typing import Any

import numpy as np

from squealpipe.structures.contact import Contact, PointOrigin
from squealpipe.structures.meshes.merging import merged
from squealpipe.structures.varied_friction import face_of
from squealpipe.systems.inputs.values import brief, is_whole_number


def with_points(structure: Any, points: int) -> Any:
    """Return the structure with so many contacts for each face of a mesh.

    Neighbours act as one at the middle of their forces: stiffness, force and first moments of the
    face stay. Faces of fewer contacts, and contacts that come from no mesh, stay as they are.

    Args:
        points: contacts for each face, at most.

    Raises:
        ValueError: no whole number from 1 on, or a reduced structure.
    """
    if not is_whole_number(points) or points < 1:
        raise ValueError(
            f"points = {brief(points)}: a whole number from 1 on is needed"
        )
    if structure.modes is not None:
        raise ValueError(
            "contacts of a reduced structure act on its modes; merge those of the whole"
        )
    faces: dict[str, list[Contact]] = {}
    for each in structure.contacts:
        name = each.name if each.origin is None else face_of(each.name)
        faces.setdefault(name or each.name, []).append(each)
    contacts: list[Contact] = []
    for name, members in faces.items():
        if len(members) <= points:
            contacts += members
            continue
        groups = merged(
            np.array([_origin(each).position for each in members]),
            np.array([_origin(each).area for each in members]),
            np.array([_origin(each).nodes[0] for each in members]),
            int(points),
        )
        contacts += [
            _joined(
                f"{name}_{number}", [members[place] for place in group], structure.size
            )
            for number, group in enumerate(groups, 1)
        ]
    return structure.with_(contacts=contacts)


def _origin(contact: Contact) -> PointOrigin:
    if contact.origin is None:
        raise ValueError(f"contact {contact.name} comes from no mesh")
    return contact.origin


def _joined(name: str, members: list[Contact], size: int) -> Contact:
    """Return one contact in place of several."""
    forces = np.array([each.preload for each in members])
    stiffnesses = np.array([each.stiffness for each in members])
    acting = forces if forces.sum() > 0 else stiffnesses
    weights = acting / acting.sum()
    origins = [_origin(each) for each in members]
    directions = {
        which: weights @ [each.direction(which, size) for each in members]
        for which in ("normal", "tangential")
    }
    return replace(
        members[0],
        name=name,
        normal=directions["normal"],
        tangential=directions["tangential"],
        stiffness=float(stiffnesses.sum()),
        preload=float(forces.sum()),
        speed=float(weights @ [each.speed for each in members]),
        origin=PointOrigin(
            tuple(node for each in origins for node in each.nodes),
            tuple(sorted({node for each in origins for node in each.against})),
            sum(each.area for each in origins),
            max((each.gap for each in origins), key=abs),
            tuple((weights @ [each.position for each in origins]).tolist()),
        ),
    )
