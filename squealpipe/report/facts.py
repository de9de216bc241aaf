"""Numbers of the report's prose, each computed from the datasets of the run."""

from __future__ import annotations

from collections.abc import Callable
from math import isnan
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.claims.evidence import Run


def gather_facts(datasets: Run) -> dict[str, Any]:
    """Topic → its numbers, for the topics whose datasets the run has."""
    return {
        topic: make(datasets)
        for topic, (needed, make) in TOPICS.items()
        if all(name in datasets for name in needed)
    }


def linear(datasets: Run) -> dict[str, Any]:
    """Counts of cells on the linear maps."""
    stability, sliding = datasets["stability_map"], datasets["quasi_static_map"]
    regime, possible = stability.regime_linear, sliding.possible == 1
    return {
        "points": stability.sizes["alpha1"],
        "flutter": int((regime == 1).sum()),
        "divergence": int((regime == 2).sum()),
        "unstable_printed": int(((regime > 0) & (sliding.possible_as_printed == 1)).sum()),
        "unstable_physical": int(((regime > 0) & possible).sum()),
        "flutter_physical": int(((regime == 1) & possible).sum()),
    }


def coupling(datasets: Run) -> dict[str, Any]:
    """Where the modes of the published mode-coupling model merge, by our A3."""
    model = datasets["mode_coupling"]
    onset = int(np.argmax(model.growth_rate.values > 1e-9))
    published = model.published_frequency
    return {
        "onset": float(model.mu[onset - 1]),
        "frequency": float(model.frequency[onset].mean()),
        "largest_difference": float(abs(model.frequency - published).max()),
    }


def inference(datasets: Run) -> dict[str, Any]:
    """The feasible set, what cuts it, and the margins of the study's own parameters."""
    samples = datasets["parameter_inference"]
    feasible = samples.feasible == 1
    along = samples.isel(sample=(feasible & (samples.direction == 1)).values)
    alone = samples.share_cut_alone
    sharpest = int(alone.values.argmax())
    return {
        "samples": samples.sizes["sample"],
        "feasible": int(feasible.sum()),
        "along": {
            name: [float(along[name].min()), float(along[name].max())]
            for name in ("kappa", "mu", "length_ratio", "speed_ratio")
        }
        if along.sizes["sample"]
        else None,
        "sharpest": [str(alone.statement.values[sharpest]), float(alone[sharpest])],
        "broken": [str(name) for name in samples.statement.values[samples.baseline_holds == 0]],
        "statements": [_constraint(samples.sel(statement=name)) for name in samples.statement],
    }


def _constraint(row: xr.Dataset) -> dict[str, Any]:
    return {
        "name": str(row.statement.item()),
        "criterion": str(row.criterion.item()),
        "horizon": _or_none(row.horizon),
        "share": float(row.share_holding),
        "margin": float(row.baseline_margin),
    }


TOPICS: dict[str, tuple[tuple[str, ...], Callable[[Run], dict[str, Any]]]] = {
    "linear": (("stability_map", "quasi_static_map"), linear),
    "coupling": (("mode_coupling",), coupling),
    "inference": (("parameter_inference",), inference),
}
"""Topic → the datasets that it needs and the function that reads them."""


def _or_none(value: xr.DataArray) -> float | None:
    return None if isnan(float(value)) else float(value)
