"""Files of tables as instruments, Excel and papers write them, read as two columns in SI.

What cannot be known is refused by file, row and reason, never guessed: a comma that may separate
thousands, a row with more cells than names, a column without a known name.
"""

import re
from collections.abc import Iterable, Sequence
from itertools import pairwise
from os import PathLike
from pathlib import Path
from typing import Any

from squealpipe.laws.rows import NUMBER, sheet, text_rows
from squealpipe.units import UnitError, in_si, is_unit

ENDINGS = (".csv", ".txt", ".tsv", ".dat", ".xlsx")
"""Of files that are read as tables without being called so."""
UNITS = {"speed": "m s-1", "coefficient": "1", "compression": "m", "force": "N"}
"""Column → CF unit in which its values are stored, and meant where none is written."""
OF_KNOTS = ("m s-1", "m")
LARGEST_COEFFICIENT = 2.0
"""A larger coefficient of friction is rather one in per cent, or another column."""

_GROUPED = re.compile(
    r"[+-]?\d{1,3}([ '’\u00a0\u202f]\d{3})+([.,]\d+)?|[+-]?\d+[.,]\d+[.,].*", re.ASCII
)
_MAYBE_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
_WITH_UNIT = (
    re.compile(r"(.*?)\s*[\[(]\s*(.*?)\s*[\])]"),
    re.compile(r"(.+?)\s+(?:in|/)\s+(.+)"),
)
_NO_UNIT = {"", "-", "–", "1", "/"}


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
    rows = sheet(path) if path.suffix.lower() == ".xlsx" else text_rows(path)
    start = next((at for at, (_, row) in enumerate(rows) if _is_data(row)), len(rows))
    heads, data = [row for _, row in rows[:start]], rows[start:]
    if not heads or not any(any(row) for row in heads):
        raise ValueError(
            f"{path} has no header; write a first row like {columns[0]};{columns[1]}"
        )
    units_row = heads.pop() if len(heads) > 1 and _are_units(heads[-1]) else []
    header = heads[-1]
    if not data:
        raise ValueError(f"{path} has no rows below its header")
    places = _places(path, header, columns, chosen)
    units = [
        (units_row[place].strip("[]() ") if place < len(units_row) else "")
        or _split(header[place])[1]
        for place in places
    ]
    _check_rows(path, len(header), data)
    cells = [
        (line, [row[p] if p < len(row) else "" for p in places]) for line, row in data
    ]
    _check_numbers(path, cells)
    pairs = [
        tuple(
            _in_si(
                f"{path}, row {line}, column {header[place]!r}", cell, unit, UNITS[name]
            )
            for cell, unit, place, name in zip(row, units, places, columns, strict=True)
        )
        for line, row in cells
    ]
    _check_values(path, columns, [line for line, _ in cells], pairs)
    return pairs  # type: ignore[return-value]


def _is_data(row: Sequence[str]) -> bool:
    """Whether a row is one of numbers: its first cell with content looks like one."""
    first = _plain(next(filter(None, row), ""))
    return bool(NUMBER.fullmatch(first) or _GROUPED.fullmatch(first))


def _are_units(row: Sequence[str]) -> bool:
    """Whether a row of the head holds units, one of them of knots."""
    texts = [cell.strip("[]() ") for cell in row]
    written = [text for text in texts if text not in _NO_UNIT]

    def fits(text: str, units: str) -> bool:
        try:
            in_si(f"1 {text}", units)
        except UnitError:
            return False
        return True

    return all(map(is_unit, written)) and any(
        fits(text, units) for text in written for units in OF_KNOTS
    )


def _split(name: str) -> tuple[str, str]:
    """Name and unit of a header like ``speed (km/h)``, ``v / (m/s)`` or ``v in m/s``."""
    for form in _WITH_UNIT[::-1]:
        if match := form.fullmatch(name):
            return match[1].strip(" /"), match[2].strip("[]() ")
    return name, ""


def _places(
    path: Path,
    header: Sequence[str],
    columns: tuple[str, str],
    chosen: tuple[str | None, str | None],
) -> tuple[int, int]:
    """Where the columns of knots and values are."""
    names = [name for name in header if name]
    options = (f"{columns[0]}_column", "value_column")

    def place(name: str) -> int | None:
        wanted = name.casefold().strip()
        at = [
            number
            for number, cell in enumerate(header)
            if wanted in {cell.casefold(), _split(cell)[0].casefold()}
        ]
        if len(at) > 1:
            raise ValueError(
                f"{path} has {len(at)} columns {name!r}; rename all but one"
            )
        return at[0] if at else None

    found = [
        place(name or column) for name, column in zip(chosen, columns, strict=True)
    ]
    if (
        found[0] is not None
        and found[1] is None
        and chosen[1] is None
        and len(names) == 2
    ):
        filled = [number for number, cell in enumerate(header) if cell]
        found[1] = next(number for number in filled if number != found[0])
    for at, name, column, option in zip(found, chosen, columns, options, strict=True):
        if at is None:
            raise ValueError(
                f"{path} has no column {name or column!r}; its columns: {', '.join(names)}; name "
                f"one of them {column!r}, or write {option}: with its name"
            )
    if found[0] == found[1]:
        raise ValueError(f"{path}: knots and values are to be two columns, not one")
    return found[0], found[1]  # type: ignore[return-value]


def _check_rows(path: Path, width: int, data: Iterable[tuple[int, list[str]]]) -> None:
    """Refuse rows with more cells than the header has names."""
    for line, row in data:
        if any(row[width:]):
            raise ValueError(
                f"{path}, row {line} has {len(row)} cells under {width} names: {', '.join(row)}; "
                "with decimal commas separate the columns with ; or write decimal points"
            )


def _check_numbers(path: Path, cells: Sequence[tuple[int, list[str]]]) -> None:
    """Refuse what is no number, and commas that may separate thousands."""
    commas = points = None
    proven = False
    for line, row in cells:
        for cell in map(_plain, row):
            if _GROUPED.fullmatch(cell):
                raise ValueError(
                    f"{path}, row {line}: {cell!r} has separators of thousands; write "
                    "it without them"
                )
            if not NUMBER.fullmatch(cell):
                what = f"{cell!r} is no number" if cell else "an empty cell"
                raise ValueError(
                    f"{path}, row {line}: {what}; write a number there, or take the row out"
                )
            if "," in cell:
                commas = commas or (line, cell)
                proven |= not _MAYBE_THOUSANDS.fullmatch(cell)
            elif "." in cell:
                points = points or (line, cell)
    if commas and points:
        raise ValueError(
            f"{path}: {commas[1]!r} in row {commas[0]} has a comma and {points[1]!r} in row "
            f"{points[0]} a point; write one decimal sign throughout, and no thousands"
        )
    if commas and not proven:
        line, cell = commas
        raise ValueError(
            f"{path}, row {line}: the comma of {cell!r} may separate thousands; write "
            f"{cell.replace(',', '.')} or {cell.replace(',', '')}"
        )


def _plain(cell: str) -> str:
    return cell.strip().replace("−", "-")


def _in_si(where: str, cell: str, unit: str, units: str) -> float:
    number = _plain(cell).replace(",", ".")
    if unit in _NO_UNIT:
        return float(number)
    try:
        return in_si(f"{number} {unit}", units)
    except UnitError as error:
        raise ValueError(f"{where} in {unit!r}: {error}") from None


def _check_values(
    path: Path, columns: tuple[str, str], lines: Sequence[int], pairs: Sequence[Any]
) -> None:
    """Refuse knots that do not ascend, negative values, and what is likely another quantity."""
    for line, pair in zip(lines, pairs, strict=True):
        for name, value in zip(columns, pair, strict=True):
            if not 0 <= value < float("inf"):
                raise ValueError(
                    f"{path}, row {line}: {name} = {value!r}; finite numbers from 0 on are needed"
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
