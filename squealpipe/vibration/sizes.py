"""Decision whether a dataset is in the numbers of a real brake or in scaled ones."""

import json
import math

import xarray as xr


def is_real(dataset: xr.Dataset) -> bool:
    """Return whether a dataset is of a brake with the size of a real one, not of scaled numbers."""
    # matrices of structures are in SI
    if str(dataset.attrs.get("schema")).startswith(
        ("complex_modes", "squealing_modes")
    ):
        return True
    text = dataset.attrs.get("parameters")
    if not isinstance(text, str):
        return False
    parameters = json.loads(text)
    if not {"preload", "mass", "k1"} <= set(parameters):
        return False
    time = math.sqrt(parameters["mass"] / parameters["k1"])
    # m and s: the sizes of a brake that one can hold; scaled numbers have 1 for both
    return float(parameters["preload"]) < 0.01 and time < 0.01
