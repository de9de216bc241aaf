"""Extremes of a run in time: from the integrator's series, between the instants that are stored."""

import numpy as np
import xarray as xr

EXTREMES = ("x", "y", "vx", "normalized_contact_force")
"""Quantities of which a run has ``<name>_min`` and ``<name>_max``."""


def extremes(run: xr.Dataset, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest and the largest value since the instant before each, (time,).

    They lie between the samples, which miss them by up to half a per cent of the size in a long
    run. NaN where the run did not come. A file of version 1.0.0 has the samples alone, and of it
    these are returned.
    """
    values = run[name].values
    if f"{name}_min" not in run:
        return values, values
    return run[f"{name}_min"].values, run[f"{name}_max"].values


def largest_size(run: xr.Dataset, name: str) -> np.ndarray:
    """Return the largest magnitude of a quantity since the instant before each, (time,)."""
    low, high = extremes(run, name)
    return np.asarray(np.maximum(-low, high))
