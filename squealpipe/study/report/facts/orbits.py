"""Numbers about periodic motions of model A4."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.schema import Outcome
from squealpipe.study.claims.evidence import Run


def orbit_cells(atlas: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
    """Cells that hold an orbit; of these, those off their branch and those that are unstable."""
    other = atlas.outcome == Outcome.other_branch
    found = (atlas.outcome == Outcome.converged) | other
    return found, other, found & (abs(atlas.stability_index) > 2 + 1e-6)


def atlas(run: Run) -> dict[str, Any]:
    """How many cells of the atlas hold an orbit, off its branch or unstable."""
    dataset = run["orbit_atlas"]
    found, other, unstable = orbit_cells(dataset)
    return {
        "points": dataset.sizes["alpha1"],
        "y_peak": float(dataset.y_peak / run.parameters.preload),
        "found": [float(found.sel(mode=mode).mean()) for mode in dataset.mode],
        "other": [float(other.sel(mode=mode).mean()) for mode in dataset.mode],
        "unstable": [
            float(unstable.sel(mode=mode).sum() / found.sel(mode=mode).sum())
            for mode in dataset.mode
        ],
    }


def harmonic(run: Run) -> dict[str, Any]:
    """Fitted convergence rates of harmonic balance."""
    dataset = run["harmonic_sweep"]
    return {
        name: [float(np.nanmin(dataset[name])), float(np.nanmax(dataset[name]))]
        for name in ("omega_rate", "waveform_rate", "sigma_rate")
        if np.isfinite(dataset[name]).any()
    }


def series(run: Run) -> dict[str, Any]:
    """Distance of the harmonic-balance points of Figs. 10–13 from exact orbits."""
    errors, harmonics = [], 0
    for name in ("F10_mode2", "F11_mode2", "F12_mode2", "F13_mode1"):
        dataset = run[f"backbone/{name}_hbm"]
        harmonics = dataset.sizes["harmonic"] - 1
        error = abs(dataset.omega / dataset.omega_exact - 1).values
        errors.append(error[np.isfinite(error)])
    together = np.concatenate(errors)
    return {
        "harmonics": harmonics,
        "points": int(together.size),
        "median": float(np.median(together)),
        "largest": float(together.max()),
    }


def doubled(run: Run) -> dict[str, Any]:
    """What leaves the period doublings of the coupled backbones; empty without any doubling."""
    found = [run[name] for name in run if name.startswith("doubled_branch/")]
    branches = [branch for branch in found if branch.sizes["point"] > 1]
    if not branches:
        return {}
    preload = run.parameters.preload
    index = np.concatenate([branch.stability_index.values[1:] for branch in branches])
    return {
        "asked": len(found),
        "branches": len(branches),
        "points": int(index.size),
        "stable": float((np.abs(index) < 2.0).mean()),
        "peaks": sorted(float(branch.doubling_y_peak) / preload for branch in branches),
        "residual": max(float(branch.residual.max()) for branch in branches),
        "closed": sum(int(branch.end) == Outcome.tongue_end for branch in branches),
    }
