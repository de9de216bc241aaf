"""Numbers about motions of model A1 in time."""

from __future__ import annotations

from typing import Any

import numpy as np

from squealpipe.parameters import SCENES
from squealpipe.schema import meanings
from squealpipe.schema.dynamics.runs import MotionFlag
from squealpipe.study.claims.evidence import Run
from squealpipe.study.figures.parts.origin import angles_of
from squealpipe.study.figures.parts.style import flag_words

SATURATED = 0.01
"""Relative change of the amplitude between two late parts of a run below which it has settled."""
REGULAR = [
    MotionFlag.periodic_hammering,
    MotionFlag.quasi_periodic_hammering,
    MotionFlag.regular_hammering,
]
"""Kinds of hammering in which no perturbation grew exponentially."""


def assumptions(run: Run) -> dict[str, Any]:
    """Table 1 extended: for each scene and level, the assumptions of the level that broke."""
    table = run["assumptions"]
    broken = (table.needed == 1) & (table.held == 0)
    levels = [str(level) for level in table.level.values if "-" not in str(level)]
    scenes = []
    for name in map(str, table.scene.values):
        cells = []
        for level in levels:
            row = broken.sel(scene=name, level=level)
            measures = table.measure.sel(scene=name, level=level)
            cells.append(
                [
                    {"what": str(what), "measure": float(measures.sel(assumption=what))}
                    for what in row.assumption.values[row.values]
                ]
            )
        scenes.append({"name": name, "angles": angles_of(SCENES[name]), "cells": cells})
    return {
        "levels": levels,
        "scenes": scenes,
        "limits": {
            str(name): float(table.limit.sel(assumption=name)) for name in table.assumption.values
        },
    }


def whirl(run: Run) -> dict[str, Any]:
    """Size of the whirl at the study's belt speed and its law."""
    dataset, parameters = run["whirl"], run.parameters
    here = dataset.sel(belt_speed=parameters.belt_speed, method="nearest")
    whirls = dataset.amplitude.where(dataset.motion == MotionFlag.whirl)
    growth = float(here.amplitude / here.amplitude_before) - 1.0
    return {
        "motion": flag_words(meanings(dataset.motion)[int(here.motion)]),
        "saturated": abs(growth) < SATURATED,
        "speed": float(here.belt_speed),
        "own_speed": bool(np.isclose(here.belt_speed, parameters.belt_speed, rtol=1e-6)),
        "amplitude": float(here.amplitude / parameters.preload),
        "passes_belt": bool(here.max_vx >= abs(here.belt_speed)),
        "top_speed": float(here.max_vx / abs(here.belt_speed)),
        "lowest_speed": finite_or_none(abs(dataset.belt_speed).where(whirls.notnull()).min()),
        "speeds": _slowest_and_fastest(dataset),
        "t_end": float(dataset.t_end / parameters.time_unit),
        **_fit_and_onset(dataset),
        "slope": finite_or_none(dataset.slope),
        "offset": finite_or_none(dataset.offset),
        "energy_slope": float(dataset.energy_slope),
        "energy_offset": float(dataset.energy_offset),
    }


def _fit_and_onset(dataset: Any) -> dict[str, Any]:
    """How far and how well the line holds, and the onset; None in files that do not tell."""
    if "fit_range" not in dataset:
        return dict.fromkeys(("fit_range", "fit_residual", "worst_outside", "onset"))
    outside = np.abs(dataset.residual.where(dataset.fitted == 0))
    known = bool(np.isfinite(dataset.fit_range).all())
    bracket = bool(np.isfinite(dataset.onset).all())
    return {
        "fit_range": [float(speed) for speed in dataset.fit_range] if known else None,
        "fit_residual": finite_or_none(dataset.fit_residual),
        "worst_outside": finite_or_none(outside.max()),
        "onset": [float(speed) for speed in dataset.onset] if bracket else None,
        "onset_exceptions": int(dataset.onset_exceptions),
    }


def transient(run: Run) -> dict[str, Any]:
    """Lifetimes of the bounded motion."""
    dataset, unit = run["transient"], run.parameters.time_unit
    lifetimes = dataset.shown_lifetime.values / unit
    ended = lifetimes[np.isfinite(lifetimes)]
    stays = dataset.lifetime.isnull().all("sample")
    speeds = dataset.belt_speed.values[stays.values]
    return {
        "runs": int(lifetimes.size),
        "ended": int(ended.size),
        "shortest": float(ended.min()) if ended.size else None,
        # runs cut off at t_end count as longer than all others
        "median": finite_or_none(np.median(np.where(np.isfinite(lifetimes), lifetimes, np.inf))),
        **_survival(dataset, unit),
        "longest": float(ended.max()) if ended.size else None,
        "t_end": float(dataset.t_end) / unit,
        "never": [float(speed) for speed in speeds],
        "each": dataset.sizes["sample"],
        "speeds": _slowest_and_fastest(dataset),
    }


def _slowest_and_fastest(dataset: Any) -> list[float]:
    speeds = np.abs(dataset.belt_speed.values)
    return [float(speeds.min()), float(speeds.max())]


def _survival(dataset: Any, unit: float) -> dict[str, Any]:
    """Interval of the median, and the hazard of the first and of all later spans of age."""
    if "median_lifetime" not in dataset:
        return {"median_interval": None, "hazards": None}
    median, low, high = dataset.median_lifetime.values / unit
    edges = dataset.hazard_edges.values / unit
    rates = zip(
        edges[:-1], edges[1:], dataset.hazard.values * unit, dataset.hazard_low.values * unit,
        dataset.hazard_high.values * unit, strict=True,
    )  # fmt: skip
    names = ("from", "to", "rate", "low", "high")
    return {
        "median": finite_or_none(median),
        "median_interval": [float(low), finite_or_none(high)] if np.isfinite(low) else None,
        "hazards": [
            dict(zip(names, map(float, row), strict=True)) for row in rates if np.isfinite(row[2])
        ],
    }


def hammering(run: Run) -> dict[str, Any]:
    """Kinds of motion over the angle map."""
    dataset = run["hammering_map"]
    kinds: list[dict[str, Any]] = [
        {"kind": flag_words(name), "share": float((dataset.motion == value).mean())}
        for value, name in meanings(dataset.motion).items()
    ]
    unit = run.parameters.time_unit
    limited = dataset.predictability_horizon < dataset.t_end
    horizon = dataset.predictability_horizon.where(limited) / unit
    return {
        "points": dataset.sizes["alpha1"],
        "t_end": float(dataset.t_end) / unit,
        "kinds": [kind for kind in kinds if kind["share"] > 0],
        "regular": int(dataset.motion.isin(REGULAR).sum()),
        "repeating": int((dataset.motion == MotionFlag.periodic_hammering).sum()),
        **_lasting(dataset),
        "peak": float(dataset.peak_contact_force.max()),
        "limited": float(limited.mean()),
        "median_horizon": finite_or_none(horizon.median()),
    }


def _lasting(dataset: Any) -> dict[str, Any]:
    """How many labels are others at twice the time; nothing where that was not looked at."""
    if "motion_later" not in dataset:
        return {"changed": None, "broken": None}
    regular = dataset.motion.isin(REGULAR)
    broken = dataset.motion_later.isin([MotionFlag.irregular_hammering, MotionFlag.whirl])
    return {
        "changed": int((dataset.motion != dataset.motion_later).sum()),
        "broken": int((regular & broken).sum()),
    }


def refinement(run: Run) -> dict[str, Any]:
    """The refined boundary against uniform maps."""
    dataset = run["refinement_check"]
    points = int(dataset.refined_points)
    finest = dataset.isel(points=-1)
    return {
        "points": points,
        "share": float(dataset.refined_runs) / points**2,
        "uniform": int(finest.points),
        "different": int(finest.different_cells),
        "missed": int(finest.missed_regions),
        **_inherited(run["refined_validity_map"]),
    }


def _inherited(refined: Any) -> dict[str, Any]:
    """How often a cell that was not run is wrong, by a sample of them."""
    if "inherited_error" not in refined or not np.isfinite(refined.inherited_error):
        return {"checked": None, "wrong": None, "most_wrong": None}
    return {
        "checked": int(refined.inherited_checked),
        "wrong": int(refined.inherited_wrong),
        "most_wrong": float(refined.inherited_error_interval[1]),
    }


def finite_or_none(value: Any) -> float | None:
    """A number as JSON takes it."""
    number = float(value)
    return number if np.isfinite(number) else None
