"""Meshes from where they come: decks, what meshio reads, or arrays."""

from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.structures.meshes.deck import read_deck
from squealpipe.structures.meshes.element_mesh import ElementMesh, Surface, joined
from squealpipe.structures.meshes.finite_elements import CORNERS
from squealpipe.structures.meshes.meshio_meshes import of_meshio, read_by_meshio
from squealpipe.structures.packed import plain_name
from squealpipe.systems.inputs.values import brief
from squealpipe.validation import real_array


def mesh_of_source(mesh: Any) -> ElementMesh:
    """Return a mesh with its surfaces.

    Args:
        mesh: path of a deck (.inp, also packed by gzip) or of a file that meshio reads; a mesh of
            meshio; or (nodes, faces), where nodes are positions (n, 3) or {number: position}, and
            faces {name: facets}, by indices from 0 or by these numbers, (facets, 3, 4, 6 or 8),
            counterclockwise as seen from outside.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names what is wrong.
    """
    if isinstance(mesh, str | PathLike):
        path = Path(mesh).expanduser()
        if not path.is_file():
            raise FileNotFoundError(f"mesh: no file {path}")
        if plain_name(path).suffix.lower() == ".inp":
            return read_deck(path)
        return read_by_meshio(path)
    if hasattr(mesh, "cells_dict"):
        return of_meshio(mesh, "mesh", counts_nodes=True)
    if isinstance(mesh, tuple | list) and len(mesh) == 2:
        return of_arrays(*mesh)
    needed = "a file, a mesh of meshio, or (nodes, faces) is needed"
    raise ValueError(f"mesh = {brief(mesh)}: {needed}")


def of_arrays(nodes: Any, faces: Any) -> ElementMesh:
    """Return a mesh of nodes and named facets.

    Raises:
        ValueError: names what is wrong.
    """
    counts_nodes = not isinstance(nodes, Mapping)
    positions = real_array("mesh: nodes", nodes if counts_nodes else [*nodes.values()])
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise ValueError(
            f"mesh: nodes have shape {positions.shape}; (nodes, 3) is needed"
        )
    numbers = (
        np.arange(1, len(positions) + 1) if counts_nodes else np.array([*nodes], int)
    )
    if not isinstance(faces, Mapping):
        raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
            f"mesh: faces = {brief(faces)}: {{name: facets}} are needed"
        )
    mesh = ElementMesh(numbers, positions, counts_nodes=counts_nodes)
    surfaces: dict[str, Callable[[ElementMesh], Surface]] = {}
    sets: dict[str, np.ndarray] = {}
    for name, facets in faces.items():
        surface = Surface(joined(_rows(mesh, str(name), facets)))
        sets[str(name)] = np.unique(
            np.concatenate([facet.ravel() for facet in surface.facets.values()])
        )
        surfaces[str(name)] = lambda _, surface=surface: surface  # type: ignore[misc]
    return ElementMesh(
        numbers, positions, surfaces=surfaces, counts_nodes=counts_nodes, node_sets=sets
    )


def _rows(mesh: ElementMesh, name: str, facets: Any) -> list[np.ndarray]:
    """Return facets by their indices, in blocks of one length."""
    by_size: dict[int, list[list[int]]] = {}
    for each in facets:
        block = np.atleast_2d(np.asarray(each))
        if block.dtype.kind not in "iu" or block.shape[1] not in CORNERS:
            raise ValueError(
                f"mesh: facet {brief(each)} of {name}: whole numbers of 3, 4, 6 or 8 nodes are "
                "needed"
            )
        by_size.setdefault(block.shape[1], []).extend(block.tolist())
    known = {} if mesh.counts_nodes else mesh.index_of
    blocks = []
    for rows in by_size.values():
        array = np.array(rows, int)
        if mesh.counts_nodes:
            wrong = array[(array < 0) | (array >= len(mesh.nodes))]
        else:
            wrong = np.array([each for each in array.ravel() if int(each) not in known])
        if wrong.size:
            raise ValueError(
                f"mesh: a facet of {name} has node {wrong[0]}, which is not in the mesh of "
                f"{len(mesh.nodes)} nodes"
            )
        if not mesh.counts_nodes:
            array = np.array([[known[int(node)] for node in row] for row in array])
        blocks.append(array)
    return blocks
