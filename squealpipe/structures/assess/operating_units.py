"""Pressures, speeds and temperatures of operating points, as people and instruments write them.

Units stand behind a number, or in the header of a column of a file.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Self

import numpy as np

from squealpipe.laws.numerals import decimal_sign, numeral, plain
from squealpipe.laws.rows import FileRows, text_rows
from squealpipe.laws.sheets import sheet
from squealpipe.structures.definition import ContactStructure
from squealpipe.systems.inputs.units import UnitError, in_si
from squealpipe.systems.inputs.values import brief, is_finite_number
from squealpipe.systems.inputs.words import as_number, suggestion


@dataclass(frozen=True)
class OperatingUnits:
    """Units of the quantities of an operating point.

    A plain pressure is a factor of all preloads, one with a unit the mean pressure of all faces; a
    speed is in the structure's unit, a temperature in °C.

    Attributes:
        speed_unit: CF unit of the structure's speed.
        mean_pressure: of its faces at the factor 1, Pa; NaN where no contact has an area.
    """

    speed_unit: str
    mean_pressure: float

    @classmethod
    def of(cls, structure: ContactStructure) -> Self:
        """Return the units of a structure."""
        known = [
            (contact.preload, contact.origin.area)
            for contact in structure.contacts
            if contact.origin is not None and contact.origin.area > 0.0
        ]
        force, area = np.sum(known, axis=0) if known else (math.nan, math.nan)
        mean = force / area if force > 0.0 else math.nan
        return cls(structure.speed_unit, float(mean))

    def number(self, title: str, name: str, value: Any, unit: str = "") -> float:
        """Return a value of ``pressure``, ``speed``, ``temperature``, … in the unit of the map.

        Args:
            title: of the value, for messages.
            value: a number, or a text, with a unit or without.
            unit: that stands apart, as in the header of a table.

        Raises:
            ValueError: names the value and what is needed.
        """
        if isinstance(value, str):
            match = re.fullmatch(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(.*?)\s*", value)
            if match is None or not math.isfinite(as_number(match[1])):
                raise ValueError(
                    f"{title} = {value!r}: a number, with or without a unit, is needed"
                )
            value, unit = as_number(match[1]), match[2] or unit
        if not is_finite_number(value):
            raise ValueError(f"{title} = {brief(value)}: a finite number is needed")
        number = float(value)
        if not unit or unit == "-":
            return number
        try:
            return self._in_unit_of_map(name, number, unit)
        except UnitError as error:
            raise ValueError(f"{title} = {number:g} {unit}: {error}") from error

    def _in_unit_of_map(self, name: str, number: float, unit: str) -> float:
        if name == "temperature":
            # unit of a temperature → what is added to make it degrees Celsius
            zero_of = {
                "°c": 0.0,
                "degc": 0.0,
                "c": 0.0,
                "k": -273.15,
                "kelvin": -273.15,
            }
            if unit.casefold() not in zero_of:
                raise UnitError("a temperature in °C or K is needed, like 120 °C")
            return number + zero_of[unit.casefold()]
        if name != "pressure":
            units = {"speed": self.speed_unit, "frequency": "Hz"}
            return in_si(f"{number!r} {unit}", units.get(name, "1"))
        pressure = in_si(f"{number!r} {unit}", "Pa")
        if math.isnan(self.mean_pressure):
            raise UnitError(
                "no contact has an area by which a pressure would become a preload; give plain "
                "numbers, which are factors of all preloads"
            )
        return pressure / self.mean_pressure


def column_of(source: Path, cell: str, names: Sequence[str]) -> tuple[str, str]:
    """Return the name of a column and its unit, of a header like ``speed [km/h]``."""
    # a unit like dB(A) has parentheses of its own
    unit = r"(?:\[\s*(.*?)\s*\]|\(\s*(.*?)\s*\))?"
    match = re.fullmatch(rf"\s*(\w+)\s*{unit}\s*", cell)
    name = match[1].lower() if match else cell
    if name not in names:
        raise ValueError(f"{source}: column {cell!r}: {suggestion(name, list(names))}")
    return name, (match[2] or match[3] or "") if match else ""


def read_rows(
    source: Path, names: Sequence[str], key: str, units: OperatingUnits
) -> dict[str, dict[str, float]]:
    """Return the rows of a table, each under its file and line: column → number, NaN if empty.

    Args:
        source: a text file or an Excel sheet, whose first row names the columns.
        names: of the columns that there may be.
        key: one of them that a first row has.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the file, the line and what is wrong there.
    """
    if not source.is_file():
        raise FileNotFoundError(f"no file {source}")
    read = sheet if source.suffix.lower() == ".xlsx" else text_rows
    table: FileRows = read(source, lambda row: any(key in cell.lower() for cell in row))
    if not table.rows:
        raise ValueError(f"{source} is empty; its first row must name the columns")
    columns = [column_of(source, cell, names) for cell in table.rows[0].cells]
    listed = [name for name, _ in columns]
    if twice := next((name for name in listed if listed.count(name) > 1), None):
        raise ValueError(f"{source}: column {twice!r} occurs twice; rename one")
    texts = list(_cells(source, table, columns))
    sign = decimal_sign(
        ((where, text) for where, _, _, text in texts if text), table.separator
    )
    rows: dict[str, dict[str, float]] = {}
    for where, name, unit, text in texts:
        value = math.nan
        if text:
            value = float(plain(text, sign))
            if name != "level":  # decibels have references of their own
                value = units.number(f"{where}: {name}", name, value, unit)
        rows.setdefault(where, {})[name] = value
    return rows


def _cells(
    source: Path, table: FileRows, columns: list[tuple[str, str]]
) -> Iterator[tuple[str, str, str, str]]:
    """Yield line, column, unit and number of each cell below the header, "" where it is empty."""
    for line, row in table.rows[1:]:
        where = f"{source}, line {line}"
        if any(cell.strip() for cell in row[len(columns) :]):
            raise ValueError(
                f"{where} has {len(row)} cells under {len(columns)} names; with decimal commas "
                "separate the columns with ;"
            )
        cells = [*row, *[""] * (len(columns) - len(row))]
        for (name, unit), cell in zip(columns, cells, strict=False):
            table.refuse_doubtful(source, line, cell)
            number = numeral(cell) if cell.strip() else None
            if cell.strip() and (number is None or number.unit):
                raise ValueError(
                    f"{where}: {name} = {cell!r}: a number without a unit is needed; the unit "
                    "stands in the header, like frequency [Hz]"
                )
            yield where, name, unit, number.text if number else ""


@dataclass(frozen=True)
class FrictionTable:
    """Friction over one quantity of an operating point, linear between its knots.

    Attributes:
        quantity: ``temperature``, ``pressure`` or ``speed``.
        knots: ascending, in the unit of the map.
        values: coefficients of friction, or where ``mu`` is given too, factors of it.
    """

    quantity: str
    knots: tuple[float, ...]
    values: tuple[float, ...]

    @classmethod
    def read(cls, quantity: str, written: Any, units: OperatingUnits) -> Self:
        """Read a table: {knot: value}, a text like ``20:0.45 300:0.35``, or a file.

        A file has the columns ``mu`` and that of the quantity, like ``temperature [°C]``.

        Raises:
            FileNotFoundError: no such file.
            ValueError: names the table and what is wrong with it.
        """
        title = f"mu_of: {quantity}"
        pairs = sorted(_pairs(title, quantity, written, units))
        knots, values = np.transpose(pairs) if pairs else np.zeros((2, 0))
        if len(knots) < 2 or not (np.diff(knots) > 0.0).all():
            raise ValueError(
                f"{title}: two or more knots are needed, each once; it has {len(knots)}"
            )
        if not (values >= 0.0).all():
            raise ValueError(f"{title}: mu = {values.min():g}: it must not be negative")
        return cls(quantity, tuple(knots.tolist()), tuple(values.tolist()))

    def at(self, value: Any) -> Any:
        """Return friction at values of the quantity; of a speed, at its absolute value.

        Raises:
            ValueError: a value that the table does not reach.
        """
        size = np.abs(value) if self.quantity == "speed" else np.asarray(value)
        low, high = self.knots[0], self.knots[-1]
        slack = 1e-9 * max(abs(low), abs(high))  # round-off of converted units
        for each in size.ravel():
            if not low - slack <= each <= high + slack:
                raise ValueError(
                    f"{self.quantity} = {each:g}: the table of mu_of ends at {low:g} and "
                    f"{high:g}; extend it, since nothing is extrapolated"
                )
        return np.interp(size, self.knots, self.values)


def _pairs(
    title: str, quantity: str, written: Any, units: OperatingUnits
) -> list[tuple[float, float]]:
    """Return knots and values of a table as it is written."""
    if isinstance(written, str) and ":" in written and not Path(written).is_file():
        words = written.replace(",", " ").split()
        written = dict(word.partition(":")[::2] for word in words)
    if isinstance(written, Mapping):
        return [
            (
                units.number(title, quantity, knot),
                units.number(f"{title}[{knot!r}]", "mu", value),
            )
            for knot, value in written.items()
        ]
    if not isinstance(written, str | PathLike):
        raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
            f"{title} = {brief(written)}: {{knot: mu}}, a text like '20:0.45 300:0.35' or the name "
            "of a file is needed"
        )
    names = quantity, "mu"
    try:
        rows = read_rows(Path(written).expanduser(), names, quantity, units)
    except FileNotFoundError as error:
        raise FileNotFoundError(f"{title}: {error}") from None
    for where, row in rows.items():
        for name in names:
            if math.isnan(row.get(name, math.nan)):
                raise ValueError(f"{title}: {where}: {name} is missing")
    return [(row[quantity], row["mu"]) for row in rows.values()]
