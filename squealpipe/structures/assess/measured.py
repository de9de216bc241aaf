"""Lists of measured noises, and how they agree with a map of operating points."""

from __future__ import annotations

import math
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.structures.assess.operating_units import OperatingUnits, read_rows
from squealpipe.structures.schema.operating_map import QUANTITIES, Match
from squealpipe.systems.inputs.values import brief

COLUMNS = (*QUANTITIES, "frequency", "level")
"""Columns of a list."""


class Noise(NamedTuple):
    """One line of a list: an operating point, and the noise that was heard there.

    Attributes:
        point: values by name of those of pressure, speed, mu and temperature that the list has.
        frequency: Hz; NaN where it was quiet.
        level: dB; NaN where none is given.
    """

    point: dict[str, float]
    frequency: float
    level: float


def read_noises(path: str | PathLike[str], units: OperatingUnits) -> list[Noise]:
    """Return the noises of a list, a text file or an Excel sheet.

    Columns are ``pressure`` (factor of the preloads, or with a unit that of the faces), ``speed
    [km/h]``, ``temperature [°C]``, ``mu``, ``frequency [Hz]`` and ``level [dB]`` by name, with
    their unit in brackets; an empty frequency is a quiet point, and another empty quantity is not
    known there.

    Raises:
        FileNotFoundError: no such file.
        ValueError: names the file, the line and what is wrong there.
    """
    if not isinstance(path, str | PathLike):
        raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
            f"measured = {brief(path)}: the name of a file is needed"
        )
    source = Path(path).expanduser()
    try:
        rows = read_rows(source, COLUMNS, "frequency", units)
    except FileNotFoundError as error:
        raise FileNotFoundError(f"measured: {error}") from None
    names = list(next(iter(rows.values()), {}))
    if "frequency" not in names or not set(names) & set(QUANTITIES):
        raise ValueError(
            f"{source}: columns frequency and one of {', '.join(QUANTITIES)} are needed; it has "
            f"{', '.join(names) or 'no row'}"
        )
    return [_noise(where, row) for where, row in rows.items()]


def _noise(where: str, row: dict[str, float]) -> Noise:
    listed = [name for name in QUANTITIES if name in row]
    point = {name: row[name] for name in listed if not math.isnan(row[name])}
    if not point:
        raise ValueError(f"{where}: {' and '.join(listed)} is missing")
    return Noise(point, row["frequency"], row.get("level", math.nan))


def matched(points: xr.Dataset, noises: list[Noise], band: float) -> dict[str, Any]:
    """Return variables that compare each measured noise with the nearest operating point.

    Args:
        points: dataset ``operating_map``; what it does not vary is not compared.
        band: largest difference of frequencies of one noise, over the measured one.
    """
    known: dict[str, list[Any]] = {"frequency": [], "predicted": [], "match": []}
    for noise in noises:
        place = {
            name: _nearest(points[name].values, at)
            for name, at in noise.point.items()
            if name in points.dims
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

    Several points belong to a noise if its line leaves a quantity out, such as friction.
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
