"""Merge neighbouring contacts of each face, and measure what fewer contacts change."""

import json
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.schema import Outcome, build
from squealpipe.structures.contact import Contact, PointOrigin, face_of
from squealpipe.structures.meshes.merging import merged
from squealpipe.structures.schema.fewer_points import fewer_points_schema
from squealpipe.structures.sliding import NoSlidingError
from squealpipe.systems.datasets.versions import versions
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
    for contact in structure.contacts:
        name = contact.name if contact.origin is None else face_of(contact.name)
        faces.setdefault(name or contact.name, []).append(contact)
    contacts: list[Contact] = []
    for name, members in faces.items():
        if len(members) <= points:
            contacts += members
            continue
        groups = merged(
            np.array([_origin(member).position for member in members]),
            np.array([_origin(member).area for member in members]),
            np.array([_origin(member).nodes[0] for member in members]),
            int(points),
        )
        contacts += [
            _joined(
                f"{name}_{number}", [members[place] for place in group], structure.size
            )
            for number, group in enumerate(groups, 1)
        ]
    return structure.with_(contacts=contacts)


def fewer_points(structure: Any, *, frequency_max: float | None = None) -> xr.Dataset:
    """Unstable modes with 1, 2, 3, 4, 6, 8, 12, … and all contact points of each face of a mesh.

    Args:
        structure: a :class:`squealpipe.Structure` with contacts from faces, not reduced.
        frequency_max: modes up to there, Hz; needed beyond 1000 degrees of freedom.

    Returns:
        Dataset ``fewer_points`` over ``points``, the last of which is the structure as it is: the
        modes that grow at its own friction and speed, the largest growth rate and its frequency.
        Outcomes: converged, no_sliding_state, unresolved (modes in the band may be missing).

    Raises:
        ValueError: no contact comes from a mesh; a reduced structure; an argument.
    """
    of_faces = Counter(
        face_of(contact.name) or contact.name
        for contact in structure.contacts
        if contact.origin is not None
    )
    if not of_faces:
        raise ValueError(
            "no contact comes from a face of a mesh, so none can be merged; name faces in "
            "`contacts:`, or use Structure.from_mesh"
        )
    most = max(of_faces.values())
    # powers of two and the numbers halfway: growth does not change steadily with their number
    powers = [2**power for power in range((most - 1).bit_length())]
    between = [3 * power // 2 for power in powers if power > 1]
    points = sorted({most, *(point for point in powers + between if point < most)})
    rows = [_growing(structure.with_points(point), frequency_max) for point in points]
    return build(
        fewer_points_schema,
        {name: np.array([row[name] for row in rows]) for name in rows[0]},
        {"points": points},
        {
            "made_by": "squealpipe.structures.fewer_points.fewer_points",
            "model": "linear about steady sliding",
            "method": "complex modes",
            "tolerance": "round-off",
            "parameters": json.dumps(structure.as_dict()),
            "arguments": json.dumps({"frequency_max": frequency_max}),
            **versions(),
        },
    )


def _growing(structure: Any, frequency_max: float | None) -> dict[str, float]:
    """Return the row of one number of points."""
    row = {
        "contacts": len(structure.contacts),
        "unstable_modes": 0,
        "growth_rate": np.nan,
        "frequency": np.nan,
    }
    try:
        modes = structure.complex_modes(frequency_max=frequency_max, critical=False)
    except NoSlidingError:
        return row | {"outcome": Outcome.no_sliding_state}
    except RuntimeError:  # modes in the band may be missing
        return row | {"outcome": Outcome.unresolved}
    unstable = modes.unstable.values
    if unstable.any():
        growing = modes.isel(mode=np.flatnonzero(unstable))
        fastest = growing.isel(mode=int(growing.growth_rate.values.argmax()))
        row |= {
            "unstable_modes": int(unstable.sum()),
            "growth_rate": float(fastest.growth_rate),
            "frequency": float(fastest.frequency),
        }
    return row | {"outcome": Outcome.converged}


def _origin(contact: Contact) -> PointOrigin:
    if contact.origin is None:
        raise ValueError(f"contact {contact.name} comes from no mesh")
    return contact.origin


def _joined(name: str, members: list[Contact], size: int) -> Contact:
    """Return one contact in place of several."""
    forces = np.array([member.preload for member in members])
    stiffnesses = np.array([member.stiffness_at_preload for member in members])
    law = _joined_law(members)
    acting = forces if forces.sum() > 0 else stiffnesses
    weights = acting / acting.sum()
    origins = [_origin(member) for member in members]
    widest = max(origins, key=lambda origin: abs(origin.gap))
    directions = {
        which: weights @ [member.direction(which, size) for member in members]
        for which in ("normal", "tangential")
    }
    return replace(
        members[0],
        name=name,
        normal=directions["normal"],
        tangential=directions["tangential"],
        stiffness=float(stiffnesses.sum()) if law is None else None,
        law=law,
        tangential_stiffness=_joined_springs(members),
        preload=float(forces.sum()),
        speed=float(weights @ [member.speed for member in members]),
        origin=PointOrigin(
            tuple(node for origin in origins for node in origin.nodes),
            tuple(sorted({node for origin in origins for node in origin.against})),
            sum(origin.area for origin in origins),
            widest.gap,
            tuple((weights @ [origin.position for origin in origins]).tolist()),
            widest.facet,
        ),
    )


def _joined_springs(members: list[Contact]) -> float | None:
    """Return the tangential stiffness of several contacts that move together; None: rigid."""
    springs = [member.tangential_stiffness for member in members]
    if None in springs:
        return None
    return float(sum(spring for spring in springs if spring is not None))


def _joined_law(members: list[Contact]) -> str | None:
    """Return the law of several contacts that move together; None if all are linear."""
    if all(member.law is None for member in members):
        return None
    # compressions of all, from that at which the first touches
    free = max(member.compression for member in members)
    starts = np.concatenate(
        [member.lines[:, 0] + free - member.compression for member in members]
    )
    knots = np.unique(starts)
    kept = np.diff(knots, prepend=-np.inf) > 1e-12 * max(knots[-1], free)
    # the last slope goes on from a point beyond all others
    knots = np.append(knots[kept], knots[-1] + (max(knots[-1], free) or 1.0))
    forces = [
        sum(max(float(member.force(at - free)), 0.0) for member in members)
        for at in knots
    ]
    pairs = zip(knots.tolist(), forces, strict=True)
    return "linear" + "".join(f" {knot!r}:{force!r}" for knot, force in pairs)
