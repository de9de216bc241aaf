"""What a dataset holds, without its values, as one line of JSON: to open many files quickly."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

MOST_VALUES = 4096
"""A grid with more points is not in the header; such a file is opened itself."""

Lazy = Callable[[str, tuple[int, ...], np.dtype], Any]


def header_of(dataset: xr.Dataset) -> str:
    """The header of a dataset; attributes alone where a grid is too long for it."""
    grids = [dataset[dim] for dim in dataset.dims if dim in dataset.coords]
    if any(grid.size > MOST_VALUES for grid in grids):
        return json.dumps({"attrs": _encoded(dataset.attrs)}, separators=(",", ":"))
    variables = {
        str(name): {
            "dims": list(variable.dims),
            "shape": list(variable.shape),
            "dtype": variable.dtype.str,
            "attrs": _encoded(variable.attrs),
            **({"values": _encoded(variable.values)} if variable.dims == (name,) else {}),
        }
        for name, variable in dataset.variables.items()
    }
    coords = list(map(str, dataset.coords))
    whole = {"attrs": _encoded(dataset.attrs), "coords": coords, "variables": variables}
    return json.dumps(whole, separators=(",", ":"))


def dataset_from(header: bytes, lazy: Lazy) -> xr.Dataset | None:
    """The dataset of a header, its values given by ``lazy``; None if the header tells nothing.

    Args:
        header: the line, from a file whose seal fits.
        lazy: name, shape, dtype → array that reads its values when they are used.
    """
    whole = json.loads(header or b"{}")
    if "variables" not in whole:
        return None
    variables = {}
    for name, told in whole["variables"].items():
        attrs = _decoded(told["attrs"])
        if "values" in told:
            variables[name] = xr.Variable(told["dims"], _decoded(told["values"]), attrs)
        else:
            values = lazy(name, tuple(told["shape"]), np.dtype(told["dtype"]))
            variables[name] = xr.Variable(tuple(told["dims"]), values, attrs, fastpath=True)
    coords = {name: variables.pop(name) for name in whole["coords"]}
    return xr.Dataset(variables, coords, _decoded(whole["attrs"]))


def _encoded(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _encoded(item) for key, item in value.items()}
    if isinstance(value, str | int | float) and not isinstance(value, np.generic):
        return value
    array = np.asarray(value)
    if array.dtype.kind in "UO":
        return {"text": array.astype(str).tolist(), "dtype": array.astype(str).dtype.str}
    content = base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()
    return {"bytes": content, "dtype": array.dtype.str, "shape": list(array.shape)}


def _decoded(value: Any) -> Any:
    if not isinstance(value, dict):
        return value
    if "text" in value:
        return np.array(value["text"], dtype=value["dtype"])
    if "bytes" in value:
        flat = np.frombuffer(base64.b64decode(value["bytes"]), dtype=value["dtype"])
        array = flat.reshape(value["shape"])
        return array.copy() if array.ndim else array[()]
    return {key: _decoded(item) for key, item in value.items()}
