"""Write mode shapes for ParaView as an unstructured grid of VTK, through meshio."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.store.whole_files import whole_file


def write_vtu(modes: xr.Dataset, path: Path) -> Path:
    """Write the mesh with each mode's shape as point data.

    ``mode_N_real`` and ``mode_N_imaginary`` are (nodes, 3): displacements at the instant of the
    largest one, and those of a quarter period before. ``mode_N_amplitude`` (nodes,) is how far each
    node moves. The largest displacement of a degree of freedom is 1.

    Args:
        modes: dataset of complex modes of a structure with a mesh.
        path: file to write, ``.vtu``.

    Raises:
        ValueError: no meshio, no mesh or no shapes.
    """
    if find_spec("meshio") is None:
        raise ValueError(f"{path} needs meshio; install squealpipe[fe], or meshio")
    import meshio

    if "shape_real" not in modes:
        raise ValueError(
            f"{path}: only modes of a structure have shapes; give what `squealpipe modes` writes"
        )
    if "node_position" not in modes:
        raise ValueError(
            f"{path}: the structure has no mesh; name one in its file (mesh: brake.inp), or draw "
            "its modes as arrows with squealpipe plot --mode"
        )
    nodes = modes.node_position.values
    shapes = modes.shape_real.values.astype(float) + 1j * modes.shape_imaginary.values
    node, direction = modes.moving_node.values, modes.moving_direction.values
    moves = (node >= 0) & (direction <= 3)
    data: dict[str, Any] = {"node_number": modes.node.values}
    for number, shape in zip(modes.mode.values.tolist(), shapes, strict=True):
        if not np.isfinite(shape).all():
            continue
        moved = np.zeros((len(nodes), 3), complex)
        moved[node[moves], direction[moves] - 1] = shape[moves]
        data[f"mode_{number}_real"] = moved.real.copy()
        data[f"mode_{number}_imaginary"] = moved.imag.copy()
        data[f"mode_{number}_amplitude"] = np.linalg.norm(np.abs(moved), axis=1)
    grid = meshio.Mesh(nodes, _cells(modes.facet_node.values), point_data=data)
    with whole_file(path) as temporary:
        meshio.write(temporary, grid, file_format="vtu")
    return path


def _cells(facets: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Facets by their number of corners; those that VTK does not know by their first four."""
    corners = (facets >= 0).sum(axis=1)
    cells = []
    # corners of a facet → cell of VTK
    cell_of_corners = {
        1: "vertex",
        2: "line",
        3: "triangle",
        4: "quad",
        6: "triangle6",
        8: "quad8",
    }
    for count in np.unique(corners[corners > 0]).tolist():
        rows = facets[corners == count, :count]
        known = count if count in cell_of_corners else 4 if count > 4 else 3
        cells.append((cell_of_corners[known], rows[:, :known]))
    return cells
