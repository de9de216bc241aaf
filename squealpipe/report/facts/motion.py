"""Numbers about motions of model A1 in time."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from squealpipe.claims.evidence import Run
from squealpipe.parameters import SCENES


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
        scene = SCENES[name]
        angles = f"({_over_pi(scene.alpha1)}, {_over_pi(scene.alpha2)})"
        scenes.append({"name": name, "angles": angles, "cells": cells})
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
    whirls = dataset.amplitude.where(dataset.motion == _flag(dataset.motion, "whirl"))
    return {
        "speed": float(here.belt_speed),
        "amplitude": float(here.amplitude / parameters.preload),
        "top_speed": float(here.max_vx / here.belt_speed),
        "lowest_speed": _finite(dataset.belt_speed.where(whirls.notnull()).min()),
        "speeds": [float(dataset.belt_speed.min()), float(dataset.belt_speed.max())],
        "t_end": float(dataset.t_end / parameters.time_unit),
        "slope": _finite(dataset.slope),
        "offset": _finite(dataset.offset),
        "energy_slope": float(dataset.energy_slope),
        "energy_offset": float(dataset.energy_offset),
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
        "median": float(np.median(ended)) if ended.size else None,
        "longest": float(ended.max()) if ended.size else None,
        "t_end": float(dataset.t_end) / unit,
        "never": [float(speed) for speed in speeds],
        "speeds": [float(dataset.belt_speed.min()), float(dataset.belt_speed.max())],
    }


def hammering(run: Run) -> dict[str, Any]:
    """Kinds of motion over the angle map."""
    dataset = run["hammering_map"]
    meanings = dataset.motion.attrs["flag_meanings"].split()
    values = dataset.motion.attrs["flag_values"]
    kinds = [
        {"kind": name.replace("_", " "), "share": float((dataset.motion == value).mean())}
        for name, value in zip(meanings, values, strict=True)
    ]
    unit = run.parameters.time_unit
    limited = dataset.predictability_horizon < dataset.t_end
    horizon = dataset.predictability_horizon.where(limited) / unit
    return {
        "points": dataset.sizes["alpha1"],
        "t_end": float(dataset.t_end) / unit,
        "kinds": [kind for kind in kinds if kind["share"] > 0],
        "peak": float(dataset.peak_contact_force.max()),
        "limited": float(limited.mean()),
        "median_horizon": _finite(horizon.median()),
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
    }


def _over_pi(angle: float) -> str:
    """An angle as people write it: 0, π, 0.83π, 5π/6."""
    multiple = angle / np.pi
    if abs(multiple - round(multiple, 2)) < 1e-12:
        return {0.0: "0", 1.0: "π"}.get(round(multiple, 2), f"{multiple:.4g}π")
    ratio = Fraction(multiple).limit_denominator(100)
    return f"{ratio.numerator}π/{ratio.denominator}"


def _flag(variable: Any, name: str) -> int:
    meanings = variable.attrs["flag_meanings"].split()
    return int(variable.attrs["flag_values"][meanings.index(name)])


def _finite(value: Any) -> float | None:
    number = float(value)
    return number if np.isfinite(number) else None
