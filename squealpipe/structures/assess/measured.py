"""Lists of measured noises, and how they agree with a map of operating points."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.laws.numerals import decimal_sign, numeral, plain
from squealpipe.laws.rows import FileRows, text_rows
from squealpipe.laws.sheets import sheet
from squealpipe.structures.schema.operating_map import POINT, Match
from squealpipe.systems.inputs.values import brief
from squealpipe.text import suggestion
from squealpipe.units import in_si

COLUMNS = {
    "pressure": "1",
    "speed": "m s-1",
    "mu": "1",
    "frequency": "Hz",
    "level": "dB",
}
"""Column → the unit that it is turned into; a level is not, since decibels have references."""


class Noise(NamedTuple):
    """One line of a list: an operating point, and the noise that was heard there.

    Attributes:
        point: values by name of those of pressure, speed and mu that the list has.
        frequency: Hz; NaN where it was quiet.
        level: dB; NaN where none is given.
    """

    point: dict[str, float]
    frequency: float
    level: float


def read_noises(path: str | PathLike[str], speed_unit: str = "m s-1") -> list[Noise]:
    """Return the noises of a list, a text file or an Excel sheet.

    Columns are ``pressure`` (factor of the preloads), ``speed [km/h]``, ``mu``, ``frequency [Hz]``
    and ``level [dB]`` by name, with their unit in brackets; an empty frequency is a quiet point.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the file, the line and what is wrong there.
    """
    if not isinstance(path, str | PathLike):
        raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
            f"measured = {brief(path)}: the name of a file is needed"
        )
    source = Path(path).expanduser()
    if not source.is_file():
        raise FileNotFoundError(f"measured: no file {source}")
    read = sheet if source.suffix.lower() == ".xlsx" else text_rows
    table = read(source, lambda row: any("frequency" in cell for cell in row))
    if not table.rows:
        raise ValueError(f"{source} is empty; its first row must name the columns")
    units = COLUMNS | {"speed": speed_unit}
    columns = [_column(source, cell, units) for cell in table.rows[0].cells]
    names = [name for name, _ in columns]
    if "frequency" not in names or not set(names) & set(POINT):
        raise ValueError(
            f"{source}: columns frequency and one of {', '.join(POINT)} are needed; it has "
            f"{', '.join(names)}"
        )
    cells = list(_cells(source, table, columns))
    sign = decimal_sign(
        ((where, text) for where, _, _, text in cells if text), table.separator
    )
    rows: dict[str, dict[str, float]] = {}
    for where, name, unit, text in cells:
        value = float(plain(text, sign)) if text else math.nan
        if text and unit and name != "level":
            value = float(in_si(f"{value!r} {unit}", units[name]))
        rows.setdefault(where, {})[name] = value
    return [_noise(where, row) for where, row in rows.items()]


def _cells(
    source: Path, table: FileRows, columns: list[tuple[str, str]]
) -> Iterator[tuple[str, str, str, str]]:
    """Yield line, column, unit and number of each cell below the header, "" where it is empty."""
    for line, row in table.rows[1:]:
        for (name, unit), cell in zip(columns, row, strict=False):
            where = f"{source}, line {line}"
            table.refuse_doubtful(source, line, cell)
            number = numeral(cell) if cell.strip() else None
            if cell.strip() and (number is None or number.unit):
                raise ValueError(
                    f"{where}: {name} = {cell!r}: a number without a unit is needed; the unit "
                    "stands in the header, like frequency [Hz]"
                )
            yield where, name, unit, number.text if number else ""


def _column(source: Path, cell: str, units: dict[str, str]) -> tuple[str, str]:
    """Return the name of a column and its unit."""
    match = re.fullmatch(r"\s*(\w+)\s*(?:[\[(]\s*([^\])]*)[\])])?\s*", cell)
    name = match[1].lower() if match else cell
    if name not in units:
        raise ValueError(f"{source}: column {cell!r}: {suggestion(name, list(units))}")
    unit = (match[2] or "") if match else ""
    if unit and units[name] == "1":
        raise ValueError(
            f"{source}: column {cell!r}: {name} is a plain number; a pressure is a factor of the "
            "structure's preloads: divide by the pressure that these stand for"
        )
    return name, unit


def _noise(where: str, row: dict[str, float]) -> Noise:
    point = {name: row[name] for name in POINT if name in row}
    for name, value in point.items():
        if math.isnan(value):
            raise ValueError(f"{where}: {name} is missing")
    return Noise(point, row["frequency"], row.get("level", math.nan))


def matched(points: xr.Dataset, noises: list[Noise], band: float) -> dict[str, Any]:
    """Return variables that compare each measured noise with the nearest operating point.

    Args:
        points: dataset ``operating_map``.
        band: largest difference of frequencies of one noise, over the measured one.
    """
    known: dict[str, list[Any]] = {"frequency": [], "predicted": [], "match": []}
    for noise in noises:
        place = {
            name: _nearest(points[name].values, at) for name, at in noise.point.items()
        }
        if None in place.values():
            predicted, match = math.nan, Match.outside
        else:
            chosen = points.isel(
                {name: int(at) for name, at in place.items() if at is not None}
            )
            predicted, match = _judged(chosen, noise.frequency, band)
        known["frequency"].append(noise.frequency)
        known["predicted"].append(predicted)
        known["match"].append(match)
    counts = {
        name: sum(each == match for each in known["match"])
        for name, match in (
            ("hits", Match.hit),
            ("misses", Match.miss),
            ("false_alarms", Match.false_alarm),
            ("quiet_agreed", Match.both_quiet),
        )
    }
    return {
        "measured_frequency": np.array(known["frequency"], float),
        "measured_level": np.array([noise.level for noise in noises], float),
        "predicted_frequency": np.array(known["predicted"], float),
        "match": np.array(known["match"], int),
        **counts,
        "frequency_band": band,
    }


def _nearest(values: np.ndarray, at: float) -> int | None:
    """Return the place of the value nearest to one; None where that lies beyond their range."""
    # a measured point may lie beyond the map by this share of its range
    outside = 0.05
    room = outside * max(np.ptp(values), abs(values).max())
    if not values.min() - room <= at <= values.max() + room:
        return None
    return int(np.abs(values - at).argmin())


def _judged(points: xr.Dataset, frequency: float, band: float) -> tuple[float, Match]:
    """Return the predicted frequency that is nearest, and how it agrees with the measured one.

    Several points belong to a noise if the list leaves a quantity out, such as friction.
    """
    verdicts = np.ravel(points.verdict.values)
    predicted = np.ravel(points.frequency.values)
    if (verdicts == Verdict.undetermined).all():
        return math.nan, Match.undetermined
    noisy = predicted[np.isfinite(predicted)]
    if math.isnan(frequency):
        if noisy.size:
            return float(noisy[0]), Match.false_alarm
        return math.nan, Match.both_quiet
    if not noisy.size:
        return math.nan, Match.miss
    nearest = float(noisy[np.abs(noisy - frequency).argmin()])
    is_hit = abs(nearest - frequency) <= band * frequency
    return nearest, Match.hit if is_hit else Match.miss
