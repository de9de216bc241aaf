"""Decks of Abaqus and CalculiX: nodes, elements, sets and surfaces, with their own numbers.

A small reader of our own: meshio 5.3.5 stops at SPRING1 and drops surfaces and node numbers. Of a
deck only what makes a surface is read; elements that have no face (springs, masses, beams) are
skipped, and what would change the meaning of what is read (generated nodes, coordinate systems of
their own, several instances of a part) is refused by name.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.structures.meshes.deck_lines import Block, blocks_of, cells_of
from squealpipe.structures.meshes.element_mesh import (
    ElementMesh,
    Elements,
    Surface,
    faces_of,
    joined,
    turned,
)
from squealpipe.structures.meshes.finite_elements import ELEMENTS, kind_in_deck


def read_deck(path: Path) -> ElementMesh:
    """Return the mesh of a deck.

    Args:
        path: ``.inp``, or as gzip packs it.

    Raises:
        FileNotFoundError: a file that does not exist.
        ValueError: what is wrong, with file and line.
    """
    deck = _Deck(path)
    for block in blocks_of(path):
        deck.take(block)
    return deck.mesh()


@dataclass
class _Deck:
    """Contents of a deck as far as it is read; sets and surfaces by their names in capitals."""

    path: Path
    positions: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    elements: dict[str, list[list[int]]] = field(default_factory=dict)
    without_faces: dict[int, str] = field(default_factory=dict)
    kind_of: dict[int, tuple[str, int]] = field(default_factory=dict)
    node_sets: dict[str, dict[int, None]] = field(default_factory=dict)
    element_sets: dict[str, dict[int, None]] = field(default_factory=dict)
    surfaces: dict[str, tuple[str, Block]] = field(default_factory=dict)
    bound: dict[str, None] = field(default_factory=dict)
    turned: set[int] = field(default_factory=set)
    instances: int = 0

    def take(self, block: Block) -> None:
        """Read one block, where it says something of the mesh."""
        readers: dict[str, Callable[[Block], None]] = {
            "NODE": self._nodes,
            "ELEMENT": self._elements,
            "NSET": self._node_set,
            "ELSET": self._element_set,
            "SURFACE": self._surface,
            "TRANSFORM": self._transform,
            "INSTANCE": self._instance,
            "SYSTEM": self._refuse_system,
        }
        # keywords that make nodes or elements from others
        generated = {
            "NGEN": "nodes",
            "NFILL": "nodes",
            "NCOPY": "nodes",
            "NMAP": "nodes",
            "ELGEN": "elements",
            "ELCOPY": "elements",
        }
        if block.keyword in generated:
            raise ValueError(
                f"{block.where} makes {generated[block.keyword]} that the deck does not list; "
                "write the deck anew with every node and element, as a mesher does"
            )
        if block.keyword in (
            "EQUATION",
            "MPC",
            "TIE",
            "RIGID BODY",
            "COUPLING",
            "KINEMATIC COUPLING",
            "DISTRIBUTING COUPLING",
            "EMBEDDED ELEMENT",
            "CYCLIC SYMMETRY MODEL",
        ):
            self.bound[f"*{block.keyword}"] = None
        if reader := readers.get(block.keyword):
            reader(block)

    def _refuse_system(self, block: Block) -> None:
        if any(cells_of(text) for _, text in block.lines):
            raise ValueError(
                f"{block.where}: nodes in a coordinate system of their own; write them in that of "
                "the whole"
            )

    def _instance(self, block: Block) -> None:
        self.instances += 1
        if self.instances > 1 or block.lines:
            raise ValueError(
                f"{block.where}: parts that are moved or used more than once have other node "
                "numbers in the matrices; write the deck without parts and assemblies"
            )

    def _transform(self, block: Block) -> None:
        self.turned.update(self._members(self.node_sets, block.needed("NSET"), block))

    def _nodes(self, block: Block) -> None:
        if block.parameters.get("SYSTEM", "R").upper() not in ("R", ""):
            self._refuse_system(block)
        numbers = []
        for line, text in block.lines:
            cells = text.split(",")
            try:
                number = int(cells[0])
                x, y, z = (
                    _real(cells[place]) if place < len(cells) else 0.0
                    for place in (1, 2, 3)
                )
            except ValueError:
                raise ValueError(
                    f"{block.path}, line {line}: {text[:60]!r} is no node; its number and three "
                    "coordinates are needed, separated by commas"
                ) from None
            position = x, y, z
            if self.positions.setdefault(number, position) != position:
                raise ValueError(
                    f"{block.path}, line {line}: node {number} is there twice, at "
                    f"{_point(self.positions[number])} and {_point(position)}; give one of them "
                    "another number"
                )
            numbers.append(number)
        if name := block.parameters.get("NSET"):
            self._set(self.node_sets, name).update(dict.fromkeys(numbers))

    def _elements(self, block: Block) -> None:
        element_type = block.needed("TYPE").upper()
        kind = kind_in_deck(element_type)
        rows = _element_rows(block, ELEMENTS[kind].nodes if kind else None)
        for row in rows:
            if row[0] in self.kind_of or row[0] in self.without_faces:
                raise ValueError(
                    f"{block.where}: element {row[0]} is there twice; give one of both another "
                    "number"
                )
            if kind is None:
                self.without_faces[row[0]] = element_type
            else:
                block_of_kind = self.elements.setdefault(kind, [])
                self.kind_of[row[0]] = kind, len(block_of_kind)
                block_of_kind.append(row)
        if name := block.parameters.get("ELSET"):
            members = dict.fromkeys(row[0] for row in rows)
            self._set(self.element_sets, name).update(members)

    def _node_set(self, block: Block) -> None:
        members = self._set(self.node_sets, block.needed("NSET"))
        if elements := block.parameters.get("ELSET"):
            for number in self._members(self.element_sets, elements, block):
                if number in self.kind_of:
                    kind, place = self.kind_of[number]
                    members.update(dict.fromkeys(self.elements[kind][place][1:]))
        members.update(dict.fromkeys(self._listed(self.node_sets, block)))

    def _element_set(self, block: Block) -> None:
        members = self._set(self.element_sets, block.needed("ELSET"))
        members.update(dict.fromkeys(self._listed(self.element_sets, block)))

    def _listed(self, sets: dict[str, dict[int, None]], block: Block) -> list[int]:
        """Return the members that the lines of a set name."""
        members: list[int] = []
        for line, text in block.lines:
            cells = [cell for cell in cells_of(text) if cell]
            if "GENERATE" in block.parameters:
                try:
                    first, last, *step = map(int, cells)
                    members += range(first, last + 1, *step)
                except (ValueError, TypeError):
                    raise ValueError(
                        f"{block.path}, line {line}: {text[:60]!r}: first, last and step are "
                        "needed after GENERATE"
                    ) from None
                continue
            for cell in cells:
                if re.fullmatch(r"\d+", cell):
                    members.append(int(cell))
                else:
                    members += self._members(sets, cell, block)
        return members

    def _set(self, sets: dict[str, dict[int, None]], name: str) -> dict[int, None]:
        return sets.setdefault(name.upper(), {})

    def _members(
        self, sets: dict[str, dict[int, None]], name: str, block: Block
    ) -> list[int]:
        """Return the members of a set, or the one that a number is."""
        if re.fullmatch(r"\d+", name):
            return [int(name)]
        # of one instance alone its name before a point says nothing
        for key in (name.upper(), name.upper().rpartition(".")[2]):
            if key in sets:
                return list(sets[key])
        what = "node" if sets is self.node_sets else "element"
        raise ValueError(
            f"{block.where}: no {what} set {name} stands before; define it first"
        )

    def _surface(self, block: Block) -> None:
        name = block.needed("NAME")
        if name.upper() in self.surfaces:
            raise ValueError(
                f"{block.where}: surface {name} is there twice; rename one"
            )
        self.surfaces[name.upper()] = name, block

    def mesh(self) -> ElementMesh:
        """Return the mesh with its surfaces, node sets and sets of shells."""
        if not self.positions:
            raise ValueError(
                f"{self.path} has no *NODE; a deck with its nodes is needed"
            )
        numbers = np.array(list(self.positions), int)
        index_of = {number: index for index, number in enumerate(self.positions)}
        elements = {
            kind: Elements(
                np.array([row[0] for row in rows], int), self._indices(rows, index_of)
            )
            for kind, rows in self.elements.items()
        }
        named: dict[str, Callable[[ElementMesh], Surface]] = {}
        for name, members in self.element_sets.items():
            shells = [
                number
                for number in members
                if number in self.kind_of and ELEMENTS[self.kind_of[number][0]].is_shell
            ]
            if shells:
                named[name] = lambda mesh, shells=shells: mesh.of_shells(  # type: ignore[misc]
                    self._shells(mesh, shells)
                )
        for name, members in self.node_sets.items():
            named[name] = lambda mesh, name=name, members=members: mesh.within(  # type: ignore[misc]
                self._places(mesh, name, members)
            )
        for name, block in self.surfaces.values():
            named.pop(name.upper(), None)
            named[name] = lambda mesh, block=block: self._facets(mesh, block)  # type: ignore[misc]
        return ElementMesh(
            numbers,
            np.array(list(self.positions.values())),
            elements,
            named,
            str(self.path),
            tuple(self.bound),
            frozenset(self.turned),
            node_sets={
                name: np.array([index_of[n] for n in members if n in index_of], int)
                for name, members in self.node_sets.items()
            },
        )

    def _indices(self, rows: list[list[int]], index_of: dict[int, int]) -> np.ndarray:
        try:
            return np.array([[index_of[node] for node in row[1:]] for row in rows])
        except KeyError:
            row, node = next(
                (row, node) for row in rows for node in row[1:] if node not in index_of
            )
            raise ValueError(
                f"{self.path}: element {row[0]} has node {node}, which no *NODE lists; add it, or "
                "*INCLUDE its file"
            ) from None

    def _places(
        self, mesh: ElementMesh, name: str, members: dict[int, None]
    ) -> np.ndarray:
        if missing := [node for node in members if node not in mesh.index_of]:
            raise ValueError(
                f"{self.path}: node set {name} has node {missing[0]}, which no *NODE lists"
            )
        return np.array([mesh.index_of[node] for node in members], int)

    def _shells(self, mesh: ElementMesh, numbers: list[int]) -> list[np.ndarray]:
        places: dict[str, list[int]] = {}
        for number in numbers:
            kind, place = self.kind_of[number]
            places.setdefault(kind, []).append(place)
        return [mesh.elements[kind].nodes[chosen] for kind, chosen in places.items()]

    def _facets(self, mesh: ElementMesh, block: Block) -> Surface:
        """Return the facets of a ``*SURFACE``."""
        surface_type = block.parameters.get("TYPE", "ELEMENT").upper()
        if "COMBINE" in block.parameters or surface_type not in ("ELEMENT", "NODE"):
            what = (
                "COMBINE" if "COMBINE" in block.parameters else f"TYPE={surface_type}"
            )
            raise ValueError(
                f"{block.where}, {what}: only surfaces of elements and of nodes are read; define "
                "this one by its element faces"
            )
        if surface_type == "NODE":
            members: dict[int, None] = {}
            for _, text in block.lines:
                name = cells_of(text)[0]
                members.update(
                    dict.fromkeys(self._members(self.node_sets, name, block))
                )
            return mesh.within(self._places(mesh, block.parameters["NAME"], members))
        groups: dict[tuple[str, int], list[int]] = {}
        shells: dict[tuple[str, int], list[int]] = {}
        free: list[int] = []
        for line, text in block.lines:
            name, *face = cells_of(text)
            where = f"{block.path}, line {line}: surface {block.parameters['NAME']}"
            numbers = self._members(self.element_sets, name, block)
            if not face:
                free += numbers
                continue
            for number in numbers:
                kind, place = self._with_faces(number, where)
                if ELEMENTS[kind].is_shell:
                    side = _side(face[0], where)
                    shells.setdefault((kind, side), []).append(place)
                else:
                    key = kind, _place_of_face(face[0], kind, number, where)
                    groups.setdefault(key, []).append(place)
        blocks = [
            faces_of(mesh, kind, np.array(places), face)
            for (kind, face), places in groups.items()
        ]
        for (kind, side), places in shells.items():
            rows = mesh.elements[kind].nodes[places]
            blocks.append(rows if side > 0 else turned(rows))
        if free:
            blocks += self._free_faces(mesh, free, block)
        return Surface(joined(blocks))

    def _free_faces(
        self, mesh: ElementMesh, numbers: list[int], block: Block
    ) -> list[np.ndarray]:
        """Return the faces of elements that are on the skin of the whole mesh."""
        skin = {
            tuple(sorted(row)) for rows in mesh.skin.values() for row in rows.tolist()
        }
        kept = []
        for number in dict.fromkeys(numbers):
            kind, place = self._with_faces(number, block.where)
            if ELEMENTS[kind].is_shell:
                raise ValueError(
                    f"{block.where}: element {number} is a shell, of which a side is needed; write "
                    "SPOS or SNEG behind it"
                )
            for face in range(len(ELEMENTS[kind].faces)):
                rows = faces_of(mesh, kind, np.array([place]), face)
                if tuple(sorted(rows[0].tolist())) in skin:
                    kept.append(rows)
        return kept

    def _with_faces(self, number: int, where: str) -> tuple[str, int]:
        if number in self.kind_of:
            return self.kind_of[number]
        if number in self.without_faces:
            raise ValueError(
                f"{where}: element {number} is {self.without_faces[number]}, which has no face "
                "that is known; solids of C3D4 to C3D20 and shells of S3 to S8 have"
            )
        raise ValueError(f"{where}: there is no element {number}")


def _real(cell: str) -> float:
    """A number of a deck; an empty cell is 0, and exponents may be Fortran's."""
    text = cell.strip()
    try:
        value = float(text or 0.0)
    except ValueError:
        value = float(text.upper().replace("D", "E"))
    if not np.isfinite(value):
        raise ValueError(text)
    return value


def _point(position: Any) -> str:
    return "(" + ", ".join(f"{value:g}" for value in position) + ")"


def _element_rows(block: Block, nodes: int | None) -> list[list[int]]:
    """Return number and nodes of elements, which may take several lines each.

    Args:
        nodes: of each; None: not known, and a line ends with a comma where it goes on.
    """
    rows: list[list[int]] = []
    goes_on = False
    for line, text in block.lines:
        try:
            cells = [int(cell) for cell in text.split(",") if cell.strip()]
        except ValueError:
            if nodes is None:  # numbers of another kind of element
                continue
            raise ValueError(
                f"{block.path}, line {line}: {text[:60]!r} is no element; its number and those of "
                "its nodes are needed"
            ) from None
        if goes_on:
            rows[-1] += cells
        else:
            rows.append(cells)
        goes_on = text.endswith(",") if nodes is None else len(rows[-1]) < nodes + 1
        if nodes is not None and len(rows[-1]) > nodes + 1:
            raise ValueError(
                f"{block.path}, line {line}: element {rows[-1][0]} has {len(rows[-1]) - 1} nodes, "
                f"but its type {nodes}"
            )
    if goes_on and nodes is not None:
        raise ValueError(
            f"{block.where}: element {rows[-1][0]} has {len(rows[-1]) - 1} nodes, but its type "
            f"{nodes}; the deck may be cut off"
        )
    return [row for row in rows if row]


def _place_of_face(name: str, kind: str, number: int, where: str) -> int:
    match = re.fullmatch(r"[SP]?(\d)", name.upper())
    faces = len(ELEMENTS[kind].faces)
    if match is None or not 1 <= int(match[1]) <= faces:
        raise ValueError(
            f"{where}: element {number} has no face {name}; a solid of {ELEMENTS[kind].nodes} "
            f"nodes has S1 to S{faces}"
        )
    return int(match[1]) - 1


def _side(name: str, where: str) -> int:
    # names of a shell's faces: 1 where its normal points, −1 on the other side
    if name.upper() in ("SPOS", "POS", "S2", "P"):
        return 1
    if name.upper() in ("SNEG", "NEG", "S1", "N"):
        return -1
    raise ValueError(
        f"{where}: {name} is no side of a shell; SPOS (where its normal points) or SNEG is needed"
    )
