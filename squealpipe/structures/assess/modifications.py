"""Modifications of a structure that somebody names: masses, springs, dashpots, shims, chamfers.

A patch is a shim on some nodes. Its mass is shared equally among them. Its damping acts where the
patch deforms and not where it moves as a rigid body: C += (2 ζ/ω) Q K Q with the stiffness K of the
patch's degrees of freedom, Q taking rigid motions out and ω of the mode that grows fastest, so that
a motion that the patch carries alone has the damping ratio ζ at that frequency.

A chamfer removes points of a face at the end that meets the belt first. The points that are next to
go lose stiffness and preload in proportion to the share, so that everything changes continuously;
the remaining ones carry the whole force, which comes from the piston.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
import scipy.sparse as sp

from squealpipe.parameters import finite_number
from squealpipe.structures.contact import face_of
from squealpipe.structures.definition import ContactStructure
from squealpipe.systems.inputs.values import brief, is_whole_number
from squealpipe.systems.inputs.words import suggestion

MATRICES = {
    "added_mass": ("mass", "kg"),
    "spring": ("stiffness", "N m-1"),
    "dashpot": ("damping", "N s m-1"),
}
"""Kind of modification → the matrix that it changes, and its unit."""
FORMS = {
    **dict.fromkeys(MATRICES, "{degree of freedom: amount}"),
    "patch": "{'nodes': 'SHIM', 'mass': 0.2, 'damping_ratio': 0.05}",
    "chamfer": "{'face': 'lining', 'share': 0.2}",
}
"""Kind of modification → how it is written."""


class Modification(Protocol):
    """A change of a structure, up to an amount."""

    @property
    def most(self) -> float:
        """Largest amount that is tried."""

    @property
    def unit(self) -> str:
        """CF unit of the amount."""

    def of(self, structure: ContactStructure, amount: float) -> ContactStructure:
        """Return the structure changed by this amount."""


def read_modification(
    name: str,
    content: Any,
    structure: ContactStructure,
    frequency: float,
    *,
    first: int = 0,
) -> Modification:
    """Read a modification of a structure, like ``{"added_mass": {1: 0.1}}``.

    Args:
        content: ``added_mass``: {degree of freedom: kg}; ``spring`` or ``dashpot``: {(a, b): N/m or
            N s/m} between two degrees of freedom, or {a: …} to the ground; the largest amount is
            that of the first entry, and the others go along in proportion. ``patch``: {"nodes": a
            node set, a face or a list of node numbers, "mass": kg, "damping_ratio": …}, one of the
            two last or both; the amount is the mass where there is one. ``chamfer``: {"face": …,
            "share": …}.
        frequency: of the mode that grows fastest, Hz; a patch has its damping ratio there.
        first: number of the first degree of freedom in messages; 1 as files and commands count.

    Raises:
        ValueError: names the modification, and what is wrong with it.
    """
    title = f"modifications: {name}"
    if not isinstance(content, Mapping) or len(content) != 1:
        raise ValueError(
            f"{title} = {brief(content)}: one of {', '.join(FORMS)} is needed, like "
            "{'added_mass': {1: 0.1}}"
        )
    ((kind, entries),) = content.items()
    if kind not in FORMS:
        raise ValueError(f"{title}: {kind!r}: {suggestion(str(kind), list(FORMS))}")
    if not isinstance(entries, Mapping) or not entries:
        raise ValueError(f"{title}: {kind} = {brief(entries)}: {FORMS[kind]} is needed")
    title = f"{title}: {kind}"
    if kind == "patch":
        return _patch(title, entries, structure, frequency)
    if kind == "chamfer":
        return Chamfer.read(title, entries, structure)
    matrix, unit = MATRICES[kind]
    keys = {place: f"{title}[{_as_counted(place, first)!r}]" for place in entries}
    amounts = {
        place: _positive(keys[place], amount, unit) for place, amount in entries.items()
    }
    most = next(iter(amounts.values()))
    change = sp.csr_array((structure.size, structure.size))
    for place, amount in amounts.items():
        for column in _columns(keys[place], kind, place, structure):
            part = sp.csr_array(column[:, None])
            change = change + (amount / most) * (part @ part.T)
    return MatrixChange({matrix: sp.csr_array(change)}, most, unit)


def counted_from_zero(modifications: Mapping[str, Any]) -> dict[str, Any]:
    """Return modifications that a file or command has, as :func:`squealpipe.assess` takes them.

    Args:
        modifications: name → content, whose places are texts: ``"12"`` is a degree of freedom,
            counted from 1, ``"12,40"`` two of them, ``"5005.3"`` a node and its direction.
    """
    return {
        name: {
            kind: {_place(each): amount for each, amount in entries.items()}
            if kind in MATRICES and isinstance(entries, Mapping)
            else entries
            for kind, entries in content.items()
        }
        for name, content in modifications.items()
    }


def _place(text: str) -> Any:
    """Read degrees of freedom counted from 1, or a node and its direction like 5005.3."""
    ends = [
        int(end) - 1 if end.isdigit() and int(end) > 0 else end
        for end in map(str.strip, text.split(","))
    ]
    return ends[0] if len(ends) == 1 else tuple(ends)


def _as_counted(place: Any, first: int) -> Any:
    """Return a place whose degrees of freedom are counted from this number instead of 0."""
    if isinstance(place, tuple):
        return tuple(_as_counted(each, first) for each in place)
    return place + first if is_whole_number(place) else place


def _positive(title: str, value: Any, unit: str) -> float:
    number = finite_number(title, value, unit)
    if not number > 0.0:
        raise ValueError(f"{title} = {value!r}: it must be greater than 0")
    return number


def _refuse_other_keys(
    title: str, entries: Mapping[str, Any], keys: tuple[str, ...]
) -> None:
    for key in entries:
        if key not in keys:
            raise ValueError(f"{title}: {key!r}: {suggestion(str(key), keys)}")


@dataclass(frozen=True, eq=False)
class MatrixChange:
    """A change of matrices, up to an amount.

    Attributes:
        changes: name of a matrix → its change per unit of the amount, (n, n).
        most: largest amount that is tried.
        unit: CF unit of the amount.
    """

    changes: Mapping[str, sp.csr_array]
    most: float
    unit: str

    def of(self, structure: ContactStructure, amount: float) -> ContactStructure:
        """Return the structure changed by this amount."""
        # not the matrices at the present speed, to which speed terms are added again
        before = structure.arguments
        return structure.with_(
            **{
                name: before[name] + amount * change
                for name, change in self.changes.items()
            }
        )


def _patch(
    title: str,
    entries: Mapping[str, Any],
    structure: ContactStructure,
    frequency: float,
) -> MatrixChange:
    """Return the change that a shim on some nodes makes."""
    _refuse_other_keys(title, entries, ("nodes", "mass", "damping_ratio"))
    if "nodes" not in entries or len(entries) < 2:
        raise ValueError(
            f"{title}: nodes and mass or damping_ratio are needed, like {FORMS['patch']}"
        )
    rows = _rows_of_patch(title, entries["nodes"], structure)
    mesh = structure.mesh
    assert mesh is not None  # noqa: S101 (there would be no rows)
    amounts = {
        key: _positive(f"{title}: {key}", entries[key], unit)
        for key, unit in (("mass", "kg"), ("damping_ratio", "1"))
        if key in entries
    }
    first, most = next(iter(amounts.items()))
    changes = {}
    if "mass" in amounts:
        count = len(np.unique(mesh.degree_of_freedom[rows, 0]))
        share = np.zeros(structure.size)
        share[rows] = 1.0 / count
        changes["mass"] = sp.csr_array(sp.diags_array(share))
    if "damping_ratio" in amounts:
        if not frequency > 0.0:
            raise ValueError(
                f"{title}: damping_ratio: the mode that grows fastest does not oscillate, so that "
                "a ratio has no meaning; leave it out"
            )
        ratio = amounts["damping_ratio"] / most
        damping = ratio / (np.pi * frequency) * _strain_stiffness(structure, rows)
        at = np.ix_(rows, rows)
        whole = sp.lil_array((structure.size, structure.size))
        whole[at] = damping
        changes["damping"] = sp.csr_array(whole)
    return MatrixChange(changes, most, "kg" if first == "mass" else "1")


def _rows_of_patch(title: str, nodes: Any, structure: ContactStructure) -> np.ndarray:
    """Return the degrees of freedom of the displacements of a patch's nodes."""
    mesh = structure.mesh
    if mesh is None:
        raise ValueError(
            f"{title}: the structure has no mesh, so that it has no nodes; use added_mass and "
            "dashpot"
        )
    title = f"{title}: nodes = {brief(nodes)}"
    if isinstance(nodes, str):
        faces: dict[str, set[int]] = {}
        for each in structure.contacts:
            if each.origin is not None:
                name = face_of(each.name) or each.name
                faces.setdefault(name, set()).update(each.origin.nodes)
        sets = {name.upper(): list(members) for name, members in faces.items()}
        sets |= {name.upper(): members for name, members in mesh.sets.items()}
        if nodes.upper() not in sets:
            known = [*mesh.sets, *faces]
            raise ValueError(
                f"{title}: no node set or face has this name; "
                + (suggestion(nodes, known) if known else "give a list of node numbers")
            )
        numbers = np.asarray(sets[nodes.upper()], int)
    else:
        listed = [*nodes] if isinstance(nodes, list | tuple | np.ndarray) else []
        if not listed or not all(is_whole_number(each) for each in listed):
            raise ValueError(
                f"{title}: the name of a node set or face, or a list of node numbers is needed"
            )
        numbers = np.asarray(listed, int)
        if missing := set(numbers.tolist()) - set(np.asarray(mesh.numbers).tolist()):
            raise ValueError(f"{title}: the mesh has no node {min(missing)}")
    rows = mesh.rows_at()
    rows = rows[np.isin(mesh.numbers[mesh.degree_of_freedom[rows, 0]], numbers)]
    if not rows.size:
        raise ValueError(f"{title}: none of these nodes can move")
    return rows


def _strain_stiffness(structure: ContactStructure, rows: np.ndarray) -> np.ndarray:
    """Return Q K Q of a patch, whose rigid motions Q takes out, (rows, rows)."""
    mesh = structure.mesh
    assert mesh is not None  # noqa: S101 (there would be no rows)
    index, direction = mesh.degree_of_freedom[rows].T
    axes = np.eye(3)[direction - 1]
    arms = mesh.nodes[index] - mesh.nodes[np.unique(index)].mean(axis=0)
    extent = np.abs(arms).max() or 1.0
    turns = [(np.cross(about, arms / extent) * axes).sum(axis=1) for about in np.eye(3)]
    rigid = np.column_stack([axes, *turns])
    left, sizes, _ = np.linalg.svd(rigid, full_matrices=False)
    basis = left[
        :, sizes > 1e-9 * sizes[0]
    ]  # of a plane or a line some motions are none
    block = sp.csr_array(structure.given_stiffness)[rows][:, rows].toarray()
    taken_out = np.eye(len(rows)) - basis @ basis.T
    symmetric = 0.5 * (block + block.T)
    return np.asarray(taken_out @ symmetric @ taken_out)


@dataclass(frozen=True, eq=False)
class Chamfer:
    """Removal of points of a face at the end that meets the belt first.

    Attributes:
        order: the shares between which each contact of the structure is lost, (contacts, 2); NaN
            for contacts of other faces.
        most: largest share.
        unit: of the share.
    """

    order: np.ndarray
    most: float
    unit: str = "1"

    @classmethod
    def read(
        cls, title: str, entries: Mapping[str, Any], structure: ContactStructure
    ) -> Chamfer:
        """Read ``{"face": …, "share": …}``."""
        _refuse_other_keys(title, entries, ("face", "share"))
        if set(entries) != {"face", "share"}:
            raise ValueError(
                f"{title}: face and share are needed, like {FORMS['chamfer']}"
            )
        share = _positive(f"{title}: share", entries["share"], "1")
        face = entries["face"]
        names = [
            face_of(contact.name) or contact.name for contact in structure.contacts
        ]
        chosen = [index for index, name in enumerate(names) if name == face]
        if not chosen:
            raise ValueError(
                f"{title}: face = {brief(face)}: {suggestion(str(face), [*dict.fromkeys(names)])}"
            )
        if len(chosen) == 1:
            raise ValueError(
                f"{title}: face = {brief(face)} is a single contact, which must remain; name a "
                "face of several points"
            )
        if not share <= 1.0 - 1.0 / len(chosen):
            raise ValueError(
                f"{title}: share = {share:g}: one of the {len(chosen)} points of {face} must "
                f"remain; a share of at most {1.0 - 1.0 / len(chosen):.4g} is needed"
            )
        along = _along_belt(f"{title}: face = {face!r}", structure, chosen)
        # points side by side across the belt are lost together
        _, inverse, counts = np.unique(
            np.round(along / np.ptp(along), 6), return_inverse=True, return_counts=True
        )
        last = np.cumsum(counts)
        order = np.full((len(names), 2), np.nan)
        order[chosen] = np.stack([last - counts, last], axis=1)[inverse] / len(chosen)
        return cls(order, share)

    def of(self, structure: ContactStructure, amount: float) -> ContactStructure:
        """Return the structure without this share of the face's points."""
        first, last = self.order.T
        kept = np.clip((last - amount) / (last - first), 0.0, 1.0)
        kept[np.isnan(kept)] = 1.0
        kept[kept < 1e-9] = 0.0  # round-off of a share that is a whole number of points
        of_face = np.isfinite(first)
        preloads = structure.preloads * kept
        before, after = structure.preloads[of_face].sum(), preloads[of_face].sum()
        preloads[of_face] *= before / after if after else 1.0
        contacts = [
            replace(contact.scaled(stiffness=share), preload=float(preload))
            for contact, share, preload in zip(
                structure.contacts, kept.tolist(), preloads, strict=True
            )
            if share
        ]
        return structure.with_(contacts=contacts)


def _along_belt(
    title: str, structure: ContactStructure, chosen: list[int]
) -> np.ndarray:
    """Return the position of each contact of a face along the direction of the belt, m."""
    mesh = structure.mesh
    if mesh is None:
        raise ValueError(
            f"{title}: the structure has no mesh, so that the positions of its points are unknown"
        )
    positions, ways = [], []
    for place in chosen:
        contact = structure.contacts[place]
        moved = mesh.displacements(structure.tangentials[:, place])
        origin = contact.origin
        if origin is None:
            positions.append(mesh.center(structure.normals[:, place]))
        else:  # of two bodies, the one that rubs
            positions.append(np.asarray(origin.position))
            moved = moved[np.isin(mesh.numbers, origin.nodes)]
        way = moved.sum(axis=0) * np.sign(contact.speed * structure.belt_speed)
        ways.append(way / (np.linalg.norm(way) or 1.0))
    mean = np.mean(ways, axis=0)
    along = np.array(positions) @ mean
    # the belt runs all round a ring
    if not (np.linalg.norm(mean) > 0.1 and np.isfinite(along).all() and np.ptp(along)):
        raise ValueError(
            f"{title}: the face has no leading end: the belt does not pass its points one after "
            "the other in one direction"
        )
    return np.asarray(along)


def _columns(
    key: str, kind: str, place: Any, structure: ContactStructure
) -> list[np.ndarray]:
    """Return vectors v of the change Σ v vᵀ: of a mass one each, of a spring one between two."""
    if isinstance(place, tuple):
        if kind == "added_mass":
            raise ValueError(f"{key}: a mass is at one degree of freedom")
        if len(place) != 2:
            raise ValueError(f"{key}: two degrees of freedom are needed, like (0, 5)")
        first, second = (freedoms_of(key, each, structure) for each in place)
        if len(first) != len(second) or first == second:
            raise ValueError(
                f"{key}: two different degrees of freedom, or two nodes, are needed"
            )
        return [
            _unit(one, structure.size) - _unit(other, structure.size)
            for one, other in zip(first, second, strict=True)
        ]
    return [_unit(one, structure.size) for one in freedoms_of(key, place, structure)]


def _unit(place: int, size: int) -> np.ndarray:
    vector = np.zeros(size)
    vector[place] = 1.0
    return vector


def freedoms_of(key: str, place: Any, structure: ContactStructure) -> list[int]:
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
                f"{key}: the structure has {structure.size} degrees of freedom, "
                "counted from 0 in Python and from 1 in files and commands"
            )
        return [int(place)]
    mesh = structure.mesh
    if not isinstance(place, str) or not place.partition(".")[0].isdigit():
        raise ValueError(
            f"{key}: a degree of freedom, or a node like '5005' or '5005.3' is needed"
        )
    if mesh is None:
        raise ValueError(
            f"{key}: the structure has no mesh, so nodes have no numbers; give the degree of "
            "freedom as a number"
        )
    if not (rows := mesh.rows_at(place)).size:
        raise ValueError(f"{key}: the structure has no such node or direction")
    return [int(row) for row in rows]
