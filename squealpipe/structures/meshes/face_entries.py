"""Faces as a file of a structure writes them, and pressures by node."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from squealpipe.laws.contact_laws import own_law_rules
from squealpipe.laws.numerals import decimal_sign, numeral, plain
from squealpipe.laws.rows import text_rows
from squealpipe.laws.tables import named
from squealpipe.structures.meshes.faces import Face
from squealpipe.structures.units import SI, Scales
from squealpipe.systems.inputs.values import brief, is_finite_number
from squealpipe.systems.inputs.words import suggestion


def faces_in(content: Any, folder: Path, scales: Scales) -> dict[str, Face]:
    """Return the faces of the mapping ``contacts``, in SI.

    Args:
        content: by the name of each face its arguments; plain numbers are in the file's units.
        folder: in which a file of pressures is.

    Raises:
        ValueError: names the face, its argument and what is needed.
    """
    if not isinstance(content, Mapping) or not content:
        raise ValueError(
            f"contacts = {brief(content)}: the name of a file is needed, a table of them, or "
            "faces of a mesh by name"
        )
    faces = {}
    for name, entry in content.items():
        try:
            faces[str(name)] = _face(entry, folder, scales)
        except (ValueError, FileNotFoundError) as error:
            raise type(error)(f"contacts: {name}: {error}") from error
    return faces


def _face(entry: Any, folder: Path, scales: Scales) -> Face:
    if not isinstance(entry, Mapping):
        raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
            f"{brief(entry)}: surface, against, stiffness and pressure are needed"
        )
    face_keys = tuple(field.name for field in fields(Face))
    for key in entry:
        if key not in face_keys:
            raise ValueError(f"{key!r} is unknown; {suggestion(str(key), face_keys)}")
    if "surface" not in entry:
        raise ValueError("surface is missing; name one of the mesh")
    arguments = dict(entry)
    for key, factor in (
        ("stiffness", scales.stiffness),
        ("tangential_stiffness", scales.stiffness),
        ("stiffness_per_area", scales.stiffness_per_area),
        ("pressure", scales.pressure),
        ("force", scales.force),
    ):
        if is_finite_number(arguments.get(key)):
            arguments[key] = float(arguments[key]) * factor
    if isinstance(arguments.get("pressures"), str):
        path = folder / arguments["pressures"]
        arguments["pressures"] = read_pressures(path, scales)
    if "law" in arguments:
        arguments["law"] = _law(arguments["law"], folder, scales)
    return Face(**arguments)


def _law(given: Any, folder: Path, scales: Scales) -> Any:
    """Return a law whose file is found and whose plain numbers are in SI."""
    if isinstance(given, Mapping):
        given = dict(given)
        for column, factor in zip(
            own_law_rules.columns, (scales.length, scales.force), strict=True
        ):
            if isinstance(given.get(column), list):
                given[column] = [
                    float(each) * factor if is_finite_number(each) else each
                    for each in given[column]
                ]
    try:
        return named(given, own_law_rules.columns, folder)
    except (ValueError, OSError) as error:
        raise ValueError(f"law: {error}") from error


def read_pressures(path: Path, scales: Scales = SI) -> dict[int, float]:
    """Return {node: pressure} of a file with both in each line, in Pa.

    Raises:
        FileNotFoundError: no such file.
        ValueError: a line that has not both, or a node twice; names it.
    """
    if not path.is_file():
        raise FileNotFoundError(f"pressures: no file {path}")
    table = text_rows(path, lambda _: False)
    cells = []
    for row in table.rows:
        pair = [numeral(cell) for cell in row.cells if cell]
        if len(pair) != 2 or None in pair or any(each.unit for each in pair if each):
            raise ValueError(
                f"pressures: {path}, line {row.number}: {brief(row.cells)}: a node and its "
                "pressure are needed"
            )
        cells.append((row.number, pair[0].text, pair[1].text))  # type: ignore[union-attr]
    sign = decimal_sign(
        ((f"line {line}", text) for line, _, text in cells), table.separator
    )
    pressures: dict[int, float] = {}
    for line, node, text in cells:
        if not node.isdecimal() or int(node) in pressures:
            what = "is there twice" if node.isdecimal() else "is no node"
            raise ValueError(f"pressures: {path}, line {line}: {node} {what}")
        pressures[int(node)] = float(plain(text, sign)) * scales.pressure
    return pressures
