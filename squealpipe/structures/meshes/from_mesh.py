"""Contacts of faces and names of degrees of freedom, from matrices and a mesh."""

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from os import PathLike, fspath
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp

from squealpipe.structures.contact import Contact
from squealpipe.structures.matrices import checked_mass
from squealpipe.structures.meshes.contact_points import Freedoms, contacts_of
from squealpipe.structures.meshes.element_mesh import ElementMesh
from squealpipe.structures.meshes.faces import Face, Rotation
from squealpipe.structures.meshes.finite_elements import ELEMENTS
from squealpipe.structures.meshes.gaps import gaps_of
from squealpipe.structures.meshes.sources import mesh_of_source
from squealpipe.structures.meshes.structure_mesh import NO_NODE, StructureMesh
from squealpipe.structures.readers import read_names
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.values import brief


class OfMesh(NamedTuple):
    """Additions of a mesh to the matrices of a structure."""

    contacts: list[Contact]
    mesh: StructureMesh


def of_mesh(
    mass: Any,
    names: Sequence[Any] | None,
    mesh: Any,
    faces: Mapping[str, Face],
    rotation: Rotation | None,
    length: float = 1.0,
) -> OfMesh:
    """Return the contacts of faces and the mesh that a structure keeps.

    Args:
        mass: matrix in SI, (n, n).
        names: of its rows, ``node.direction`` or (node, direction); None: unknown.
        mesh: file, mesh of meshio, or (nodes, faces).
        faces: by the name that begins those of their contacts.
        length: unit of length of the mesh, m.

    Raises:
        FileNotFoundError: no such file.
        ValueError: what is wrong, with names and numbers.
    """
    source = mesh_of_source(mesh)
    source = replace(source, nodes=source.nodes * length)
    rows = _named_rows(names, source, mass.shape[0])
    _refuse_units(mass, rows, source)
    _refuse_massless(mass, rows, source)
    freedoms = Freedoms(source, rows)
    if rotation is not None and rotation.body is not None:
        source.surface(rotation.body)
    contacts: list[Contact] = []
    for name, face in faces.items():
        try:
            contacts += contacts_of(name, face, source, freedoms, rotation)
        except ValueError as error:
            raise ValueError(f"contacts: {name}: {error}") from error
    for gaps in gaps_of(contacts):
        if gaps.is_doubtful:
            warnings.warn(gaps.doubt(), stacklevel=3)
    return OfMesh(contacts, _picture(source, rows))


def _named_rows(
    names: Sequence[Any] | None, mesh: ElementMesh, size: int
) -> np.ndarray:
    """Return node number and direction of each row of the matrices, (n, 2)."""
    if names is None:
        displacements = 3
        count = displacements * len(mesh.nodes)
        if size == count and mesh.counts_nodes:
            nodes = np.repeat(mesh.numbers, displacements)
            return np.column_stack(
                [nodes, np.tile(np.arange(1, displacements + 1), len(mesh.nodes))]
            )
        raise ValueError(
            f"degrees_of_freedom is missing: the matrices have {size} rows without names, and the "
            f"mesh {len(mesh.nodes)} nodes; name the file that says node and direction of each "
            "row, like `degrees_of_freedom: brake.dof`"
        )
    rows = np.array([_pair(name) for name in names], int).reshape(-1, 2)
    if len(rows) != size:
        raise ValueError(
            f"degrees_of_freedom names {len(rows)} rows, but the matrices have {size}; give the "
            "file that was written with these matrices"
        )
    beyond = rows[(rows[:, 1] < 1) | (rows[:, 1] > 6)]
    if beyond.size:
        node, direction = beyond[0]
        raise ValueError(
            f"degrees_of_freedom: {node}.{direction} has no direction {direction} ({len(beyond)} "
            "rows); 1 to 3 are displacements along x, y, z, and 4 to 6 rotations about them"
        )
    unique, counts = np.unique(rows, axis=0, return_counts=True)
    if (counts > 1).any():
        node, direction = unique[counts > 1][0]
        raise ValueError(
            f"degrees_of_freedom: {node}.{direction} is there twice; each row needs its own"
        )
    unknown = [node for node in rows[:, 0].tolist() if node not in mesh.index_of]
    if len(unknown) == len(rows):
        raise ValueError(
            f"{mesh.source}: the matrices name nodes {rows[:, 0].min()} to {rows[:, 0].max()}, the "
            f"mesh {mesh.numbers.min()} to {mesh.numbers.max()}: none is in both; give the mesh "
            "that the matrices were made from"
        )
    return rows


def _pair(name: Any) -> tuple[int, int]:
    """Return node and direction of ``12.1`` or (12, 1)."""
    if isinstance(name, str):
        node, _, direction = name.partition(".")
        if node.isdecimal() and direction.isdecimal():
            return int(node), int(direction)
    elif isinstance(name, Iterable):
        pair = tuple(name)
        if len(pair) == 2 and all(float(each).is_integer() for each in pair):
            return int(pair[0]), int(pair[1])
    raise ValueError(
        f"degrees_of_freedom: {brief(name)} is no node with its direction, like '12.1' or (12, 1)"
    )


def _refuse_units(mass: Any, rows: np.ndarray, mesh: ElementMesh) -> None:
    """Refuse matrices and a mesh whose mean density is that of no body."""
    has_shells = any(ELEMENTS[name].is_shell for name in mesh.elements)
    if has_shells or mesh.volume <= 0:
        return
    # a rigid motion does not move what is at no node of the mesh, as incompatible modes
    at_node = np.isin(rows[:, 0], mesh.numbers)
    along = (at_node & (rows[:, 1] == 1)).astype(float)
    total = float(along @ (mass @ along))
    density = total / mesh.volume
    # kg/m³, from foam to beyond metals; other mean densities come from mixed units
    densities = (10.0, 1e5)
    if total > 0 and not densities[0] <= density <= densities[1]:
        raise ValueError(
            f"{mesh.source} and the mass do not have the same units: {engineering(total, 'kg')} in "
            f"{mesh.volume:.3g} m³ are {density:.3g} kg/m³; state the units of both, like "
            "`units: mm-t-s`, and check that the files of mass and stiffness are not exchanged"
        )


def _refuse_massless(mass: Any, rows: np.ndarray, mesh: ElementMesh) -> None:
    """Refuse rows at nodes that the mesh lacks, where some of their motions have no mass.

    CalculiX adds such nodes for the incompatible modes of C3D8I, of which it integrates three to
    one and the same mass.
    """
    added = np.flatnonzero(~np.isin(rows[:, 0], mesh.numbers))
    if not added.size:
        return
    try:
        checked_mass(sp.csr_array(sp.csr_array(mass)[added][:, added]))
    except ValueError:
        nodes = rows[added, 0]
        raise ValueError(
            f"{added.size} rows of the matrices are of nodes {nodes.min()} to {nodes.max()}, which "
            f"{mesh.source} does not list, and some of their motions have no mass; CalculiX adds "
            "such rows for the incompatible modes of C3D8I: create the matrices again with C3D8, "
            "C3D20 or C3D10 instead"
        ) from None


def _picture(mesh: ElementMesh, rows: np.ndarray) -> StructureMesh:
    """Return the nodes that move or that facets have, and these facets."""
    facets = [each for group in mesh.drawn.values() for each in group.tolist()]
    used = np.zeros(len(mesh.nodes), bool)
    for each in facets:
        used[each] = True
    index_of = mesh.index_of
    at = np.array([index_of.get(node, NO_NODE) for node in rows[:, 0].tolist()], int)
    used[at[at != NO_NODE]] = True
    new = np.full(len(mesh.nodes) + 1, NO_NODE)  # the last stands for no node
    new[np.flatnonzero(used)] = np.arange(used.sum())
    return StructureMesh(
        mesh.nodes[used],
        [new[facet].tolist() for facet in facets],
        np.column_stack([new[at], rows[:, 1]]),
        mesh.numbers[used],
        {name: mesh.numbers[places] for name, places in mesh.node_sets.items()},
    )


def names_of(given: Any, folder: Path = Path()) -> list[Any] | None:
    """Return the names of rows from a file of CalculiX, a sequence of names, or None."""
    if given is None:
        return None
    if isinstance(given, str | PathLike):
        path = folder / fspath(given)
        if not path.is_file():
            raise FileNotFoundError(f"degrees_of_freedom: no file {path}")
        return list(read_names(path))
    if not isinstance(given, Iterable):
        raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
            f"degrees_of_freedom = {brief(given)}: names like '12.1', or the name of a file that "
            "has them, are needed"
        )
    return list(given)
