"""Files of tables as instruments, Excel and papers write them, read as two columns in SI.

What cannot be known is refused by file, row and reason, never guessed: a comma that may separate
thousands, a row with more cells than names, a column without a known name.
"""

import re
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from squealpipe.laws.numerals import Numeral, decimal_sign, numeral, plain
from squealpipe.laws.rows import Rows, sheet, text_rows
from squealpipe.units import UnitError, in_si, is_unit, plain_unit

ENDINGS = (".csv", ".txt", ".tsv", ".dat", ".xlsx")
"""Of files that are read as tables without being called so."""
UNITS = {"speed": "m s-1", "coefficient": "1", "compression": "m", "force": "N"}
"""Column → CF unit in which its values are stored, and meant where none is written."""
LARGEST_COEFFICIENT = 2.0
"""A larger coefficient of friction is rather one in per cent, or another column."""

_BRACKETS = re.compile(r"(.*?)\s*/?\s*[\[({<]\s*(.*?)\s*[\])}>]\s*(.*)", re.DOTALL)
_BEHIND = re.compile(r"(.+?)(\s+in\s+|\s*/\s*)(.+)")
_LAST_WORDS = (
    re.compile(r"(.+?)[\s_,:;=/-]+([^\W\d_]+_[^\W\d_]+)"),  # speed_mm_s
    re.compile(r"(.+?)[\s_,:;=/-]+([^\s_,:;=]+)"),
)
_NAMES = ("c", "in")
"""Last words of names that are hardly the speed of light, or inches."""
_NO_UNIT = {"", "-", "–", "—", "1", "/"}
_SHOWN = {"\t": "<tab>", " ": "  "}
"""Separators as a message shows them."""


class Place(NamedTuple):
    """A column of the table: its name, where it stands, as the file heads it, and its unit."""

    name: str
    at: int
    head: str
    unit: str


class Cell(NamedTuple):
    """A cell that is needed: the row's number, and what is written."""

    row: int
    text: str


def read_pairs(
    path: str | PathLike[str],
    columns: tuple[str, str],
    chosen: tuple[str | None, str | None] = (None, None),
) -> list[tuple[float, float]]:
    """Knots and values of a file in SI.

    Args:
        columns: names of the columns of knots and values; of two columns that of values may have
            any name.
        chosen: names of the columns to take instead, as the file has them.

    Raises:
        ValueError: names the file, the row and what to write instead.
    """
    path = Path(path)

    def is_header(row: Sequence[str]) -> list[int]:
        return _named(row, chosen[0] or columns[0], UNITS[columns[0]])

    excel = path.suffix.lower() == ".xlsx"
    table = sheet(path, is_header) if excel else text_rows(path)
    start = _header(path, table, columns, is_header)
    header = table.rows[start][1]
    places = _places(path, header, columns, chosen)
    data = [row for row in table.rows[start + 1 :] if row[1] != header]
    if data and (units := _units_row(path, data[0], places)) is not None:
        places = [
            place._replace(unit=unit or place.unit)
            for place, unit in zip(places, units, strict=True)
        ]
        first = data[0][1]
        data = [row for row in data if row[1] != first]
    if not data:
        raise ValueError(f"{path} has no rows below its header")
    for row, cells in data:
        if places[0].at in is_header(cells):
            raise ValueError(
                f"{path}, row {row} is the header of a second table; save each as a file of its own"
            )
    _check_rows(path, len(header), data)
    columns_of_cells = [
        [Cell(row, _at(cells, place.at)) for row, cells in data] for place in places
    ]
    knots, values = _in_si(path, table.separator, places, columns_of_cells)
    pairs = list(zip(knots, values, strict=True))
    _check_values(path, columns, [row for row, _ in data], pairs)
    return pairs


def _at(cells: Sequence[str], at: int) -> str:
    return cells[at] if at < len(cells) else ""


def _header(
    path: Path,
    table: Rows,
    columns: tuple[str, str],
    is_header: Callable[[Sequence[str]], list[int]],
) -> int:
    """Which row is the header: that with the name of the knots over a number."""
    cells = [row for _, row in table.rows]
    named = {number: at for number, row in enumerate(cells) if (at := is_header(row))}
    of_words = {n: at for n, at in named.items() if not any(map(numeral, cells[n]))}
    named = of_words or named  # not a line like speed;2 m/s above the table
    for number, at in named.items():
        below = [numeral(_at(row, at[0])) for row in cells[number + 1 : number + 3]]
        if any(below[:1]) or (any(below[1:]) and number + 1 not in named):
            return number
    if named:
        return max(named)
    first = next((number for number, row in enumerate(cells) if _is_data(row)), None)
    if not cells or first == 0:
        example = _SHOWN.get(table.separator, table.separator).join(columns)
        raise ValueError(f"{path} has no header; write a first row like {example}")
    if first is None:
        first = len(cells)
    return first - 2 if first > 1 and _are_units(cells[first - 1]) else first - 1


def _is_data(row: Sequence[str]) -> bool:
    """Whether a row is one of numbers: its first cell with content is one."""
    return numeral(next(filter(None, row), "")) is not None


def _are_units(row: Sequence[str]) -> bool:
    written = [unit for cell in row if (unit := _bare(cell)) not in _NO_UNIT]
    return bool(written) and all(map(is_unit, written))


def _units_row(
    path: Path, row: tuple[int, Sequence[str]], places: Sequence[Place]
) -> list[str] | None:
    """Units of both columns, if the row below the header is one of units."""
    written = [_bare(_at(row[1], place.at)) for place in places]
    if any(numeral(unit) and unit not in _NO_UNIT for unit in written):
        return None
    if not any(unit not in _NO_UNIT for unit in written) and "1" in written:
        return None
    for unit, place in zip(written, places, strict=True):
        if unit not in _NO_UNIT and not is_unit(unit):
            raise ValueError(
                f"{path}, row {row[0]}: {unit!r} is no number, nor a unit that is known; write a "
                f"number there, or a unit of {place.name}, or take the row out if the column is "
                f"in {_unit_in_words(place)}"
            )
    return [unit if unit not in _NO_UNIT else "" for unit in written]


def _unit_in_words(place: Place) -> str:
    unit = place.unit or plain_unit(UNITS[place.name])
    return unit or "plain numbers"


def _bare(cell: str) -> str:
    return cell.strip("[]() ")


def _split(name: str, units: str) -> tuple[str, str]:
    """Name and unit of a header like ``speed (km/h)``, ``v / (m/s)``, ``v in m/s``, ``v_kmh``.

    Args:
        units: CF unit of the column: one that fits may be set apart by a blank alone.
    """
    if match := _BRACKETS.fullmatch(name):
        unit = match[2].removeprefix("in ").strip("[]() ")
        return match[1] or match[3], _known(unit, units)
    for form in _LAST_WORDS:
        if (match := form.fullmatch(name)) and match[2] not in _NAMES:
            unit = _known(match[2].replace("_", "/"), units)
            if _fits(unit, units):
                return match[1].removesuffix(" in").rstrip(" /"), unit
    if match := _BEHIND.fullmatch(name):
        unit = _bare(match[3])
        if is_unit(unit) or "in" in match[2] or unit in _NO_UNIT:
            return match[1], unit
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


def _named(header: Sequence[str], name: str, units: str) -> list[int]:
    """Where a name stands in a header, with or without its unit."""
    wanted = name.casefold().strip()
    return [
        at
        for at, cell in enumerate(header)
        if wanted in {cell.casefold(), _split(cell, units)[0].casefold()}
    ]


def _places(
    path: Path,
    header: Sequence[str],
    columns: tuple[str, str],
    chosen: tuple[str | None, str | None],
) -> list[Place]:
    """Where the columns of knots and values are."""
    filled = [at for at, name in enumerate(header) if name]
    options = (f"{columns[0]}_column", "value_column")
    where = [
        _named(header, name or column, UNITS[column])
        for name, column in zip(chosen, columns, strict=True)
    ]
    if len(where[0]) == 1 and not where[1] and chosen[1] is None and len(filled) == 2:
        where[1] = [at for at in filled if at != where[0][0]]
    for at, name, column, option in zip(where, chosen, columns, options, strict=True):
        if len(at) > 1:
            raise ValueError(
                f"{path} has {len(at)} columns {name or column!r}; rename all but one"
            )
        if not at:
            names = ", ".join(header[number] for number in filled)
            raise ValueError(
                f"{path} has no column {name or column!r}; its columns: {names}; name "
                f"one of them {column!r}, or write {option}: with its name"
                f"{_unit_too(column)}"
            )
    if where[0] == where[1]:
        raise ValueError(f"{path}: knots and values are to be two columns, not one")
    return [
        Place(column, at[0], header[at[0]], _split(header[at[0]], UNITS[column])[1])
        for column, at in zip(columns, where, strict=True)
    ]


def _unit_too(column: str) -> str:
    """What a column needs that is renamed and is not in SI."""
    unit = plain_unit(UNITS[column])
    return f" (what is not in {unit} needs its unit behind the name)" if unit else ""


def _check_rows(path: Path, width: int, data: Iterable[tuple[int, list[str]]]) -> None:
    """Refuse rows with more cells than the header has names."""
    for line, row in data:
        if any(row[width:]):
            raise ValueError(
                f"{path}, row {line} has {len(row)} cells under {width} names: {', '.join(row)}; "
                "with decimal commas separate the columns with ; or write decimal points; "
                "else give every column a name"
            )


def _in_si(
    path: Path,
    separator: str,
    places: Sequence[Place],
    columns: Sequence[Sequence[Cell]],
) -> list[list[float]]:
    """Both columns in SI; all their cells together tell the decimal sign."""
    numerals = [[_numeral(path, cell) for cell in column] for column in columns]
    rows = zip(
        *(zip(*both, strict=True) for both in zip(columns, numerals, strict=True)),
        strict=True,
    )
    try:
        sign = decimal_sign(
            ((f"row {cell.row}", number.text) for row in rows for cell, number in row),
            separator,
        )
    except ValueError as error:
        raise ValueError(f"{path}, {error}") from None
    return [
        [
            _value(path, place, cell, number, sign)
            for cell, number in zip(column, numbers, strict=True)
        ]
        for place, column, numbers in zip(places, columns, numerals, strict=True)
    ]


def _numeral(path: Path, cell: Cell) -> Numeral:
    number = numeral(cell.text)
    if number is None or (number.unit and not is_unit(number.unit)):
        what = f"{cell.text!r} is no number" if cell.text else "an empty cell"
        raise ValueError(
            f"{path}, row {cell.row}: {what}; write a number there, or take the row out"
        )
    return number


def _value(path: Path, place: Place, cell: Cell, number: Numeral, sign: str) -> float:
    text = plain(number.text, sign)
    unit = number.unit or place.unit
    if unit in _NO_UNIT:
        return float(text)
    try:
        return in_si(f"{text} {unit}", UNITS[place.name])
    except UnitError as error:
        column = f"column {place.head!r} in {unit!r}"
        hint = (
            "" if is_unit(unit) else "; or take the brackets out, if they hold no unit"
        )
        raise ValueError(f"{path}, row {cell.row}, {column}: {error}{hint}") from None


def _check_values(
    path: Path,
    columns: tuple[str, str],
    lines: Sequence[int],
    pairs: Sequence[tuple[float, float]],
) -> None:
    """Refuse knots that do not ascend, negative values, and what is likely another quantity."""
    for line, pair in zip(lines, pairs, strict=True):
        for name, value in zip(columns, pair, strict=True):
            if not 0 <= value < float("inf"):
                raise ValueError(
                    f"{path}, row {line}: {name} = {value!r}; finite numbers from 0 on are "
                    "needed; take the row out, or write it without its sign"
                )
        if columns[1] == "coefficient" and pair[1] > LARGEST_COEFFICIENT:
            raise ValueError(
                f"{path}, row {line}: a coefficient of {pair[1]!r} is above "
                f"{LARGEST_COEFFICIENT:g}; if it is in per cent, write [%] behind the column's "
                "name; if it is meant, write the table into the configuration, like "
                f"'linear 0:{pair[1]:g} 1:0.3'"
            )
    for (before, after), line in zip(pairwise(pairs), lines[1:], strict=True):
        if not before[0] < after[0]:
            raise ValueError(
                f"{path}, row {line}: {columns[0]} {after[0]!r} after {before[0]!r}; sort the rows "
                "so that it ascends, with one row for each value"
            )
    if pairs[0][0] > 0:
        raise ValueError(
            f"{path}, row {lines[0]}: the first {columns[0]} is {pairs[0][0]!r}; add a row at "
            f"{columns[0]} 0"
            + (", whose value limits stick" if columns[0] == "speed" else "")
        )
