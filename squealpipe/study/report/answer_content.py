"""Contents of a report that a dataset ``assess`` gives, alike for pads and structures."""

import math
from typing import Any

import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.study.report import answer
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import part_of_time


def answer_content(told: xr.Dataset) -> dict[str, Any]:
    """Return the answer in words, what changes it, and the settled motion in numbers."""
    return {
        "verdict": answer.verdict_of(told).name,
        "quiet": answer.verdict_of(told) is Verdict.quiet,
        "struck": bool(told.quiet_unless_struck),
        "headline": answer.headline(told),
        "cause": answer.cause(told),
        "level": answer.level(told),
        "motion": answer.impacts(told),
        "sudden": answer.sudden(told),
        "stops": answer.stops(told),
        "cheapest": [
            answer.cure_line(cure, told)
            for cure in answer.of_a_push(told)[: answer.CHEAPEST]
        ],
        "cures": [cure._asdict() for cure in answer.cures(told)],
        "not_cures": [
            {"words": words, "tried": tried} for words, tried in answer.not_cures(told)
        ],
        "numbers": _numbers(told),
    }


def _numbers(told: xr.Dataset) -> list[dict[str, str]]:
    """Quantity, value from steady sliding and value from a sudden start."""
    rows = []
    for name, unit, words in (
        ("frequency", "Hz", "Strongest line of the velocity"),
        ("velocity_rms_along", "m s-1", "Velocity along the belt, rms"),
        ("velocity_rms_across", "m s-1", "Velocity across the belt, rms"),
        ("displacement_peak", "m", "Largest distance from the mean position"),
        ("peak_contact_force", "N", "Largest contact force"),
        ("peak_contact_force_over_preload", "1", "The same over the preload force"),
        ("separated_fraction", "%", "Time without contact"),
        ("stick_fraction", "%", "Time sticking to the belt"),
        ("impact_rate", "s-1", "Rate of impacts"),
        ("impact_speed", "m s-1", "Fastest impact"),
        ("settled_by", "s", "Had settled after"),
    ):
        values = [float(told[f"{prefix}{name}"]) for prefix in ("", "sudden_")]
        rows.append(
            {
                "words": words,
                "pushed": _written(values[0], unit),
                "sudden": _written(values[1], unit),
            }
        )
    for column, prefix in (("pushed", ""), ("sudden", "sudden_")):
        if answer.verdict_of(told, prefix) is Verdict.undetermined:
            rows[-1][column] = "not settled"
    return rows


def _written(value: float, unit: str) -> str:
    if not math.isfinite(value):
        return "–"
    if unit == "%":
        return part_of_time(value)
    return engineering(value, unit)
