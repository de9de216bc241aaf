"""Rows of cells of text files in any encoding and separation, and of Excel sheets."""

import csv
import io
import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

from squealpipe.laws.numerals import are_numbers

COMMENTS = ("#", "%", "//", "!")
EXCEL_ERRORS = (
    *("#N/A", "#VALUE!", "#REF!", "#DIV/0!", "#NAME?", "#NUM!", "#NULL!"),
    *("#NV", "#WERT!", "#BEZUG!", "#ZAHL!"),  # of Excel in German
)
"""Cells that begin like a comment and are none."""
_RULER = re.compile(r"[\s|+:=_-]{3,}|\s*\\[a-z]+\b.*")  # of Markdown, of LaTeX
_QUOTED = re.compile(r'^="(.*)"$')  # a number that Excel is to leave alone
_TRAILING = re.compile(r"\s(#|//|;|!).*|\s*\\\\.*")
_NUMERIC = re.compile(r"[\s|]*[\"']?[-+.,−]?\d")


class Rows(NamedTuple):
    """Rows of a file by their number, and what separates their cells."""

    rows: list[tuple[int, list[str]]]
    separator: str


def text_rows(path: Path) -> Rows:
    """Rows of a text file, without comments, rulers and empty ones."""
    lines = _whole_lines(_decoded(path).splitlines())
    separator = None
    kept: list[tuple[int, str]] = []
    for number, line in lines:
        if match := re.fullmatch(r"\s*sep=(.)\s*", line):  # Excel's
            separator = match[1]
        elif (
            line.strip(" ;,\t") and not _is_comment(line) and not _RULER.fullmatch(line)
        ):
            kept.append((number, line))
    separator = separator or _separator([line for _, line in kept])
    kept = [(number, _without_remark(line, separator)) for number, line in kept]
    if separator == " ":
        return Rows(_by_blanks(kept), " ")
    quote = "'" if kept and kept[0][1].lstrip().startswith("'") else '"'
    rows = []
    for number, line in kept:
        text = io.StringIO(line.strip(" |") if separator == "|" else line)
        cells = next(
            csv.reader(
                text, delimiter=separator, quotechar=quote, skipinitialspace=True
            ),
            [],
        )
        rows.append((number, [_QUOTED.sub(r"\1", cell.strip()) for cell in cells]))
    return Rows(rows, separator)


def _whole_lines(lines: Iterable[str]) -> list[tuple[int, str]]:
    """Lines with the number of each; a quoted cell with a line break is one line."""
    whole: list[tuple[int, str]] = []
    for number, line in enumerate(lines, 1):
        if whole and _is_open(whole[-1][1]):
            start, text = whole[-1]
            whole[-1] = (start, f"{text} {line}")
        else:
            whole.append((number, line))
    return whole


def _is_open(line: str) -> bool:
    """Whether a cell begins with a quotation mark that its line does not close."""
    return (
        not _is_comment(line)
        and line.count('"') % 2 == 1
        and re.search(r'(^|[;,\t])\s*"[^"]*$', line) is not None
    )


def _is_comment(text: str) -> bool:
    text = text.lstrip()
    return text.startswith(COMMENTS) and not text.startswith(EXCEL_ERRORS)


def _without_remark(line: str, separator: str) -> str:
    """A line of numbers without a remark at its end, or the end of a row of LaTeX."""
    if not _NUMERIC.match(line) and separator != "&":
        return line
    match = _TRAILING.search(line)
    if match is None or match[0].lstrip().startswith(EXCEL_ERRORS):
        return line
    return line if match[1] == separator else line[: match.start()]


def _decoded(path: Path) -> str:
    """Text in UTF-8, UTF-16 or, where it is neither, as Windows writes it."""
    raw = path.read_bytes()
    try:
        if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
            return raw.decode("utf-16")
        if b"\x00" in raw:
            return raw.decode("utf-16-le" if raw[1:2] == b"\x00" else "utf-16-be")
    except UnicodeDecodeError:
        raise ValueError(
            f"{path} is no text file; save the table as CSV in UTF-8, or as .xlsx"
        ) from None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def _separator(lines: Sequence[str]) -> str:
    """What separates the cells of most lines."""
    numeric = [line for line in lines if _NUMERIC.match(line)] or lines
    for separator in ("\t", ";", "|", "&"):
        if sum(separator in line for line in numeric) > len(numeric) / 2:
            return separator
    by_blanks = [_TRAILING.sub("", line).split() for line in numeric]
    if all(
        len(row) > 1 and ("," not in "".join(row) or are_numbers(row))
        for row in by_blanks
    ):
        return " "
    return ","


def _by_blanks(lines: Sequence[tuple[int, str]]) -> list[tuple[int, list[str]]]:
    """Cells between blanks; names of columns may hold single ones, like ``speed (m/s)``."""
    widths = Counter(
        len(line.split()) for _, line in lines if _NUMERIC.match(line)
    ) or Counter([2])
    width = widths.most_common(1)[0][0]
    return [(number, _cells_between_blanks(line, width)) for number, line in lines]


def _cells_between_blanks(line: str, width: int) -> list[str]:
    ways = (
        line.split(),
        re.split(r"\s{2,}|\t", line.strip()),
        re.findall(r"[^\s\[(]+(?:\s*/)?(?:\s*[\[(][^\])]*[\])])?", line),
    )
    return next((cells for cells in ways if len(cells) == width), ways[0])


def sheet(path: Path, is_header: Callable[[Sequence[str]], object]) -> Rows:
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
        raise ValueError(f"{path} is no Excel file (.xlsx): {error}") from error
    pages = {page.title: _page_rows(page) for page in book.worksheets}
    filled = [title for title, rows in pages.items() if rows]
    headed = [
        title for title in filled if any(is_header(row) for _, row in pages[title])
    ]
    title = headed[0] if len(headed) == 1 else filled[0] if len(filled) == 1 else None
    if title is None:
        raise ValueError(
            f"{path} has sheets with content: {', '.join(filled) or 'none'}; save the one of the "
            "table as a file of its own"
        )
    for row in written[title].iter_rows():
        for cell in row:
            if cell.data_type == "f" and book[title][cell.coordinate].value is None:
                raise ValueError(
                    f"{path}, row {cell.row}: the formula in {cell.coordinate} has no stored "
                    "value; write its value there, or open the file in Excel and save it"
                )
    return Rows(pages[title], ",")  # numbers of cells have a decimal point


def _page_rows(page: Any) -> list[tuple[int, list[str]]]:
    """Rows of a sheet, without comments and empty ones."""
    rows = [
        (number, [_cell_text(cell) for cell in row])
        for number, row in enumerate(page.iter_rows(), 1)
    ]
    return [
        (number, row)
        for number, row in rows
        if any(row) and not _is_comment(next(filter(None, row)))
    ]


def _cell_text(cell: Any) -> str:
    """A cell as people see it, with all digits."""
    value = cell.value
    if value is None:
        return ""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value).strip()
    if "%" in cell.number_format:
        return f"{Decimal(repr(value)) * 100:f} %"
    return repr(value)
