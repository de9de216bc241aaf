"""What the report of a study of one's own shows, as plain data."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.schema.own import NUMBERS
from squealpipe.study.claims.evidence import Run
from squealpipe.study.figures.comparison.model_ladder import QUESTION_NAMES
from squealpipe.study.report.content import (
    Made,
    changed_rows,
    parameter_table,
    pictures,
)
from squealpipe.study.report.sections import OWN
from squealpipe.text import number


def gather_own(
    datasets: Mapping[str, Made],
    figures: Mapping[str, Made],
    parameters: Parameters,
    changed: Sequence[tuple[str, Any, Any]] = (),
) -> dict[str, Any]:
    """Content of ``templates/study.typ``.

    Args:
        changed: keys of grids and horizons that are not as shipped, with both values.
    """
    run = Run(parameters, {name: made.path for name, made in datasets.items()})
    table, spread = run["own_scenes"], run["propensity"]
    return {
        "title": "What the mass does: report of a study",
        "changed": changed_rows(changed),
        "parameters": parameter_table(parameters, of_a1=True),
        "figures": pictures(OWN, figures, run),
        "variants": [str(name) for name in table.variant.values],
        "scenes": [_scene(table.sel(scene=name), run) for name in table.scene.values],
        "propensity_scene": str(table.scene.values[0]),
        "propensity_end": float(spread.t_end),
        "distributions": [
            {"name": name, "words": f"{given.pop('distribution')}, {_listed(given)}"}
            for name, given in json.loads(spread.attrs["arguments"])[
                "distributions"
            ].items()
        ],
        "shares": [
            {
                "what": str(name).replace("_", " "),
                "share": float(spread.share.sel(quantity=name)),
                "low": float(spread.share_low.sel(quantity=name)),
                "high": float(spread.share_high.sel(quantity=name)),
                "leading": _leading(spread.sel(quantity=name)),
            }
            for name in spread.quantity.values
        ],
    }


def _scene(table: xr.Dataset, run: Run) -> dict[str, Any]:
    runs = [
        {
            "motion": str(here.motion.item()),
            **{
                name: _finite(here[name])
                for name in (*NUMBERS, "predictability_horizon")
            },
            "frequencies": [
                value for value in here.dominant_frequency.values if value > 0
            ],
        }
        for here in (
            table.isel(variant=index) for index in range(table.sizes["variant"])
        )
    ]
    return {
        "name": str(table.scene.item()),
        "angles": [float(np.degrees(table[name])) for name in ("alpha1", "alpha2")],
        "t_end": float(table.t_end),
        "runs": runs,
        "models": [
            {
                "question": QUESTION_NAMES[str(name)],
                "model": str(table.model.sel(question=name).item()),
            }
            for name in table.question.values
        ],
        **boundaries(
            run, str(table.scene.item()), float(table.alpha1), float(table.alpha2)
        ),
    }


def boundaries(
    run: Mapping[str, xr.Dataset], scene: str, alpha1: float, alpha2: float
) -> dict[str, Any]:
    """What the map says at a pair of angles, and how far the nearest cell is that says otherwise.

    Of contact the boundary as curves says it, where the study has it. Distances are in degrees in
    the plane of both angles; None: no such cell. Outside the map nothing is said: A1 moves
    otherwise where a spring comes from the opposite side.
    """
    validity = run["validity_map"]
    centres = [validity[name].values for name in ("alpha1", "alpha2")]
    gaps = [grid - angle for grid, angle in zip(centres, (alpha1, alpha2), strict=True)]
    distance = np.degrees(np.hypot(gaps[0][:, None], gaps[1][None, :]))
    nearest = np.unravel_index(int(distance.argmin()), distance.shape)
    inside = all(gap.min() <= 0.0 <= gap.max() for gap in gaps)
    found: dict[str, Any] = {}
    for name, cells in (
        ("lost", validity.separates.values == 1),
        ("unstable", validity.regime_linear.values > 0),
    ):
        here = bool(cells[nearest])
        others = distance[cells != here]
        found[name] = here if inside else None
        found[f"{name}_boundary"] = (
            float(others.min()) if inside and others.size else None
        )
    found["lost_share"] = float(100 * validity.separates.mean())
    if "validity_boundary" in run:
        found["lost_share"] = 100 * (1.0 - float(run["validity_boundary"].kept_share))
        if inside:
            measured = run[f"validity_distance/{scene}"]
            found["lost"] = not bool(measured.kept)
            found["lost_boundary"] = _finite(np.degrees(measured.distance))
    found["cell"] = float(
        np.degrees(validity.alpha1.values[1] - validity.alpha1.values[0])
    )
    return found


def _leading(row: xr.Dataset) -> str:
    """The parameter with the largest total index, or why there is none."""
    if float(row.share) in {0.0, 1.0}:
        return "the same in the whole sample"
    total = row.total_order.values
    if not np.isfinite(total).any():
        return "not resolved by this sample"
    best = int(np.nanargmax(total))
    return f"{row.input.values[best]} ({total[best]:.2f})"


def _listed(numbers: Mapping[str, float]) -> str:
    return ", ".join(
        f"{name.replace('_', ' ')} {number(n)}" for name, n in numbers.items()
    )


def _finite(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None
