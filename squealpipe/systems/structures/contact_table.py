"""A table of contacts: name, normal, tangential, stiffness, preload and speed by column.

Text in any encoding, with commas, semicolons or tabs between its cells, or an Excel sheet.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.laws.rows import FileRow, text_rows
from squealpipe.laws.sheets import sheet
from squealpipe.parameters import brief, finite_number
from squealpipe.systems.structures.contact import Contact
from squealpipe.systems.structures.units import Scales
from squealpipe.text import suggestion
from squealpipe.units import has_unit

CONTACT_COLUMNS = ("name", "normal", "tangential", "stiffness", "preload")
KNOWN = (*CONTACT_COLUMNS, "speed")
HEADER = f"its first row must name the columns, like {','.join(CONTACT_COLUMNS)}"


def read_contacts(
    path: Path, labels: list[str] | None, size: int, scales: Scales
) -> list[Contact]:
    """The contacts of a table, in SI units.

    Args:
        labels: of the matrices' rows, ``node.direction``, where they have some.
        size: degrees of freedom.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the line and what is wrong there.
    """
    header, rows = _rows(path)
    contacts = []
    for line, cells in rows:
        where = f"{path}, line {line}"
        row = dict(zip(header, cells, strict=False))
        row.pop("", "")
        nameless = [cell for name, cell in zip(header, cells, strict=False) if not name]
        if any(nameless) or any(cells[len(header) :]):
            raise ValueError(
                f"{where} has {len(cells)} cells, but the header {len(header)} columns"
            )
        # a cell has a unit of its own, or is a number in the units of the file
        numbers = {
            name: (
                finite_number(f"{where}: {name}", row[name], units)
                if has_unit(row[name])
                else _number(row[name], f"{where}: {name}") * factor
            )
            for name, units, factor in (
                ("stiffness", "N m-1", scales.stiffness),
                ("preload", "N", scales.force),
                ("speed", "1", 1.0),
            )
            if row.get(name)
        }
        for name in CONTACT_COLUMNS:
            if not row.get(name):
                raise ValueError(f"{where}: {name} is missing")
        try:
            contacts.append(
                Contact(
                    row["name"],
                    _direction(row["normal"], labels, size),
                    _direction(row["tangential"], labels, size),
                    numbers["stiffness"],
                    numbers["preload"],
                    numbers.get("speed", 1.0),
                )
            )
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from error
    return contacts


def _rows(path: Path) -> tuple[list[str], list[FileRow]]:
    """The names of the columns, and the rows below by their line."""
    if not path.is_file():
        raise FileNotFoundError(f"contacts: no file {path}")
    excel = path.suffix.lower() == ".xlsx"
    table = (sheet if excel else text_rows)(path, lambda row: "name" in row)
    if not table.rows:
        raise ValueError(f"{path} is empty; {HEADER}")
    header = table.rows[0].cells
    if not set(header) & set(KNOWN):
        raise ValueError(f"{path} begins with {brief(header)}; {HEADER}")
    for name in header:
        if name in KNOWN or not name:
            continue
        if any(name.startswith(known) for known in KNOWN):
            raise ValueError(
                f"{path}: column {name!r}: {suggestion(name, KNOWN)} Units stand in the "
                "structure's file, like `units: mm-t-s`"
            )
        raise ValueError(f"{path}: column {name!r}: {suggestion(name, KNOWN)}")
    for name in CONTACT_COLUMNS:
        if name not in header:
            raise ValueError(
                f"{path} has no column {name!r}; it has {', '.join(header)}"
            )
    names = [name for name in header if name]
    if len(set(names)) < len(names):
        raise ValueError(f"{path}: a column is there twice; it has {', '.join(names)}")
    return header, table.rows[1:]


def _direction(text: str, labels: list[str] | None, size: int) -> dict[int, float]:
    """{degree of freedom from 0: coefficient} of ``12:1 40:-1``, or of ``31.2:1``."""
    direction: dict[int, float] = {}
    for part in re.sub(r"\s*:\s*", ":", text.replace(",", " ")).split():
        place, colon, coefficient = part.partition(":")
        if not colon:
            raise ValueError(f"{part!r} is no direction; write for instance 12:1 40:-1")
        if "." in place:
            if labels is None:
                raise ValueError(
                    f"{place}: the matrices have no labels; count rows from 1"
                )
            if place not in labels:
                raise ValueError(f"{place}: no such node and direction in the matrices")
            number = labels.index(place)
        else:
            row = _number(place, "degree of freedom")
            number = int(row) - 1
            if row != int(row) or not 0 <= number < size:
                raise ValueError(
                    f"{place}: degrees of freedom are 1 to {size} in files"
                )
            if labels is not None:
                # a node's number would be taken for that of a row
                raise ValueError(
                    f"{place} is a row, but the matrices name nodes and directions; write "
                    f"{labels[number]} if row {place} is meant"
                )
        direction[number] = direction.get(number, 0.0) + _number(coefficient, place)
    return direction


def _number(text: Any, what: str) -> float:
    try:
        value = float(text)
    except (TypeError, ValueError):
        raise ValueError(
            f"{what} = {brief(text)}: a number is needed, with a decimal point"
        ) from None
    if not np.isfinite(value):
        raise ValueError(f"{what} = {brief(text)}: a finite number is needed")
    return value
