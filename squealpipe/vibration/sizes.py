"""Whether a dataset is in the numbers of a real brake or in scaled ones."""

import json
import math

import xarray as xr

SMALL_PRELOAD, SHORT_TIME = 0.01, 0.01
"""Preload, m, and √(m/k1), s, of a brake that one can hold; scaled numbers have 1 for both."""
STRUCTURES = ("complex_modes", "squealing_modes")
"""Schemas of structures, whose matrices are in SI."""


def is_real(dataset: xr.Dataset) -> bool:
    """Return whether a dataset is of a brake with the size of a real one, not of scaled numbers."""
    if str(dataset.attrs.get("schema")).startswith(STRUCTURES):
        return True
    text = dataset.attrs.get("parameters")
    if not isinstance(text, str):
        return False
    given = json.loads(text)
    if not {"preload", "mass", "k1"} <= set(given):
        return False
    time = math.sqrt(given["mass"] / given["k1"])
    return float(given["preload"]) < SMALL_PRELOAD and time < SHORT_TIME
