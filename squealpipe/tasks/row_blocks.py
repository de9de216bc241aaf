"""Big maps in blocks of rows: each block is a map of its own, and together they are the map.

A cell of a map does not know its neighbours, so the joined map equals the map made at once bit
for bit, whether the blocks ran one after the other, were resumed after a kill, or came from
several machines.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr

from squealpipe.schema import build, find
from squealpipe.store.chunks import Arrays, Checkpoint, run_chunks

BLOCK = 16_384
"""Cells in a block: about a third of a second of work, far more than starting one costs."""

ATTRIBUTES = "attributes_as_json"
OWN_ATTRIBUTES = frozenset({"Conventions", "title", "schema", "schema_version"})


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


def join(parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """One map from its blocks of rows, in order.

    Raises:
        ValueError: there are none, or they are not of one kind and grid.
    """
    if not parts:
        raise ValueError("no parts to join")
    first = parts[0]
    schema = find(str(first.attrs["schema"]))
    for part in parts[1:]:
        same_kind = part.attrs["schema"] == first.attrs["schema"]
        if not same_kind or not np.array_equal(part.alpha2, first.alpha2):
            raise ValueError("the parts are not blocks of rows of one map")
    arrays = {}
    for name, variable in first.variables.items():
        if "alpha1" in variable.dims:
            axis = variable.dims.index("alpha1")
            arrays[str(name)] = np.concatenate([part[name].values for part in parts], axis=axis)
        else:
            arrays[str(name)] = variable.values
    attributes = {key: first.attrs[key] for key in first.attrs if key not in OWN_ATTRIBUTES}
    data = {name: arrays[name] for name in arrays if name in schema.variables}
    coordinates = {name: arrays[name] for name in arrays if name in schema.coordinates}
    return build(schema, data, coordinates, attributes)


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
