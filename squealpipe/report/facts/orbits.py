"""Numbers about periodic motions of model A4."""

from __future__ import annotations

from typing import Any

import numpy as np

from squealpipe.claims.evidence import Run
from squealpipe.schema import Outcome


def atlas(run: Run) -> dict[str, Any]:
    """How many cells of the atlas hold an orbit, and how many of these are unstable."""
    dataset = run["orbit_atlas"]
    found = dataset.outcome == Outcome.converged
    unstable = found & (abs(dataset.stability_index) > 2 + 1e-6)
    return {
        "points": dataset.sizes["alpha1"],
        "y_peak": float(dataset.y_peak / run.parameters.preload),
        "found": [float(found.sel(mode=mode).mean()) for mode in dataset.mode],
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
