"""Meshes that meshio reads: gmsh's .msh, Nastran's .bdf and others.

meshio 5.3.5 renumbers nodes. Nastran's numbers it keeps beside the mesh; gmsh's are read here from
the file's own table of nodes. Surfaces are physical groups of gmsh, the properties of shells of
Nastran by their numbers, and sets of cells or of points of other programs.
"""

import contextlib
import io
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.structures.meshes.element_mesh import ElementMesh, Elements, Surface
from squealpipe.structures.meshes.finite_elements import ELEMENTS
from squealpipe.structures.packed import plain_name, text_of, unpacked

NASTRAN = (".bdf", ".nas", ".fem", ".dat")
"""Endings of bulk data of Nastran."""


def read_by_meshio(path: Path) -> ElementMesh:
    """Return the mesh of a file that meshio reads.

    Raises:
        ValueError: meshio cannot read it, or it says something that would be lost.
    """
    try:
        import meshio  # type: ignore[import-untyped]
    except ImportError as error:
        raise ValueError(
            f"mesh: {path} needs meshio; install squealpipe[fe] to read it, or use a deck (.inp)"
        ) from error
    ending = plain_name(path).suffix.lower()
    with unpacked(path) as plain, _whole(plain, ending) as whole:
        try:
            # it prints what is wrong and ends the process
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                mesh = meshio.read(whole)
        except (Exception, SystemExit) as error:
            said = " ".join(printed.getvalue().split()) or repr(error)
            raise ValueError(
                f"mesh: meshio cannot read {path}: {said}; write it as gmsh .msh, Nastran .bdf, or "
                "a deck (.inp)"
            ) from error
    if not len(mesh.points) or not mesh.cells:
        raise ValueError(
            f"mesh: meshio cannot read {path}: it has {len(mesh.points)} nodes and no elements; "
            "write it as gmsh .msh, Nastran .bdf, or a deck (.inp)"
        )
    converted = of_meshio(mesh, str(path), counts_nodes=False)
    if ending in NASTRAN:
        _refuse_systems(mesh, path)
        return replace(converted, numbers=np.asarray(mesh.points_id, int))
    if ending == ".msh":
        return replace(converted, numbers=_tags_of_gmsh(path, len(mesh.points)))
    return converted


@contextlib.contextmanager
def _whole(path: Path, ending: str) -> Iterator[Path]:
    """Yield a path that meshio takes: of bulk data nodes, solids and shells alone.

    It stops at springs, and needs a line before and behind the data that bulk data alone lack.
    """
    if ending not in NASTRAN:
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "mesh.bdf"
        cards = _cards_of_mesh(path)
        whole.write_text("BEGIN BULK\n" + "\n".join(cards) + "\nENDDATA\n")
        yield whole


def _cards_of_mesh(path: Path) -> list[str]:
    """Return the lines of nodes, solids and shells, with those in which they go on.

    Raises:
        ValueError: the data are in several files.
    """
    of_mesh = {"GRID", "CTETRA", "CPENTA", "CHEXA"}
    of_mesh |= {"CTRIA3", "CTRIAR", "CTRIA6", "CQUAD4", "CQUADR", "CQUAD8"}
    kept, keeps = [], False
    for line in path.read_text(errors="replace").splitlines():
        if not line.strip() or line.startswith(("$", "//", "#")):
            continue
        if line[0] not in "+* ,\t":
            name = line.partition(",")[0][:8].strip().rstrip("*").upper()
            if name.split()[0] == "INCLUDE":
                raise ValueError(
                    f"mesh: {path.name} goes on in another file (INCLUDE); put all bulk data in one"
                )
            keeps = name in of_mesh
        if keeps:
            kept.append(line)
    return kept


def _refuse_systems(mesh: Any, path: Path) -> None:
    """Refuse nodes in coordinate systems of their own, which meshio takes for that of the whole."""
    systems = np.asarray(mesh.point_data.get("nastran:ref", [0]))
    if systems.any():
        raise ValueError(
            f"mesh: {path} has GRID cards in coordinate system {systems[systems != 0][0]}, which "
            "is not read; write them in the basic one"
        )
    if turned := _turned_nodes(text_of(path)):
        raise ValueError(
            f"mesh: {path}: GRID {turned[0]} has displacements in a coordinate system of its own "
            "(CD), which is not read; use the basic one"
        )


def _turned_nodes(text: str) -> list[int]:
    """Return numbers of the nodes whose seventh field, CD, is not 0."""
    turned = []
    lines = text.splitlines()
    for number, line in enumerate(lines):
        if not line.upper().startswith("GRID"):
            continue
        if "," in line:
            cells = [cell.strip() for cell in line.split(",")]
            node, system = cells[1], cells[6] if len(cells) > 6 else ""
        elif line[4:8].strip() == "*":
            following = lines[number + 1] if number + 1 < len(lines) else ""
            node, system = line[8:24].strip(), following[24:40].strip()
        else:
            node, system = line[8:16].strip(), line[48:56].strip()
        if system not in ("", "0"):
            turned.append(int(node))
    return turned


def _tags_of_gmsh(path: Path, count: int) -> np.ndarray:
    """Return the numbers of gmsh's nodes in the order of the file.

    Raises:
        ValueError: a binary file; meshio does not say its numbers.
    """
    text = text_of(path)
    head, _, rest = text.partition("$Nodes")
    version, binary = head.split("$MeshFormat")[1].split()[:2]
    if binary != "0":
        raise ValueError(
            f"mesh: {path} is binary, and its numbers of nodes are not read; write it as text "
            "(Mesh.Binary = 0)"
        )
    words = rest.partition("$EndNodes")[0].split()
    if version.startswith("2"):
        return np.array(words[1 : 1 + 4 * count : 4], int)
    numbers: list[int] = []
    place = 4
    while len(numbers) < count:
        block = int(words[place + 3])
        numbers += map(int, words[place + 4 : place + 4 + block])
        place += 4 + 4 * block
    return np.array(numbers, int)


def of_meshio(mesh: Any, source: str, *, counts_nodes: bool) -> ElementMesh:
    """Return a mesh of meshio with its surfaces; nodes are numbered from 1.

    Args:
        source: file or argument, for messages.
        counts_nodes: as of :class:`ElementMesh`.
    """
    points = np.asarray(mesh.points, float)
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    blocks: dict[str, list[np.ndarray]] = {}
    for block in mesh.cells:
        if block.type in ELEMENTS:
            blocks.setdefault(block.type, []).append(np.asarray(block.data, int))
    elements, first = {}, 1
    for kind, rows in blocks.items():
        nodes = np.concatenate(rows)
        elements[kind] = Elements(np.arange(first, first + len(nodes)), nodes)
        first += len(nodes)
    surfaces: dict[str, Callable[[ElementMesh], Surface]] = {}
    sets: dict[str, np.ndarray] = {}
    for name, rows in _named_cells(mesh).items():
        surfaces[name] = lambda whole, rows=rows: whole.of_shells(rows)  # type: ignore[misc]
        sets[name] = np.unique(np.concatenate([row.ravel() for row in rows]))
    for name, members in mesh.point_sets.items():
        places = np.asarray(members, int)
        sets.setdefault(name, places)
        surfaces.setdefault(name, lambda whole, places=places: whole.within(places))  # type: ignore[misc]
    return ElementMesh(
        np.arange(1, len(points) + 1),
        points,
        elements,
        surfaces,
        source,
        counts_nodes=counts_nodes,
        node_sets=sets,
    )


def _named_cells(mesh: Any) -> dict[str, list[np.ndarray]]:
    """Return facets by the name of their group."""
    named: dict[str, list[np.ndarray]] = {}
    names = {
        int(tag): name
        for name, (tag, dimension) in mesh.field_data.items()
        if dimension == 2
    }
    for key in ("gmsh:physical", "nastran:ref"):
        for rows, tags in _of_shells(mesh, mesh.cell_data.get(key, [])):
            for tag in np.unique(tags).tolist():
                group = named.setdefault(names.get(tag, str(tag)), [])
                group.append(rows[tags == tag])
    for name, members in mesh.cell_sets.items():
        if name not in named and not name.startswith("gmsh:"):
            chosen = [rows[places] for rows, places in _of_shells(mesh, members)]
            if sum(map(len, chosen)):
                named[name] = chosen
    return named


def _of_shells(
    mesh: Any, by_block: Iterable[Any]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield the facets of each block of shells with what is given by block."""
    for block, values in zip(mesh.cells, by_block, strict=False):
        if block.type in ELEMENTS and ELEMENTS[block.type].is_shell:
            yield np.asarray(block.data), np.asarray(values, int)
