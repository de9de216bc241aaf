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
