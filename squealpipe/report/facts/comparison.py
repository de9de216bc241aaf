"""Numbers about methods compared with one another."""

from __future__ import annotations

from typing import Any

import numpy as np

from squealpipe.claims.evidence import Run


def failures(run: Run) -> dict[str, Any]:
    """Verdicts of each method over the hard scenes."""
    dataset = run["failure_atlas"]
    meanings = dataset.verdict.attrs["flag_meanings"].split()
    values = dict(zip(meanings, dataset.verdict.attrs["flag_values"], strict=True))
    methods = []
    for name in dataset.solver.values:
        row = dataset.sel(solver=name)
        right = row.verdict == values["right"]
        methods.append(
            {
                "method": str(name),
                "ours": int(row.role) > 0,
                "asked": int((row.verdict != values["not_applicable"]).sum()),
                "right": int(right.sum()),
                "flagged": int((row.verdict == values["flagged"]).sum()),
                "silent": int((row.verdict == values["silently_wrong"]).sum()),
                "warned": int((right & (row.flagged == 1)).sum()),
            }
        )
    return {
        "scenes": dataset.sizes["scene"],
        "methods": methods,
        "ours_silent": sum(row["silent"] for row in methods if row["ours"]),
        "others_silent": sum(row["silent"] for row in methods if not row["ours"]),
    }


def ladder(run: Run) -> dict[str, Any]:
    """What the cheapest adequate model answers and saves, question by question."""
    dataset = run["model_ladder"]
    tolerance = float(dataset.tolerance)
    meanings = dataset.cheapest.attrs["flag_meanings"].split()
    complete = dataset.cheapest.attrs["flag_values"][meanings.index("a1")]
    questions = []
    for name in dataset.question.values:
        row = dataset.sel(question=name)
        errors = row.chosen_error.values
        asked = np.isfinite(errors)
        questions.append(
            {
                "question": str(name).replace("_", " "),
                "within": float((errors[asked] <= tolerance).mean()),
                "simpler": float((row.cheapest != complete).mean()),
                "hindsight": float(row.hindsight_time / row.always_time),
                "work": float(row.chosen_time / row.always_time),
                "wall": float(row.chosen_wall_time / row.always_wall_time),
            }
        )
    return {
        "tolerance": tolerance,
        "points": dataset.sizes["alpha1"],
        "questions": questions,
    }


def integration(run: Run) -> dict[str, Any]:
    """Our default setting beside the most accurate public method, scene by scene."""
    dataset = run["work_precision_integration"]
    dataset = dataset.isel(run=(dataset.task == "integration").values)
    roles = dict(
        zip(
            dataset.role.attrs["flag_meanings"].split(),
            dataset.role.attrs["flag_values"],
            strict=True,
        )
    )
    ours, public = (
        dataset.isel(run=(dataset.role == roles[name]).values) for name in ("our_setting", "public")
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
                "public_method": f"{best.method.item()}, {best.setting.item()}",
                "public_error": float(best.error),
                "public_time": float(best.wall_time),
            }
        )
    return {"scenes": rows}
