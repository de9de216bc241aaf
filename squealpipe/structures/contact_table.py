"""A table of contacts: name, normal, tangential, stiffness, preload, law, speed and mu by column.

Text in any encoding, with commas, semicolons or tabs between its cells, or an Excel sheet.
"""

import csv
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from squealpipe.laws.contact_laws import own_law_rules
from squealpipe.laws.numerals import Numeral, decimal_sign, numeral, plain
from squealpipe.laws.rows import FileRows, text_rows
from squealpipe.laws.sheets import IS_TIME, sheet
from squealpipe.laws.table_files import ENDINGS
from squealpipe.laws.tables import knots_of, read_table
from squealpipe.parameters import finite_number
from squealpipe.store.whole_files import whole_file
from squealpipe.structures.contact import Contact, PointOrigin
from squealpipe.structures.units import Scales
from squealpipe.systems.inputs.values import brief
from squealpipe.systems.inputs.words import suggestion

CONTACT_COLUMNS = ("name", "normal", "tangential", "stiffness", "preload")
ORIGIN_COLUMNS = ("nodes", "against", "area", "gap", "facet", "x", "y", "z")
"""Columns that say where a contact of a mesh comes from."""
KNOWN = (
    *CONTACT_COLUMNS,
    *("law", "speed", "mu", "mu_static", "tangential_stiffness", "across"),
    *ORIGIN_COLUMNS,
)


def read_contacts(
    path: Path,
    labels: list[str] | None,
    size: int,
    scales: Scales,
    *,
    turning: bool = False,
) -> list[Contact]:
    """The contacts of a table, in SI units.

    Args:
        labels: of the matrices' rows, ``node.direction``, where they have some.
        size: degrees of freedom.
        turning: whether what rubs turns, so that ``speed`` is a radius.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the line and what is wrong there.
    """
    header, table = _rows(path)
    lines = []
    for line, cells in table.rows:
        where = f"{path}, line {line}"
        row = dict(zip(header, cells, strict=False))
        row.pop("", "")
        nameless = [cell for name, cell in zip(header, cells, strict=False) if not name]
        if any(nameless) or any(cells[len(header) :]):
            raise ValueError(
                f"{where} has {len(cells)} cells, but the header {len(header)} columns"
            )
        for name in CONTACT_COLUMNS:
            if not row.get(name) and not (name == "stiffness" and row.get("law")):
                raise ValueError(f"{where}: {name} is missing")
        for name in row.keys() - {"name"}:
            table.refuse_doubtful(path, line, row[name])
        lines.append(
            _Line(
                where,
                row["name"],
                _terms(where, row),
                _numerals(where, row),
                _nodes(where, row),
                _law(where, row, path.parent, is_sheet=path.suffix.lower() == ".xlsx"),
                turning,
            )
        )
    # all cells together tell whether numbers have a decimal point or comma
    written = (cell for line in lines for cell in line.written())
    sign = decimal_sign(written, table.separator)
    return [line.contact(sign, labels, size, scales) for line in lines]


class _Term(NamedTuple):
    """One term of a direction as it is written: a degree of freedom and its coefficient."""

    place: str
    coefficient: Numeral


class _Line(NamedTuple):
    """A row of the table, before it is known which of comma and point is the decimal sign."""

    where: str
    name: str
    directions: dict[str, list[_Term]]
    numerals: dict[str, Numeral]
    nodes: dict[str, tuple[int, ...]]
    law: str | list[tuple[Numeral, Numeral]] | None
    turning: bool

    def written(self) -> Iterator[tuple[str, str]]:
        """Yield where each number stands, and its text."""
        for key, terms in self.directions.items():
            for term in terms:
                yield f"{self.where}: {key}", term.coefficient.text
        for key, each in self.numerals.items():
            yield f"{self.where}: {key}", each.text
        if isinstance(self.law, list):
            for number in (number for pair in self.law for number in pair):
                yield f"{self.where}: law", number.text

    def contact(
        self, sign: str, labels: list[str] | None, size: int, scales: Scales
    ) -> Contact:
        """The contact, in SI units."""
        try:
            arguments: dict[str, Any] = {
                key: _direction(terms, sign, labels, size)
                for key, terms in self.directions.items()
            }
            # who names the direction across asks for friction's damping along it
            transverse = "across" in arguments
            values = self._values(sign, scales)
            arguments |= {k: v for k, v in values.items() if k not in ORIGIN_COLUMNS}
            arguments["origin"] = self._origin(values)
            arguments["law"] = self._law(sign, scales)
            return Contact(self.name, **arguments, transverse_damping=transverse)
        except ValueError as error:
            raise ValueError(f"{self.where}: {error}") from error

    def _values(self, sign: str, scales: Scales) -> dict[str, float]:
        factors = {
            "stiffness": scales.stiffness,
            "tangential_stiffness": scales.stiffness,
            "preload": scales.force,
            "area": scales.length**2,
            **dict.fromkeys(("gap", "facet", "x", "y", "z"), scales.length),
        }
        units = dict(CONTACT_UNITS)
        if self.turning:
            factors["speed"], units["speed"] = scales.length, "m"
        values = {}
        for key, each in self.numerals.items():
            values[key] = _in_si(key, each, sign, units[key], factors.get(key, 1.0))
        return values

    def _law(self, sign: str, scales: Scales) -> Any:
        """Return the law as a contact takes it; plain numbers are in the units of the file."""
        if not isinstance(self.law, list):
            return self.law
        columns = {}
        for key, numbers, unit, factor in zip(
            own_law_rules.columns,
            zip(*self.law, strict=True),
            own_law_rules.units,
            (scales.length, scales.force),
            strict=True,
        ):
            columns[key] = [
                _in_si(f"law: {key}", number, sign, unit, factor) for number in numbers
            ]
        return columns

    def _origin(self, values: Mapping[str, float]) -> PointOrigin | None:
        """Return where the contact comes from, if the row says all of it."""
        if not self.nodes.get("nodes") or not {"area", "x", "y", "z"} <= values.keys():
            return None
        return PointOrigin(
            self.nodes["nodes"],
            self.nodes.get("against", ()),
            values["area"],
            values.get("gap", 0.0),
            (values["x"], values["y"], values["z"]),
            values.get("facet", math.nan),
        )


CONTACT_UNITS = {
    "stiffness": "N m-1",
    "preload": "N",
    "speed": "1",
    "mu": "1",
    "mu_static": "1",
    "tangential_stiffness": "N m-1",
    "area": "m2",
    **dict.fromkeys(("gap", "facet", "x", "y", "z"), "m"),
}
"""Columns of numbers → CF unit."""


def _in_si(name: str, number: Numeral, sign: str, unit: str, factor: float) -> float:
    """Return a number that has a unit of its own, or else is in the units of the file."""
    text = plain(number.text, sign)
    if number.unit:
        return finite_number(name, f"{text} {number.unit}", unit)
    return finite_number(name, float(text), unit) * factor


def _law(
    where: str, row: Mapping[str, str], folder: Path, *, is_sheet: bool
) -> str | list[tuple[Numeral, Numeral]] | None:
    """Return the law of a row: the text of the table that it names, or pairs of numbers."""
    text = row.get("law", "").strip()
    if not text:
        return None
    if text.lower().endswith(ENDINGS):
        if is_sheet:
            raise ValueError(
                f"{where}: law = {text}: a sheet of Excel cannot name a file, which an archive "
                "would not find; write compressions and forces, like 0:0 0.01mm:90N, or save the "
                "contacts as .csv"
            )
        try:
            return read_table(folder / text, own_law_rules.columns)
        except (ValueError, OSError) as error:
            raise ValueError(f"{where}: law: {error}") from error
    pairs = []
    for pair in text.removeprefix("linear ").split():
        numbers = [numeral(part) for part in pair.split(":")]
        if len(numbers) != 2 or None in numbers:
            raise ValueError(
                f"{where}: law = {brief(text)}: the name of a table is needed, or compressions and "
                "forces, like 0:0 0.01mm:90N 0.02mm:240N"
            )
        pairs.append((numbers[0], numbers[1]))
    return pairs  # type: ignore[return-value]


def _numerals(where: str, row: Mapping[str, str]) -> dict[str, Numeral]:
    """The numbers of a row as they are written."""
    return {
        key: _numeral(f"{where}: {key}", row[key])
        for key in CONTACT_UNITS
        if row.get(key)
    }


def _numeral(where: str, text: str) -> Numeral:
    number = numeral(text)
    if number is None:
        raise ValueError(
            f"{where} = {brief(text)}: a number is needed, like 1.5 or 2e7"
        )
    return number


def _nodes(where: str, row: Mapping[str, str]) -> dict[str, tuple[int, ...]]:
    """The numbers of nodes in the columns that have some."""
    nodes = {}
    for key in ("nodes", "against"):
        words = row.get(key, "").split()
        if not all(word.isdecimal() for word in words):
            raise ValueError(
                f"{where}: {key} = {row[key]}: numbers of nodes are needed, like 12 40"
            )
        nodes[key] = tuple(map(int, words))
    return nodes


def write_contacts(
    contacts: Sequence[Contact],
    names: Sequence[str],
    path: Path,
    *,
    turning: bool = False,
) -> None:
    """Write contacts as a table that :func:`read_contacts` reads back to the same numbers.

    Args:
        names: of the degrees of freedom, ``node.direction``, or their numbers from 1.
        turning: whether ``speed`` is a radius.
        path: a text file (.csv).
    """
    rows = []
    for contact in contacts:
        row = {"name": contact.name}
        for which in ("normal", "tangential", "across"):
            if getattr(contact, which) is not None:
                vector = contact.direction(which, len(names))
                row[which] = " ".join(
                    f"{names[place]}:{float(vector[place])!r}"
                    for place in np.flatnonzero(vector).tolist()
                )
        row |= {
            **_force_cells(contact),
            "preload": f"{contact.preload!r} N",
            "speed": f"{contact.speed!r} m" if turning else repr(contact.speed),
        }
        for key in ("mu", "mu_static"):
            if getattr(contact, key) is not None:
                row[key] = repr(getattr(contact, key))
        if contact.tangential_stiffness is not None:
            row["tangential_stiffness"] = f"{contact.tangential_stiffness!r} N/m"
        if (origin := contact.origin) is not None:
            row |= {
                "nodes": " ".join(map(str, origin.nodes)),
                "against": " ".join(map(str, origin.against)),
                "area": f"{origin.area!r} m^2",
                "gap": f"{origin.gap!r} m",
                "facet": "" if math.isnan(origin.facet) else f"{origin.facet!r} m",
                **{
                    axis: f"{value!r} m"
                    for axis, value in zip("xyz", origin.position, strict=True)
                },
            }
        rows.append(row)
    columns = [key for key in KNOWN if any(key in row for row in rows)]
    with (
        whole_file(path) as temporary,
        temporary.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.DictWriter(file, columns, restval="")
        writer.writeheader()
        writer.writerows(rows)


def _force_cells(contact: Contact) -> dict[str, str]:
    """The cell of the stiffness, or of the law, with units."""
    if contact.law is None:
        return {"stiffness": f"{contact.stiffness!r} N/m"}
    pairs = zip(*knots_of(contact.law), strict=True)
    return {"law": " ".join(f"{knot!r}m:{force!r}N" for knot, force in pairs)}


def _rows(path: Path) -> tuple[list[str], FileRows]:
    """The names of the columns, and the rows below."""
    if not path.is_file():
        raise FileNotFoundError(f"contacts: no file {path}")
    excel = path.suffix.lower() == ".xlsx"
    table = (sheet if excel else text_rows)(path, lambda row: "name" in row)
    hint = f"its first row must name the columns, like {','.join(CONTACT_COLUMNS)}"
    if not table.rows:
        raise ValueError(f"{path} is empty; {hint}")
    header = table.rows[0].cells
    if not set(header) & set(KNOWN):
        raise ValueError(f"{path} begins with {brief(header)}; {hint}")
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
        if name not in header and not (name == "stiffness" and "law" in header):
            raise ValueError(
                f"{path} has no column {name!r}; it has {', '.join(header)}"
            )
    names = [name for name in header if name]
    if len(set(names)) < len(names):
        raise ValueError(f"{path}: a column is there twice; it has {', '.join(names)}")
    return header, table._replace(rows=table.rows[1:])


def _terms(where: str, row: Mapping[str, str]) -> dict[str, list[_Term]]:
    """The terms of each direction, like ``12:1 40:-1`` or ``31.2:0,5; 31.3:1``."""
    terms: dict[str, list[_Term]] = {}
    for key in ("normal", "tangential", "across"):
        if key == "across" and not row.get(key):
            continue
        if row[key].endswith(IS_TIME):
            raise ValueError(f"{where}: {key} = {row[key]}, like 12:1")
        text = re.sub(r"\s*:\s*", ":", row[key].strip())
        # what separates terms stands before a degree of freedom and its colon
        parts = [part.strip(" ,;") for part in re.split(r"[\s,;]+(?=[^\s,;:]+:)", text)]
        terms[key] = []
        for part in filter(None, parts):
            place, colon, coefficient = part.partition(":")
            if not colon:
                raise ValueError(
                    f"{where}: {part!r} is no direction; write for instance 12:1 40:-1"
                )
            number = _numeral(f"{where}: {key}: {place}", coefficient)
            if number.unit:
                raise ValueError(
                    f"{where}: {part!r} is no direction: a coefficient has no unit"
                )
            terms[key].append(_Term(place, number))
    return terms


def _direction(
    terms: Sequence[_Term], sign: str, labels: list[str] | None, size: int
) -> dict[int, float]:
    """{degree of freedom from 0: coefficient}; ``31.2`` is a node and its direction."""
    direction: dict[int, float] = {}
    for place, coefficient in terms:
        if "." in place:
            if labels is None:
                raise ValueError(
                    f"{place}: the matrices have no labels; count rows from 1"
                )
            if place not in labels:
                node = place.partition(".")[0]
                own = [label for label in labels if label.partition(".")[0] == node]
                known = (
                    f"node {node} has {', '.join(own)}" if own else f"like {labels[0]}"
                )
                raise ValueError(
                    f"{place}: no such node and direction in the matrices ({known})"
                )
            number = labels.index(place)
        else:
            number = int(place) - 1 if re.fullmatch(r"\d{1,9}", place, re.ASCII) else -1
            if not 0 <= number < size:
                raise ValueError(
                    f"{place}: degrees of freedom are 1 to {size} in files"
                )
            if labels is not None:
                # a node's number would be taken for that of a row
                raise ValueError(
                    f"{place} is a row, but the matrices name nodes and directions; write "
                    f"{labels[number]} if row {place} is meant"
                )
        value = float(plain(coefficient.text, sign))
        direction[number] = direction.get(number, 0.0) + value
    return direction
