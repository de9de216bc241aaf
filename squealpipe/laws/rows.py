"""Rows of cells of text files in any encoding and separation, and of Excel sheets."""

import csv
import io
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

COMMENTS = ("#", "%", "//", "!")
NUMBER = re.compile(r"[+-]?(\d+(\.\d*|,\d+)?|[.,]\d+)([eE][+-]?\d{1,3})?", re.ASCII)
"""A number with a decimal point or comma."""


def text_rows(path: Path) -> list[tuple[int, list[str]]]:
    """Rows of a text file, without comments and empty ones."""
    lines = _decoded(path.read_bytes()).splitlines()
    separator = None
    kept: list[tuple[int, str]] = []
    for number, line in enumerate(lines, 1):
        if match := re.fullmatch(r"\s*sep=(.)\s*", line):  # Excel's
            separator = match[1]
        elif line.strip(" ;,\t") and not line.lstrip().startswith(COMMENTS):
            kept.append((number, line))
    separator = separator or _separator([line for _, line in kept])
    if separator == " ":
        return [(number, line.split()) for number, line in kept]
    rows = []
    for number, line in kept:
        cells = next(
            csv.reader(io.StringIO(line), delimiter=separator, skipinitialspace=True)
        )
        rows.append((number, [cell.strip() for cell in cells]))
    return rows


def _decoded(raw: bytes) -> str:
    """Text in UTF-8, UTF-16 or, where it is neither, as Windows writes it."""
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        return raw.decode("utf-16")
    if b"\x00" in raw:
        return raw.decode("utf-16-le" if raw[1:2] == b"\x00" else "utf-16-be")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def _separator(lines: Sequence[str]) -> str:
    """What separates the cells of most lines."""
    numeric = [line for line in lines if re.match(r"\s*[\"']?[-+.,]?\d", line)] or lines
    for separator in ("\t", ";", "|"):
        if sum(separator in line for line in numeric) > len(numeric) / 2:
            return separator
    by_spaces = [line.split() for line in numeric]
    if all(len(row) > 1 and all(map(NUMBER.fullmatch, row)) for row in by_spaces):
        return " "
    return ","


def sheet(path: Path) -> list[tuple[int, list[str]]]:
    """Rows of the only sheet of an Excel file."""
    try:
        from openpyxl import load_workbook  # type: ignore[import-untyped]
    except ImportError as error:
        raise ValueError(
            f'{path}: Excel files need openpyxl (pip install "squealpipe[export]"); '
            "or save it as CSV"
        ) from error
    try:
        book = load_workbook(path, data_only=True)
    except OSError:
        raise
    except Exception as error:  # a damaged file fails anywhere below openpyxl
        raise ValueError(f"{path} is no Excel file (.xlsx): {error}") from error
    filled = [page for page in book.worksheets if page.max_row > 1 or page["A1"].value]
    if len(filled) != 1:
        names = ", ".join(page.title for page in filled) or "none"
        raise ValueError(
            f"{path} has sheets with content: {names}; save the one of the table as a file of "
            "its own"
        )
    rows = [
        (number, [_cell_text(cell) for cell in row])
        for number, row in enumerate(filled[0].iter_rows(values_only=True), 1)
    ]
    return [
        (number, row)
        for number, row in rows
        if any(row) and not next(filter(None, row)).startswith(COMMENTS)
    ]


def _cell_text(cell: Any) -> str:
    return (
        ""
        if cell is None
        else repr(cell)
        if isinstance(cell, int | float)
        else str(cell).strip()
    )
