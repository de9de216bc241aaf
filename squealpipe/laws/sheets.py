"""Rows of cells of Excel sheets, as people see them there."""

import datetime
import re
from collections.abc import Callable, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

from squealpipe.laws.numerals import MAY_BE_THOUSANDS
from squealpipe.laws.rows import FileRow, FileRows, clean, is_comment

IS_TIME = (
    " (a date or time to Excel; format the column as text, then write the cell again)"
)
"""Words appended to cells like 2:1 or 1.2 that Excel took for a time or a date."""


def sheet(path: Path, is_header: Callable[[Sequence[str]], object]) -> FileRows:
    """Rows of an Excel file: of its only sheet, or of the only one with a header.

    Args:
        is_header: whether a row names the columns.
    """
    # loaded where an Excel file is met: that takes half a second
    from openpyxl import load_workbook  # type: ignore[import-untyped]

    try:
        book, written = (load_workbook(path, data_only=only) for only in (True, False))
    except OSError:
        raise
    except Exception as error:  # a damaged file fails anywhere below openpyxl
        raise ValueError(
            f"{path} is no Excel file (.xlsx): {error}; save it so in Excel, or as CSV"
        ) from error
    pages = {
        page.title: _page_rows(page)
        for page in book.worksheets
        if page.sheet_state == "visible"
    }
    filled = [title for title, rows in pages.items() if rows]
    headed = [
        title for title in filled if any(is_header(row.cells) for row in pages[title])
    ]
    title = headed[0] if len(headed) == 1 else filled[0] if len(filled) == 1 else None
    if title is None:
        raise ValueError(
            f"{path} has sheets with content: {', '.join(filled) or 'none'}; save the one of the "
            "table as a file of its own"
        )
    heights = book[title].row_dimensions
    for number, _ in pages[title]:
        if number in heights and heights[number].hidden:
            raise ValueError(
                f"{path}, row {number} is hidden, by a filter maybe; show it, or delete it"
            )
    for row in written[title].iter_rows():
        for cell in row:
            if cell.data_type == "f" and book[title][cell.coordinate].value is None:
                raise ValueError(
                    f"{path}, row {cell.row}: the formula in {cell.coordinate} has no stored "
                    "value; write its value there, or open the file in Excel and save it"
                )
    doubtful = frozenset(
        (cell.row, _cell_text(cell))
        for row in book[title].iter_rows()
        for cell in row
        if isinstance(cell.value, str)
        and MAY_BE_THOUSANDS.fullmatch(cell.value.strip())
    )
    # numbers of cells have a decimal point
    return FileRows(pages[title], ",", doubtful=doubtful)


def _page_rows(page: Any) -> list[FileRow]:
    """Rows of a sheet, without comments and empty ones."""
    rows = [
        FileRow(number, [_cell_text(cell) for cell in row])
        for number, row in enumerate(page.iter_rows(), 1)
    ]
    return [
        row
        for row in rows
        if any(row.cells) and not is_comment(next(filter(None, row.cells)))
    ]


def _cell_text(cell: Any) -> str:
    """A cell as people see it, with all digits."""
    value = cell.value
    if value is None:
        return ""
    if isinstance(value, (datetime.date, datetime.time, datetime.timedelta)):
        return f"{value}{IS_TIME}"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return clean(str(value)).strip()
    factor, unit = shown_as(cell.number_format)
    if not factor and not unit:
        return repr(value)
    return f"{Decimal(repr(value)).scaleb(factor):f} {unit}".rstrip()


def shown_as(number_format: str) -> tuple[int, str]:
    """Power of ten by which a format shows a number, and the words behind it.

    ``0.0 %`` shows it times a hundred, ``0.0,`` in thousands, ``0.0" km/h"`` with a unit.
    """
    # a number format has parts for positive, negative, zero; the first is for positive numbers
    form = re.match(r'(?:"[^"]*"|\\.|[^;"\\])*', number_format)[0]  # type: ignore[index]  # it may be empty
    # what a format writes beside the number; colours and gaps, too, which are no words
    words_of_format = re.compile(
        r'"([^"]*)"|\\(.)|\[\$([^\]-]*)[^\]]*\]|\[[^\]]*\]|[_*].'
    )
    words = "".join(map("".join, words_of_format.findall(form))).strip()
    signs = words_of_format.sub("", form)
    thousands = max(map(len, re.findall(r"(?<=[0#?]),+(?![0#?,])", signs)), default=0)
    if "%" in signs:
        return 2 - 3 * thousands, f"% {words}".rstrip()
    return -3 * thousands, words
