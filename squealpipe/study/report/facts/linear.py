"""Numbers about the linear models, their validation, and the parameters."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.study.claims.evidence import Run
from squealpipe.study.claims.maps import unstable_yet_sliding
from squealpipe.study.figures.parts.origin import parameter
from squealpipe.study.report.facts.motion import finite_or_none


def linear(datasets: Run) -> dict[str, Any]:
    """Counts of cells on the linear maps."""
    stability = datasets["stability_map"]
    regime = stability.regime_linear
    printed, physical = unstable_yet_sliding(datasets)
    return {
        "points": stability.sizes["alpha1"],
        "flutter": int((regime == 1).sum()),
        "divergence": int((regime == 2).sum()),
        "unstable_printed": int(printed.sum()),
        "unstable_physical": int(physical.sum()),
        "flutter_physical": int(((regime == 1) & physical).sum()),
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
        "horizon": finite_or_none(row.horizon),
        "share": float(row.share_holding),
        "margin": float(row.baseline_margin),
    }


def critical(run: Run) -> dict[str, Any]:
    """Where dashpots lower the critical friction, and what that changes at the study's own."""
    dataset, mu = run["critical_friction_map"], run.parameters.mu
    damping = [parameter(dataset, f"damping{i}") for i in (1, 2)]
    own = [run.parameters.damping1, run.parameters.damping2]
    turned, saved = turned_by_dashpots(run)
    return {
        "damping": damping,
        "own_damping": own if any(own) and own != damping else None,
        "points": dataset.sizes["alpha1"],
        "lowered": float(dataset.destabilized.mean()),
        "mu": mu,
        "turned": float(turned.mean()),
        "saved": float(saved.mean()),
    }


def turned_by_dashpots(run: Run) -> tuple[xr.DataArray, xr.DataArray]:
    """Cells that dashpots make unstable, and cells that they make stable, at the study's μ."""
    dataset, mu = run["critical_friction_map"], run.parameters.mu
    damped, undamped = dataset.critical_mu, dataset.critical_mu_undamped
    return (damped < mu) & (undamped >= mu), (damped >= mu) & (undamped < mu)
