"""Files of tables as instruments, Excel and papers write them, read as two columns in SI.

What cannot be known is refused by file, row and reason, never guessed: a comma that may separate
thousands, a row with more cells than names, a column without a known name.
"""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from squealpipe.laws.headers import (
    COLUMN_UNITS,
    NO_UNIT,
    Place,
    cell_at,
    header_row,
    named,
    places,
    refuse_units_elsewhere,
    units_row,
)
from squealpipe.laws.numerals import Numeral, decimal_sign, numeral, plain
from squealpipe.laws.rows import FileLine, FileRow, text_rows
from squealpipe.laws.sheets import sheet
from squealpipe.systems.inputs.units import UnitError, in_si, is_unit

ENDINGS = (".csv", ".txt", ".tsv", ".dat", ".xlsx")
"""Endings of files that are read as tables without being called so."""


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
        return named(row, chosen[0] or columns[0], COLUMN_UNITS[columns[0]])

    excel = path.suffix.lower() == ".xlsx"
    table = (sheet if excel else text_rows)(path, is_header)
    start = header_row(path, table, columns, is_header)
    header = table.rows[start].cells
    wanted = places(path, header, columns, chosen)
    data = [row for row in table.rows[start + 1 :] if row.cells != header]
    if data and (units := units_row(path, data[0], wanted)) is not None:
        wanted = [
            place._replace(unit=unit or place.unit)
            for place, unit in zip(wanted, units, strict=True)
        ]
        first = data[0].cells
        data = [row for row in data if row.cells != first]
    above = [FileLine(row, "\t".join(cells)) for row, cells in table.rows[:start]]
    for place in wanted:
        refuse_units_elsewhere(path, place, [*table.comments, *above])
    if not data:
        raise ValueError(f"{path} has no rows below its header")
    for row, cells in data:
        if wanted[0].at in is_header(cells):
            raise ValueError(
                f"{path}, row {row} is the header of a second table; save each as a file of its own"
            )
    _check_rows(path, len(header), data)
    columns_of_cells = [
        [Cell(row, cell_at(cells, place.at)) for row, cells in data] for place in wanted
    ]
    for cell in (cell for column in columns_of_cells for cell in column):
        table.refuse_doubtful(path, cell.row, cell.text)
    knots, values = _in_si(path, table.separator, wanted, columns_of_cells)
    pairs = list(zip(knots, values, strict=True))
    _check_values(path, columns, [row.number for row in data], pairs)
    return pairs


def _check_rows(path: Path, width: int, data: Iterable[FileRow]) -> None:
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
    wanted: Sequence[Place],
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
        for place, column, numbers in zip(wanted, columns, numerals, strict=True)
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
    if unit in NO_UNIT:
        return float(text)
    try:
        return in_si(f"{text} {unit}", COLUMN_UNITS[place.name])
    except UnitError as error:
        column = f"column {place.head!r} in {unit!r}"
        hint = "" if is_unit(unit) else "; or take it out of the name, if it is no unit"
        raise ValueError(f"{path}, row {cell.row}, {column}: {error}{hint}") from None


def _check_values(
    path: Path,
    columns: tuple[str, str],
    lines: Sequence[int],
    pairs: Sequence[tuple[float, float]],
) -> None:
    """Refuse knots that do not ascend, negative values, and what is likely another quantity."""
    # a coefficient of friction above 2 is rather one in per cent, or another column
    largest = 2.0
    for line, pair in zip(lines, pairs, strict=True):
        for name, value in zip(columns, pair, strict=True):
            if not 0 <= value < float("inf"):
                raise ValueError(
                    f"{path}, row {line}: {name} = {value!r}; finite numbers from 0 on are "
                    "needed; take the row out, or write it without its sign"
                )
        if columns[1] == "coefficient" and pair[1] > largest:
            raise ValueError(
                f"{path}, row {line}: a coefficient of {pair[1]!r} is above "
                f"{largest:g}; if it is in per cent, write [%] behind the column's "
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
            + (
                ", whose value is the static coefficient"
                if columns[0] == "speed"
                else ""
            )
        )
