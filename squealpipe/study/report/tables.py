"""The tables of the report, and the spectra, as one Excel file."""

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from openpyxl import Workbook
from openpyxl.styles import Font
from openpyxl.utils import get_column_letter

from squealpipe.parameters import TABLE, Parameters, law_in_words
from squealpipe.schema import meanings
from squealpipe.store.whole_files import whole_file
from squealpipe.study.report import answer
from squealpipe.systems.inputs.units import plain_unit

CURE_COLUMNS = {
    "now": "value",
    "quiet from": "quiet_from",
    "change (% or deg)": "change",
    "quiet from, any start": "quiet_from_any_start",
    "lowest tried": "lowest_tried",
    "highest tried": "highest_tried",
}
"""Columns of numbers on the sheet that says what stops the squeal → variables of the answer."""


def write_tables(
    answers: Mapping[str, xr.Dataset], parameters: Parameters, path: Path
) -> None:
    """Write one file with the sheets Answer, What stops it, Parameters, and a spectrum a scene."""
    book = Workbook()
    first = book.active
    first.title = "Answer"
    _fill(first, ["quantity", "unit", *answers], _scalars(answers))
    head = ["scene", "changed alone", "unit", *CURE_COLUMNS]
    _fill(book.create_sheet("What stops it"), head, _cures(answers))
    _fill(
        book.create_sheet("Parameters"),
        ["parameter", "meaning", "value", "unit"],
        (
            [name, TABLE[name].meaning, *_plain(name, value)]
            for name, value in parameters.as_dict().items()
            if TABLE[name].enters_a1 and name not in parameters.in_laws
        ),
    )
    for name, told in answers.items():
        # Excel allows 31 characters in the name of a sheet
        sheet = book.create_sheet(f"Spectrum {name}"[:31])
        columns = {
            "frequency (Hz)": told.line_frequency,
            "velocity along (m/s)": told.velocity_spectrum_along,
            "velocity across (m/s)": told.velocity_spectrum_across,
            "contact force over preload": told.force_spectrum,
        }
        rows = np.stack([column.values for column in columns.values()], axis=1)
        _fill(sheet, list(columns), rows[np.isfinite(rows).all(axis=1)].tolist())
    with whole_file(path) as temporary:
        book.save(temporary)


def _fill(sheet: Any, head: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    sheet.append(list(head))
    for cell in sheet[1]:
        cell.font = Font(bold=True)
    for row in rows:
        sheet.append([_cell(value) for value in row])
    sheet.freeze_panes = "A2"
    for index in range(1, len(head) + 1):
        sheet.column_dimensions[get_column_letter(index)].width = 24


def _cell(value: Any) -> Any:
    """A value as Excel takes it; nothing for NaN."""
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def _scalars(answers: Mapping[str, xr.Dataset]) -> Iterable[list[Any]]:
    told = next(iter(answers.values()))
    yield ["in words", "", *(answer.headline(each) for each in answers.values())]
    yield ["cause", "", *(answer.cause(each) for each in answers.values())]
    for name, variable in told.data_vars.items():
        if variable.ndim:
            continue
        factor, unit = _turned(str(variable.attrs.get("units", "")))
        row = [str(variable.attrs.get("long_name", name)), unit]
        for each in answers.values():
            flags = meanings(each[name])
            value = each[name].item()
            if flags:
                value = flags[int(value)].replace("_", " ")
            row.append(factor * value if factor != 1.0 else value)
        yield row


def _cures(answers: Mapping[str, xr.Dataset]) -> Iterable[list[Any]]:
    for scene, told in answers.items():
        for name in told.cure.values:
            row = told.sel(cure=name)
            factor, unit = _turned(str(row.unit.item()))
            values = [
                float(row[key]) * (1.0 if key == "change" else factor)
                for key in CURE_COLUMNS.values()
            ]
            yield [scene, answer.NAMES.get(str(name), str(name)), unit, *values]


def _turned(units: str) -> tuple[float, str]:
    """Factor and unit of a column: SI, but angles in degrees."""
    if units == "rad":
        return math.degrees(1.0), "deg"
    return 1.0, plain_unit(units or "1")


def _plain(name: str, value: Any) -> list[Any]:
    laws, units = TABLE[name].laws, TABLE[name].units
    if laws:
        return [law_in_words(value, laws.own_law_rules.units), ""]
    return [value, plain_unit(units)]
