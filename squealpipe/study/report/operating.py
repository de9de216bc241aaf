"""Describe a map of operating points in lines of text."""

import json
from collections.abc import Iterator

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.schema import Outcome
from squealpipe.structures.schema.operating_map import Match
from squealpipe.study.report.squealing import without_bound
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number, off_by, percent


def lines(dataset: xr.Dataset) -> Iterator[str]:
    """Yield how many points are noisy, the loudest of them, and how often each band is heard.

    Where the map was compared with a list of measured noises, their hits, misses and false alarms
    follow. The last line counts the points that are undetermined, if there are any.
    """
    verdicts = dataset.verdict.values
    noisy = np.isin(verdicts, (Verdict.squeals, Verdict.hammers))
    total = verdicts.size
    unknown = int((verdicts == Verdict.undetermined).sum())
    if not noisy.any() and unknown < total:
        yield f"Quiet at {total - unknown} of {total} operating points, noisy at none."
    elif noisy.any():
        hammers = int((verdicts == Verdict.hammers).sum())
        yield (
            f"Noisy at {int(noisy.sum())} of {total} operating points "
            f"({percent(float(noisy.mean()))}); at {hammers} of them contact is lost repeatedly."
        )
        level = np.where(noisy, dataset.velocity_rms.values, -np.inf)
        place = np.unravel_index(int(level.argmax()), level.shape)
        point = dataset.isel(dict(zip(dataset.verdict.dims, place, strict=True)))
        yield (
            f"Loudest: {engineering(float(point.velocity_rms), 'm s-1')} rms at "
            f"{engineering(float(point.frequency), 'Hz')}, at {_place(point)}."
        )
        for band, share in zip(
            dataset.band.values, dataset.occurrence.values, strict=True
        ):
            if share > 0:
                middle = engineering(float(band), "Hz", 2)  # as third octaves are named
                yield f"  band at {middle}: {percent(float(share))} of all points"
    if "hits" in dataset:
        yield (
            f"Measured: {int(dataset.hits)} of {int(dataset.hits) + int(dataset.misses)} noises "
            f"are predicted within {percent(float(dataset.frequency_band))} of their frequency; "
            f"of the points measured quiet, {int(dataset.quiet_agreed)} are predicted quiet and "
            f"{int(dataset.false_alarms)} noisy (false alarms)."
        )
        yield from _lines_of_the_list(dataset)
        outside = int((dataset.match == Match.outside).sum())
        if outside:
            yield f"  Lines of the list outside the range of the map: {outside}."
        if "not_compared" in dataset.attrs:
            names = dataset.attrs["not_compared"]
            yield f"  Not compared, since the map does not vary it: {names}."
    if unknown:
        yield f"Undetermined at {unknown} of {total} operating points{_reasons(dataset)}"


def _reasons(dataset: xr.Dataset) -> str:
    """Say why points are undetermined: those that grow without bound have remedies."""
    unknown = dataset.verdict.values == Verdict.undetermined
    unbounded = unknown & (dataset.outcome.values == Outcome.not_finite)
    others = "not settled in time, or no steady sliding."
    if not unbounded.any():
        return f": {others}"
    frequencies = np.where(unbounded, dataset.leading_frequency.values, np.inf)
    lowest = xr.Dataset({"frequency": frequencies.min()})
    told = f"a small push grows {without_bound(lowest)}"
    if (unbounded == unknown).all():
        return f": {told}"
    return f". At {int(unbounded.sum())} of them {told} The others: {others}"


def _lines_of_the_list(dataset: xr.Dataset) -> Iterator[str]:
    """Yield how far hits are off, and a line for each miss or false alarm, eight at most."""
    measured, predicted = (
        dataset[f"{name}_frequency"].values for name in ("measured", "predicted")
    )
    off = predicted / measured - 1.0
    match = dataset.match.values
    if hits := off[match == Match.hit].tolist():
        yield f"  Frequencies of the hits are at most {percent(max(map(abs, hits)))} apart."
    wrong = np.flatnonzero(np.isin(match, (Match.miss, Match.false_alarm)))
    for noise in wrong[:8].tolist():
        said = "quiet"
        if np.isfinite(predicted[noise]):
            said = engineering(float(predicted[noise]), "Hz")
        heard, apart = "quiet", ""
        if np.isfinite(measured[noise]):
            heard = engineering(float(measured[noise]), "Hz")
            if said != "quiet":
                apart = f" ({off_by(off[noise])})"
        yield f"  Line {noise + 1} of the list: measured {heard}, predicted {said}{apart}."
    if len(wrong) > 8:
        yield f"  {len(wrong) - 8} more lines differ: variable match of the dataset."


def _place(point: xr.Dataset) -> str:
    """Name an operating point in words."""
    mean = float(point.mean_pressure * point.pressure)
    words = [
        engineering(mean, "Pa")
        if np.isfinite(mean)
        else f"{number(float(point.pressure))} times the preload"
    ]
    is_rotation = "rotation" in json.loads(point.attrs.get("parameters", "{}"))
    unit = "rad s-1" if is_rotation else "m s-1"
    words.append(f"speed {engineering(float(point.speed), unit)}")
    if "temperature" in point.coords:
        words.append(f"{number(float(point.temperature))} °C")
    if np.isfinite(point.friction):
        words.append(f"friction {number(float(point.friction))}")
    return ", ".join(words)
