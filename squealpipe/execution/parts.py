"""Big maps and sweeps in parts, each a dataset of its own, for many machines.

A cell of a map does not know its neighbours, nor does a run of a sweep, so what is joined equals
what is made at once bit for bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.schema import build, schema_of
from squealpipe.schema.sweep import fill_up
from squealpipe.store import produce

OWN_ATTRIBUTES = frozenset(
    {"Conventions", "title", "schema", "schema_version", "license", "references", "comment"}
)


def scattered_rows(rows: int, item: str) -> slice:
    """Rows of one part of a scattered map.

    Args:
        rows: rows of the whole map.
        item: "i-of-n", Snakemake's name of a part.

    Raises:
        ValueError: another form, i is not within 1 … n, or there are more parts than rows.
    """
    index, _, count = item.partition("-of-")
    if not (index.isdigit() and count.isdigit() and 1 <= int(index) <= int(count)):
        raise ValueError(f"part {item!r}: i-of-n with 1 ≤ i ≤ n is needed")
    if int(count) > rows:
        raise ValueError(f"{count} parts of {rows} rows: scatter into at most {rows} parts")
    edges = [rows * k // int(count) for k in range(int(count) + 1)]
    return slice(edges[int(index) - 1], edges[int(index)])


def make_map(
    task: Callable[..., xr.Dataset],
    params: Parameters,
    name: str,
    part: Mapping[str, Any],
    *,
    output: str,
    key: str,
    item: str = "1-of-1",
) -> None:
    """Make and save a map of model A1 over both angles from 0 to π, or the rows of one part.

    Args:
        task: makes the map from parameters, angles, ``t_end`` and ``tol``.
        params: physical parameters.
        name: of the map; its keys are ``dynamics.<name>_points`` and ``dynamics.<name>_horizon``.
        part: slice of the configuration.
        output: dataset to write.
        key: of the rule.
        item: part of a scattered map, "i-of-n".
    """
    angles = np.linspace(0.0, np.pi, part[f"dynamics.{name}_points"])
    horizon, tol = part[f"dynamics.{name}_horizon"] * params.time_unit, part["dynamics.tol"]
    rows = angles[scattered_rows(len(angles), item)]
    produce(
        lambda: task(params, rows, angles, t_end=horizon, tol=tol),
        config=part,
        output=output,
        key=key,
    )


def join(parts: Sequence[xr.Dataset], along: str = "alpha1") -> xr.Dataset:
    """One map or sweep from its parts, in order.

    Runs of a sweep that are shorter than the longest of all parts are filled up.

    Args:
        parts: datasets that differ in ``along`` alone.
        along: the dimension that was cut.

    Raises:
        ValueError: there are none, or they are not of one kind and grid.
    """
    if not parts:
        raise ValueError("no parts to join")
    first = parts[0]
    schema = schema_of(first)
    shared = [name for name in first.coords if along not in first[name].dims]
    for part in parts[1:]:
        same_kind = part.attrs["schema"] == first.attrs["schema"]
        if not same_kind or any(not np.array_equal(part[name], first[name]) for name in shared):
            raise ValueError(f"the parts are not blocks of rows of one map, cut along {along}")
    arrays = {
        str(name): _joined([part[name] for part in parts], along)
        if along in variable.dims
        else variable.values
        for name, variable in first.variables.items()
    }
    attributes = {key: first.attrs[key] for key in first.attrs if key not in OWN_ATTRIBUTES}
    data = {name: arrays[name] for name in arrays if name in schema.variables}
    coordinates = {name: arrays[name] for name in arrays if name in schema.coordinates}
    return build(schema, data, coordinates, attributes)


def _joined(arrays: Sequence[xr.DataArray], along: str) -> np.ndarray:
    axis = arrays[0].dims.index(along)
    longest = np.max([array.shape for array in arrays], axis=0)
    full = [(*longest[:axis], array.shape[axis], *longest[axis + 1 :]) for array in arrays]
    filled = [fill_up(array.values, shape) for array, shape in zip(arrays, full, strict=True)]
    return np.concatenate(filled, axis=axis)
