"""Headers of tables: where the columns of knots and values stand, and their units.

A unit stands behind a name in many ways, in a row of its own, or only in a comment, which is no
place to guess from. :mod:`squealpipe.laws.table_files` converts the numbers, and refuses a unit
that does not fit its column.
"""

import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from squealpipe.laws.numerals import numeral
from squealpipe.laws.rows import FileLine, FileRow, FileRows
from squealpipe.systems.inputs.units import (
    USUAL,
    UnitError,
    in_si,
    is_long_name,
    is_unit,
    plain_unit,
)

COLUMN_UNITS = {"speed": "m s-1", "coefficient": "1", "compression": "m", "force": "N"}
"""Column → CF unit in which its values are stored, and meant where none is written."""

_NO_UNITS_BUT_NAMES = ("c", "in")
"""Last words of names that are hardly the speed of light, or inches."""
NO_UNIT = {"", "-", "–", "—", "1", "/"}


def cell_at(cells: Sequence[str], at: int) -> str:
    """A cell of a row, which may be shorter than its header."""
    return cells[at] if at < len(cells) else ""


class Place(NamedTuple):
    """A column of the table: its name, where it stands, as the file heads it, and its unit."""

    name: str
    at: int
    head: str
    unit: str


def header_row(
    path: Path,
    table: FileRows,
    columns: tuple[str, str],
    is_header: Callable[[Sequence[str]], list[int]],
) -> int:
    """Return the index of the header: the row with the name of the knots over a number."""
    cells = [row.cells for row in table.rows]
    candidates = {
        number: at for number, row in enumerate(cells) if (at := is_header(row))
    }
    of_words = {
        n: at for n, at in candidates.items() if not any(map(numeral, cells[n]))
    }
    candidates = of_words or candidates  # not a line like speed;2 m/s above the table
    for number, at in candidates.items():
        below = [numeral(cell_at(row, at[0])) for row in cells[number + 1 : number + 3]]
        if any(below[:1]) or (any(below[1:]) and number + 1 not in candidates):
            return number
    if candidates:
        return max(candidates)
    first = next((number for number, row in enumerate(cells) if _is_data(row)), None)
    separators_shown = {"\t": "<tab>", " ": "  "}
    if not cells or first == 0:
        example = separators_shown.get(table.separator, table.separator).join(columns)
        raise ValueError(f"{path} has no header; write a first row like {example}")
    if first is None:
        first = len(cells)
    return first - 2 if first > 1 and _are_units(cells[first - 1]) else first - 1


def _is_data(row: Sequence[str]) -> bool:
    """Return whether a row holds numbers: its first cell with content is one."""
    return numeral(next(filter(None, row), "")) is not None


def _are_units(row: Sequence[str]) -> bool:
    written = [unit for cell in row if (unit := _bare(cell)) not in NO_UNIT]
    return bool(written) and all(map(is_unit, written))


def units_row(path: Path, row: FileRow, places: Sequence[Place]) -> list[str] | None:
    """Units of both columns, if the row below the header is one of units."""
    written = [_bare(cell_at(row.cells, place.at)) for place in places]
    if any(numeral(unit) and unit not in NO_UNIT for unit in written):
        return None
    if not any(unit not in NO_UNIT for unit in written) and "1" in written:
        return None
    has_units = any(unit not in NO_UNIT and is_unit(unit) for unit in written)
    for unit, place in zip(written, places, strict=True):
        if unit not in NO_UNIT and not is_unit(unit):
            without = (
                "- for none"  # the row holds the unit of the other column
                if has_units
                else f"take the row out if the column is in {_unit_in_words(place)}"
            )
            raise ValueError(
                f"{path}, row {row.number}: {unit!r} is no number, nor a unit that is known; write "
                f"a number there, or a unit of {place.name}, or {without}"
            )
    return [unit if unit not in NO_UNIT else "" for unit in written]


def _unit_in_words(place: Place) -> str:
    unit = place.unit or plain_unit(COLUMN_UNITS[place.name])
    return unit or "plain numbers"


def _bare(cell: str) -> str:
    return cell.strip("[]() ")


def _split(name: str, units: str) -> tuple[str, str]:
    """Name and unit of a header like ``speed (km/h)``, ``v / (m/s)``, ``v in m/s``, ``v_kmh``.

    Args:
        units: CF unit of the column: one that fits may be set apart by a blank alone.
    """
    # speed [km/h], speed / (km/h), speed {km/h}
    if match := re.compile(
        r"(.*?)\s*/?\s*[\[({<]\s*(.*?)\s*[\])}>]\s*(.*)", re.DOTALL
    ).fullmatch(name):
        unit = match[2].removeprefix("in ").strip("[]() ")
        return match[1] or match[3], _known(unit, units)
    # the unit is the last word or two of a header like speed_mm_s
    patterns = (
        re.compile(r"(.+?)[\s_,:;=/-]+([^\W\d_]+_[^\W\d_]+)"),  # speed_mm_s
        re.compile(r"(.+?)[\s_,:;=/-]+([^\s_,:;=]+)"),
    )
    for form in patterns:  # MATLAB writes speed_km_h_
        if (match := form.fullmatch(name.rstrip("_"))) and match[
            2
        ] not in _NO_UNITS_BUT_NAMES:
            unit = _known(match[2].replace("_", "/"), units)
            if _fits(unit, units):
                return match[1].removesuffix(" in").rstrip(" /"), unit
    # speed in km/h, speed / km/h
    if match := re.fullmatch(r"(.+?)(\s+in\s+|\s*/\s*)(.+)", name):
        unit = _bare(match[3])
        if is_unit(unit) or "in" in match[2] or unit in NO_UNIT:
            return match[1], unit
    if (match := patterns[1].fullmatch(name)) and re.search(r"\w/\w", match[2]):
        return match[1], match[2]  # like a unit, and unknown: refused if it is needed
    return name, ""


def _known(unit: str, units: str) -> str:
    """A unit, in small letters where it is one of the column only so, like KM/H."""
    small = unit.lower()
    return small if not is_unit(unit) and _fits(small, units) else unit


def _fits(unit: str, units: str) -> bool:
    try:
        in_si(f"1 {unit}", units)
    except UnitError:
        return False
    return True


def named(header: Sequence[str], name: str, units: str) -> list[int]:
    """Return the columns of a header that have a name, with or without its unit."""
    wanted = name.casefold().strip()
    return [
        at
        for at, cell in enumerate(header)
        if wanted in {cell.casefold(), _split(cell, units)[0].casefold()}
    ]


def places(
    path: Path,
    header: Sequence[str],
    columns: tuple[str, str],
    chosen: tuple[str | None, str | None],
) -> list[Place]:
    """Return the columns of the knots and of the values."""
    filled = [at for at, name in enumerate(header) if name]
    options = (f"{columns[0]}_column", "value_column")
    where = [
        named(header, name or column, COLUMN_UNITS[column])
        for name, column in zip(chosen, columns, strict=True)
    ]
    if len(where[0]) == 1 and not where[1] and chosen[1] is None and len(filled) == 2:
        where[1] = [at for at in filled if at != where[0][0]]
        _refuse_other_unit(path, header[where[1][0]], columns[1])
    for at, name, column, option in zip(where, chosen, columns, options, strict=True):
        if len(at) > 1:
            raise ValueError(
                f"{path} has {len(at)} columns {name or column!r}; rename all but one"
            )
        if not at:
            names = ", ".join(header[number] for number in filled)
            what = f"{path} has no column {name or column!r}"
            if len(filled) == 1:
                raise ValueError(
                    f"{what}, only {names!r}; separate the cells of a row with ; or a tab"
                )
            if all(numeral(header[number]) for number in filled[1:]):
                raise ValueError(
                    f"{what}; the names stand in its first column: turn it, so that each name "
                    "stands above its numbers"
                )
            looks = "" if names.isascii() else " (do they look wrong? save it in UTF-8)"
            raise ValueError(
                f"{what}; its columns: {names}{looks}; name one of them {column!r}, or write "
                f"{option}: with its name{_unit_too(column)}"
            )
    if where[0] == where[1]:
        raise ValueError(f"{path}: knots and values are to be two columns, not one")
    return [
        Place(
            column, at[0], header[at[0]], _split(header[at[0]], COLUMN_UNITS[column])[1]
        )
        for column, at in zip(columns, where, strict=True)
    ]


def _refuse_other_unit(path: Path, head: str, column: str) -> None:
    """Refuse a column of any name whose last word is a unit of something else: ``force kg``."""
    word = re.split(r"[\s_,:;=/-]+", head.rstrip("_ "))[-1]
    everyday = len(word) > 1 and word in (
        *USUAL,
        "ton",
        "tons",
        "lb",
        "lbs",
        "lbf",
        "kgf",
    )
    if everyday and not _split(head, COLUMN_UNITS[column])[1]:
        raise ValueError(
            f"{path}: column {head!r} ends in {word}, which is no unit of {column}; write its unit "
            f"in brackets, like {column} [{plain_unit(COLUMN_UNITS[column]) or '%'}], or take the "
            "word out"
        )


def _unit_too(column: str) -> str:
    """Say that a column that is renamed, and not in SI, needs its unit in the new name, too."""
    unit = plain_unit(COLUMN_UNITS[column])
    return f" (what is not in {unit} needs its unit behind the name)" if unit else ""


def refuse_units_elsewhere(path: Path, place: Place, lines: Iterable[FileLine]) -> None:
    """Refuse a column without a unit where a comment, or a line above, speaks of one.

    Args:
        lines: comments and what stands above the header, with their numbers.
    """
    units = COLUMN_UNITS[place.name]
    if place.unit or units == "1":
        return
    usual = plain_unit(units)
    for number, line in lines:
        # a word without a number before it: in "preload 4 kN" there is no unit of a column
        for word in re.findall(
            r"(?<![\d.,]\s)(?<![\w.,/^])[^\W\d][^\s,;:=()\[\]{}]*", line
        ):
            if (
                word in (usual, *_NO_UNITS_BUT_NAMES)
                or is_long_name(word)
                or not _fits(word, units)
            ):
                continue
            raise ValueError(
                f"{path}, row {number} speaks of {word}, and column {place.head!r} has no unit; "
                f"write it behind the name, like {place.head} [{word}] or {place.head} [{usual}]"
            )
