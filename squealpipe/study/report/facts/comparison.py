"""Numbers about methods compared with one another."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.schema.comparison import Reliability, Role
from squealpipe.schema.ladder import Level
from squealpipe.study.claims.evidence import Run
from squealpipe.study.figures.comparison.model_ladder import QUESTION_NAMES
from squealpipe.text import as_people_write


def failures(run: Run) -> dict[str, Any]:
    """Verdicts of each method and setting over the hard scenes, and totals at equal tolerance."""
    dataset = run["failure_atlas"]
    tightest = float(dataset.requested.min())
    methods = [_judged(dataset.sel(solver=name)) for name in dataset.solver.values]
    equal = [row for row in methods if row["tolerance"] in {None, tightest}]
    return {
        "scenes": dataset.sizes["scene"],
        "tolerance": tightest,
        "methods": methods,
        "totals": {
            whose: {
                key: sum(row[key] for row in equal if row["ours"] == ours)
                for key in ("asked", "silent", "missed")
            }
            for whose, ours in (("ours", True), ("others", False))
        },
        "recovered": _recovered(dataset),
    }


def _judged(row: xr.Dataset) -> dict[str, Any]:
    right = row.verdict == Reliability.right
    return {
        "method": as_people_write(str(row.solver.item())),
        "ours": int(row.role) != Role.public,
        "tolerance": None if np.isnan(row.requested) else float(row.requested),
        "asked": int((row.verdict != Reliability.not_applicable).sum()),
        "right": int(right.sum()),
        "flagged": int((row.verdict == Reliability.flagged).sum()),
        "silent": int((row.verdict == Reliability.silently_wrong).sum()),
        "warned": int((right & (row.flagged == 1)).sum()),
        "missed": int(row.missed_events.sum()),
    }


def _recovered(dataset: xr.Dataset) -> list[dict[str, Any]]:
    """Scenes in which a public method is wrong at one tolerance and right at a tighter one."""
    found = []
    timed = dataset.isel(
        solver=(np.isfinite(dataset.requested) & (dataset.role == Role.public)).values
    )
    names = np.array([str(name).rsplit(", ", 1)[0] for name in timed.solver.values])
    for name in dict.fromkeys(names.tolist()):
        mine = timed.isel(solver=names == name).sortby("requested", ascending=False)
        for scene in mine.scene.values:
            verdicts = mine.verdict.sel(scene=scene).values
            right = np.flatnonzero(verdicts == Reliability.right)
            if verdicts[0] not in {Reliability.not_applicable, Reliability.right} and right.size:
                tolerance = float(mine.requested[int(right[0])])
                found.append({"method": name, "scene": str(scene), "tolerance": tolerance})
    return found


def ladder(run: Run) -> dict[str, Any]:
    """What the cheapest adequate model answers and saves, question by question."""
    dataset = run["model_ladder"]
    tolerance = float(dataset.tolerance)
    questions = []
    for name in dataset.question.values:
        row = dataset.sel(question=name)
        errors = row.chosen_error.values
        asked = np.isfinite(errors)
        questions.append(
            {
                "question": QUESTION_NAMES[str(name)].rstrip("?"),
                "within": float((errors[asked] <= tolerance).mean()),
                "simpler": float((row.cheapest != Level.a1).mean()),
                "below": float((row.chosen != Level.a1).mean()),
                "cpu": float(row.chosen_cpu_time / row.always_cpu_time),
            }
        )
    reached = dataset.get("belt_reached")
    return {
        "belt_reached": None if reached is None else float(reached.mean()),
        "tolerance": tolerance,
        "points": dataset.sizes["alpha1"],
        "questions": questions,
    }


def integration(run: Run) -> dict[str, Any]:
    """Our default setting beside the most accurate public method, scene by scene."""
    dataset = run["work_precision_integration"]
    dataset = dataset.isel(run=(dataset.task == "integration").values)
    ours, public = (
        dataset.isel(run=(dataset.role == role).values) for role in (Role.our_setting, Role.public)
    )
    rows = []
    for scene in dict.fromkeys(map(str, ours.scene.values)):
        here = ours.isel(run=(ours.scene == scene).values)
        there = public.isel(run=(public.scene == scene).values)
        best = there.isel(run=int(np.nanargmin(there.error.values)))
        rows.append(
            {
                "scene": scene,
                "error": float(here.error.max()),
                "time": float(here.wall_time.max()),
                "ensemble_time": float(here.wall_time.min()),
                "public_method": as_people_write(f"{best.method.item()}, {best.setting.item()}"),
                "public_error": float(best.error),
                "public_time": float(best.wall_time),
            }
        )
    return {"scenes": rows}
