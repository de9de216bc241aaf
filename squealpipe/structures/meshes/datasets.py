"""The mesh of a structure as variables of its datasets."""

from typing import Any

import numpy as np

from squealpipe.structures.meshes.structure_mesh import AXES, StructureMesh


def mesh_variables(structure: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return data variables and coordinates that hold the mesh; none where there is none.

    Args:
        structure: a ``Structure``, reduced or whole.
    """
    mesh: StructureMesh | None = structure.mesh
    if mesh is None:
        return {}, {}
    data = {
        "node_position": mesh.nodes,
        "facet_node": mesh.facets,
        "moving_node": mesh.degree_of_freedom[:, 0],
        "moving_direction": mesh.degree_of_freedom[:, 1],
    }
    origin = structure.reduced_from
    whole = structure if origin is None else origin.whole
    if structure.contacts and len(whole.normals) == len(mesh.degree_of_freedom):
        data["contact_position"] = np.array(
            [
                mesh.center(normal)
                if contact.origin is None
                else contact.origin.position
                for contact, normal in zip(
                    structure.contacts, whole.normals.T, strict=True
                )
            ]
        )
        data["contact_gap"] = np.array(
            [
                np.nan if contact.origin is None else contact.origin.gap
                for contact in structure.contacts
            ]
        )
    return data, {"node": mesh.numbers, "axis": list(AXES)}


def mesh_of(dataset: Any) -> StructureMesh | None:
    """Return the mesh that a dataset of a structure holds; None where it holds none."""
    if "node_position" not in dataset:
        return None
    freedoms = [dataset.moving_node.values, dataset.moving_direction.values]
    return StructureMesh(
        dataset.node_position.values,
        dataset.facet_node.values,
        np.column_stack(freedoms),
        dataset.node.values,
    )
