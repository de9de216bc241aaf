"""Big maps in blocks of rows: each block is a map of its own, and together they are the map.

A cell of a map does not know its neighbours, nor does a run of a sweep, so what is joined equals
what is made at once bit for bit, whether the blocks ran one after the other, were resumed after a
kill, or came from several machines.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.schema import build, find, schema_of
from squealpipe.schema.sweep import fill_up
from squealpipe.store import produce
from squealpipe.store.chunks import Arrays, Checkpoint, run_chunks

BLOCK = 16_384
"""Cells in a block: about a third of a second of work, far more than starting one costs."""

ATTRIBUTES = "attributes_as_json"
OWN_ATTRIBUTES = frozenset(
    {"Conventions", "title", "schema", "schema_version", "license", "references", "comment"}
)


def row_blocks(rows: int, cells_per_row: int, block: int = BLOCK) -> list[slice]:
    """Slices of rows, each with about ``block`` cells; they depend on the grid alone."""
    step = max(1, block // max(cells_per_row, 1))
    return [slice(first, min(first + step, rows)) for first in range(0, rows, step)]


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
    log: str,
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
        log: file for progress lines.
        item: part of a scattered map, "i-of-n".
    """
    angles = np.linspace(0.0, np.pi, part[f"dynamics.{name}_points"])
    horizon, tol = part[f"dynamics.{name}_horizon"] * params.time_unit, part["dynamics.tol"]
    with Checkpoint.beside(output, key=key, log=log) as checkpoint:
        produce(
            lambda: map_in_blocks(
                lambda rows: task(params, rows, angles, t_end=horizon, tol=tol),
                angles[scattered_rows(len(angles), item)],
                len(angles),
                label=f"{name} map",
                checkpoint=checkpoint,
            ),
            config=part,
            output=output,
            key=key,
        )


def map_in_blocks(
    make: Callable[[np.ndarray], xr.Dataset],
    alpha1: np.ndarray,
    cells_per_row: int,
    *,
    label: str,
    checkpoint: Checkpoint | None = None,
    block: int = BLOCK,
) -> xr.Dataset:
    """A map over (alpha1, alpha2), made block by block with progress, resumable.

    Args:
        make: rows of alpha1 → their part of the map.
        alpha1: 1-D array of all rows, rad.
        cells_per_row: length of alpha2.
        label: what is mapped, for the progress line.
        checkpoint: keeps finished blocks over a kill.
        block: cells in a block.
    """
    slices = row_blocks(len(alpha1), cells_per_row, block)
    parts = run_chunks(
        lambda rows: _as_arrays(make(alpha1[rows])),
        slices,
        checkpoint=checkpoint,
        sizes=[(rows.stop - rows.start) * cells_per_row for rows in slices],
        label=label,
    )
    return join([_as_dataset(part) for part in parts])


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


def _as_arrays(dataset: xr.Dataset) -> Arrays:
    arrays = {str(name): variable.values for name, variable in dataset.variables.items()}
    return {**arrays, ATTRIBUTES: np.array(json.dumps(dataset.attrs, default=_plain))}


def _as_dataset(arrays: Arrays) -> xr.Dataset:
    attributes = json.loads(str(arrays[ATTRIBUTES]))
    schema = find(attributes["schema"])
    return build(
        schema,
        {name: values for name, values in arrays.items() if name in schema.variables},
        {name: values for name, values in arrays.items() if name in schema.coordinates},
        {key: value for key, value in attributes.items() if key not in OWN_ATTRIBUTES},
    )


def _plain(value: object) -> object:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"attribute {value!r} is no plain value")
