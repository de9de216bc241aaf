"""Numbers about the linear models, their validation, and the parameters."""

from __future__ import annotations

from math import isnan
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.claims.evidence import Run


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
    first = int(np.argmax(model.growth_rate.values > 1e-9))
    difference = abs(model.frequency - model.published_frequency)
    return {
        "below": float(model.mu[first - 1]),
        "above": float(model.mu[first]),
        "frequency": float(model.frequency[first].mean()),
        "largest_difference": float(difference.max()),
        "closed_form_error": float(model.closed_form_error.max()),
        "numeric_error": float(model.numeric_error.max()),
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


def _or_none(value: xr.DataArray) -> float | None:
    return None if isnan(float(value)) else float(value)
