"""Rows of cells of text files in any encoding and separation."""

import csv
import io
import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from squealpipe.laws.numerals import are_numbers

EXCEL_ERRORS = (
    *("#N/A", "#VALUE!", "#REF!", "#DIV/0!", "#NAME?", "#NUM!", "#NULL!"),
    *("#NV", "#WERT!", "#BEZUG!", "#ZAHL!"),  # of Excel in German
)
"""Cells that begin like a comment and are none."""
_TRAILING = re.compile(r"\s(#|//|;|!).*|\s*\\\\.*")
_NUMERIC = re.compile(r"[\s|]*[\"']?[-+.,−]?\d")


class FileLine(NamedTuple):
    """A line of a file by its number."""

    number: int
    text: str


class FileRow(NamedTuple):
    """Cells of a line of a file by its number."""

    number: int
    cells: list[str]


class FileRows(NamedTuple):
    """Rows of a file, what separates their cells, its comments, and cells of doubtful text.

    Excel stores numbers without separators of thousands; a text like ``1.000`` in a sheet may be
    one or a thousand.
    """

    rows: list[FileRow]
    separator: str
    comments: Sequence[FileLine] = ()
    doubtful: frozenset[tuple[int, str]] = frozenset()

    def refuse_doubtful(self, path: Path, row: int, cell: str) -> None:
        """Raise if a cell that is needed is text whose point may separate thousands."""
        if (row, cell) in self.doubtful:
            raise ValueError(
                f"{path}, row {row}: {cell!r} is text, and its point may separate thousands; turn "
                "the cell into a number in Excel"
            )


def text_rows(path: Path, is_header: Callable[[Sequence[str]], object]) -> FileRows:
    """Rows of a text file, without comments, rulers and empty ones.

    Args:
        is_header: whether a row names the columns; one in a comment, as numpy and gnuplot have it,
            becomes a row where no other does.
    """
    lines = _whole_lines(_decoded(path).splitlines())
    separator = None
    kept: list[FileLine] = []
    comments: list[FileLine] = []
    for number, line in lines:
        if match := re.fullmatch(r"\s*sep=(.)\s*", line):  # Excel's
            separator = match[1]
        elif is_comment(line):
            comments.append(FileLine(number, line.lstrip(" \t#%/!")))
        # rulers of Markdown (|---|) and of LaTeX (\hline) hold no data
        elif line.strip(" ;,\t") and not re.fullmatch(
            r"[\s|+:=_-]{3,}|\s*\\[a-z]+\b.*", line
        ):
            kept.append(FileLine(number, line))
    separator = separator or _separator([line for _, line in kept])
    rows = _split_rows(kept, separator)
    if rows and not any(is_header(cells) for _, cells in rows):
        in_comments = [
            row
            for line in comments
            for row in _split_rows([line], separator, len(rows[0].cells))
            if row.number < rows[0].number and len(row.cells) == len(rows[0].cells)
        ]
        headers = [at for at, row in enumerate(in_comments) if is_header(row.cells)]
        if headers:  # and the units that may stand below it
            rows = in_comments[headers[-1] :] + rows
    return FileRows(rows, separator, comments)


def _split_rows(
    lines: Sequence[FileLine], separator: str, width: int | None = None
) -> list[FileRow]:
    """Cells of lines.

    Args:
        width: how many cells a row between blanks has; by default as most of the lines.
    """
    lines = [FileLine(at, _without_remark(text, separator)) for at, text in lines]
    if separator == " ":
        return _by_blanks(lines, width)
    quote = "'" if lines and lines[0].text.lstrip().startswith("'") else '"'
    rows = []
    for number, line in lines:
        text = io.StringIO(line.strip(" |") if separator == "|" else line)
        cells = next(
            csv.reader(
                text, delimiter=separator, quotechar=quote, skipinitialspace=True
            ),
            [],
        )
        # ="1/2": a number that Excel is to leave alone
        rows.append(
            FileRow(
                number, [re.sub(r'^="(.*)"$', r"\1", cell.strip()) for cell in cells]
            )
        )
    return rows


def _whole_lines(lines: Iterable[str]) -> list[FileLine]:
    """Lines with the number of each; a quoted cell with a line break is one line."""
    whole: list[FileLine] = []
    for number, line in enumerate(lines, 1):
        if whole and _is_open(whole[-1].text):
            start, text = whole[-1]
            whole[-1] = FileLine(start, f"{text} {line}")
        else:
            whole.append(FileLine(number, line))
    return whole


def _is_open(line: str) -> bool:
    """Return whether a cell begins with a quotation mark that its line does not close."""
    return (
        not is_comment(line)
        and line.count('"') % 2 == 1
        and re.search(r'(^|[;,\t])\s*"[^"]*$', line) is not None
    )


def is_comment(text: str) -> bool:
    """Return whether a line or cell is a comment, and no error of Excel like #N/A."""
    text = text.lstrip()
    return text.startswith(("#", "%", "//", "!")) and not text.startswith(EXCEL_ERRORS)


def _without_remark(line: str, separator: str) -> str:
    """A line of numbers without a remark at its end, or the end of a row of LaTeX."""
    if not _NUMERIC.match(line) and separator != "&":
        return line
    match = _TRAILING.search(line)
    if match is None or match[0].lstrip().startswith(EXCEL_ERRORS):
        return line
    return line if match[1] == separator else line[: match.start()]


def clean(text: str) -> str:
    """A text without signs that nobody sees, and with those of a keyboard for wide ones."""
    # wide signs of East Asia become those of a keyboard; what has no width, and DOS's end,
    # vanishes
    cleaned = {code + 0xFEE0: code for code in range(0x21, 0x7F)} | dict.fromkeys(
        (0x200B, 0x200C, 0x200D, 0x2060, 0xFEFF, 0x1A)
    )
    return text.translate(cleaned)


def _decoded(path: Path) -> str:
    """Text in UTF-8, UTF-16 or, where it is neither, as Windows writes it."""
    text = _text_of(path.read_bytes())
    if text is None or "\x00" in text:
        raise ValueError(
            f"{path} is no text file; save the table as CSV in UTF-8, or as .xlsx"
        )
    return clean(text)


def _text_of(raw: bytes) -> str | None:
    try:
        if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
            return raw.decode("utf-16")
        if b"\x00" in raw:
            return raw.decode("utf-16-le" if raw[1:2] == b"\x00" else "utf-16-be")
    except UnicodeDecodeError:
        return None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def _separator(lines: Sequence[str]) -> str:
    """Return the separator of the cells in most lines."""
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


def _by_blanks(lines: Sequence[FileLine], width: int | None) -> list[FileRow]:
    """Cells between blanks; names of columns may hold single ones, like ``speed (m/s)``."""
    widths = Counter(
        len(line.split()) for _, line in lines if _NUMERIC.match(line)
    ) or Counter([2])
    width = width or widths.most_common(1)[0][0]
    return [
        FileRow(number, _cells_between_blanks(line, width)) for number, line in lines
    ]


def _cells_between_blanks(line: str, width: int) -> list[str]:
    ways = (
        line.split(),
        re.split(r"\s{2,}|\t", line.strip()),
        re.findall(r"[^\s\[(]+(?:\s*/)?(?:\s*[\[(][^\])]*[\])])?", line),
    )
    return next((cells for cells in ways if len(cells) == width), ways[0])
