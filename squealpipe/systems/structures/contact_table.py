"""A table of contacts: name, normal, tangential, stiffness, preload and speed by column."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.parameters import brief
from squealpipe.systems.structures.contact import Contact
from squealpipe.systems.structures.units import Scales
from squealpipe.text import suggestion

CONTACT_COLUMNS = ("name", "normal", "tangential", "stiffness", "preload")


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
    if not path.is_file():
        raise FileNotFoundError(f"contacts: no file {path}")
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = csv.DictReader(file, skipinitialspace=True)
        columns = [name.strip() for name in rows.fieldnames or []]
        rows.fieldnames = columns
        for name in columns:
            if name not in (*CONTACT_COLUMNS, "speed"):
                known = (*CONTACT_COLUMNS, "speed")
                raise ValueError(f"{path}: column {name!r}: {suggestion(name, known)}")
        for name in CONTACT_COLUMNS:
            if name not in columns:
                raise ValueError(
                    f"{path} has no column {name!r}; it has {', '.join(columns)}"
                )
        contacts = []
        for row in rows:
            where = f"{path}, line {rows.line_num}"
            numbers = {
                name: _number(row.get(name), f"{where}: {name}")
                for name in ("stiffness", "preload", "speed")
                if (row.get(name) or "").strip()
            }
            for name in ("stiffness", "preload"):
                if name not in numbers:
                    raise ValueError(f"{where}: {name} is missing")
            try:
                contacts.append(
                    Contact(
                        (row["name"] or "").strip(),
                        _direction(row["normal"], labels, size),
                        _direction(row["tangential"], labels, size),
                        numbers["stiffness"] * scales.stiffness,
                        numbers["preload"] * scales.force,
                        numbers.get("speed", 1.0),
                    )
                )
            except ValueError as error:
                raise ValueError(f"{where}: {error}") from error
    return contacts


def _direction(
    text: str | None, labels: list[str] | None, size: int
) -> dict[int, float]:
    """{degree of freedom from 0: coefficient} of ``12:1 40:-1``, or of ``31.2:1``."""
    direction: dict[int, float] = {}
    for part in (text or "").split():
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
            number = int(_number(place, "degree of freedom")) - 1
            if not 0 <= number < size:
                raise ValueError(
                    f"{place}: degrees of freedom are 1 to {size} in files"
                )
        direction[number] = direction.get(number, 0.0) + _number(coefficient, place)
    return direction


def _number(text: Any, what: str) -> float:
    try:
        value = float(text)
    except (TypeError, ValueError):
        raise ValueError(f"{what} = {brief(text)}: a number is needed") from None
    if not np.isfinite(value):
        raise ValueError(f"{what} = {brief(text)}: a finite number is needed")
    return value
