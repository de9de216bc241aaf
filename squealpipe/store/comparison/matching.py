"""Two datasets brought onto what they share: grid points by value, entries of lists by meaning."""

from collections.abc import Iterable

import numpy as np
import pandas as pd
import xarray as xr

from squealpipe.schema import DatasetSchema
from squealpipe.schema.agreement import Listing
from squealpipe.schema.sweep import RAGGED

SAME_PLACE = 1e-9
"""Positions of filling entries of a list that differ by less, relative, are the same."""
ALIGNED = 1e-9
"""Grid points that differ by less, relative to the extent of the grid, are the same point."""


def align(
    a: xr.Dataset, b: xr.Dataset, schema: DatasetSchema | None = None
) -> tuple[xr.Dataset, xr.Dataset, list[str]]:
    """Both datasets on what they share, and notes on what was left out."""
    notes = []
    lists = {} if schema is None else schema.lists
    for dim in sorted(map(str, set(a.dims) & set(b.dims))):
        if dim in lists:
            a, b, note = match(a, b, dim, lists[dim])
        elif all(each[dim].dims == (dim,) and dim in each.coords for each in (a, b)):
            a, b, note = on_shared_points(a, b, dim)
        else:
            a, b, note = _cut(a, b, dim)
        notes.extend(note)
    return a, b, notes


def match(
    a: xr.Dataset, b: xr.Dataset, dim: str, how: Listing
) -> tuple[xr.Dataset, xr.Dataset, list[str]]:
    """Entries of a list that mean the same, in the first one's order."""
    sizes = a.sizes[dim], b.sizes[dim]
    kinds = _kinds(a, dim, how.kinds), _kinds(b, dim, how.kinds)
    if sizes[0] == sizes[1] and kinds[0] == kinds[1] and how.filler is None:
        return a, b, []
    at_a: list[int] = []
    at_b: list[int] = []
    for kind in dict.fromkeys(kinds[0]):
        places = [np.flatnonzero([item == kind for item in side]) for side in kinds]
        positions = _positions(a, how, dim, places[0]), _positions(b, how, dim, places[1])
        found = _pairs(*positions)
        if kind and kind[0] == how.filler:
            found = [
                (i, j)
                for i, j in found
                if abs(positions[0][i] - positions[1][j]) <= SAME_PLACE * abs(positions[0][i])
            ]
        at_a.extend(places[0][[pair[0] for pair in found]])
        at_b.extend(places[1][[pair[1] for pair in found]])
    order = np.argsort(at_a, kind="stable").astype(int)
    first, second = np.asarray(at_a, int)[order], np.asarray(at_b, int)[order]
    by = how.position or ("kind and order" if how.kinds else "order")
    note = f"{dim}: {len(first)} of {sizes[0]} and {sizes[1]} matched by {by}"
    a, b = a.isel({dim: first}), b.isel({dim: second})
    if dim in a.coords and dim in b.coords and a[dim].dims == (dim,):
        b = b.assign_coords({dim: a[dim].variable})
    return a, b, [note] if max(sizes) > len(first) else []


def judged_length(dataset: xr.Dataset, dim: str, how: Listing) -> int | None:
    """Number of entries whose number is a result; None without the dimension."""
    if dim not in dataset.sizes or how.filler is None:
        return int(dataset.sizes[dim]) if dim in dataset.sizes else None
    labels = dataset[how.kinds[0]].values
    return int((labels != how.filler).sum())


def _kinds(dataset: xr.Dataset, dim: str, names: Iterable[str]) -> list[tuple]:
    columns = [dataset[name].values.tolist() for name in names]
    return list(zip(*columns, strict=True)) if columns else [()] * dataset.sizes[dim]


def _positions(dataset: xr.Dataset, how: Listing, dim: str, places: np.ndarray) -> np.ndarray:
    if not how.position:
        return np.arange(len(places), dtype=float)
    values = dataset[how.position].isel({dim: places}).values.astype(float)
    return np.where(np.isfinite(values), values, np.inf)


def _pairs(left: np.ndarray, right: np.ndarray) -> list[tuple[int, int]]:
    """Entries that are each other's nearest."""
    if not left.size or not right.size:
        return []
    with np.errstate(invalid="ignore"):
        distance = np.abs(left[:, None] - right[None, :])
    distance = np.where(np.isnan(distance), np.inf, distance)
    of_left, of_right = distance.argmin(axis=1), distance.argmin(axis=0)
    return [(int(i), int(j)) for i, j in enumerate(of_left) if of_right[j] == i]


def on_shared_points(
    a: xr.Dataset, b: xr.Dataset, dim: str
) -> tuple[xr.Dataset, xr.Dataset, list[str]]:
    """Both datasets on the points of one grid that they share, and a note on what was left out."""
    left, right = a[dim].values, b[dim].values
    if left.shape == right.shape and np.array_equal(left, right):
        return a, b, []
    at_left, at_right = _shared(left, right)
    if len(at_left) < min(2, len(left), len(right)) or not len(at_left):
        raise ValueError(
            f"the grids of {dim} share {len(at_left)} of {len(left)} and {len(right)} points; "
            "compute both on grids of which one holds the other"
        )
    a, b = a.isel({dim: at_left}), b.isel({dim: at_right})
    if len(at_left) == max(len(left), len(right)):
        return a, b, []
    return (
        a,
        b,
        [f"{dim}: compared on {len(at_left)} shared points of {len(left)} and {len(right)}"],
    )


def _cut(a: xr.Dataset, b: xr.Dataset, dim: str) -> tuple[xr.Dataset, xr.Dataset, list[str]]:
    """Lists in a sweep have their lengths beside them; here each is compared by order."""
    sizes = a.sizes[dim], b.sizes[dim]
    if dim not in RAGGED or sizes[0] == sizes[1]:
        return a, b, []
    cut = slice(min(sizes))
    note = f"{dim}: the first {min(sizes)} of up to {sizes[0]} and {sizes[1]} compared by order"
    return a.isel({dim: cut}), b.isel({dim: cut}), [note]


def _shared(left: np.ndarray, right: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the points that two one-dimensional grids have in common."""
    if left.dtype.kind not in "fiu" or right.dtype.kind not in "fiu":
        _, at_left, at_right = np.intersect1d(left, right, return_indices=True)
        order = np.argsort(at_left)
        return at_left[order], at_right[order]
    close = ALIGNED * max((np.ptp(side) for side in (left, right) if side.size), default=0.0)
    points, order = np.unique(right.astype(float), return_index=True)  # a point may be there twice
    nearest = pd.Index(points).get_indexer(left.astype(float), method="nearest", tolerance=close)
    return np.flatnonzero(nearest >= 0), order[nearest[nearest >= 0]]
