"""Bring two datasets onto what they share: grid points by value, entries of lists by meaning.

Idea: a map on a finer grid has the points of a coarser one, and a branch has its folds wherever
step control put other points. So dimensions with units are matched by value within round-off, and
entries of lists by the kind that the schema names, each with the nearest of its kind on the other
side. Invariant: each point is used once, and what has no partner is noted.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from squealpipe.schema import DatasetSchema
from squealpipe.systems.datasets.agreement import RAGGED, Listing


@dataclass(frozen=True)
class Aligned:
    """Two datasets on what they share, with equal order of dimensions.

    Attributes:
        notes: what was left out.
        alone: dimension that lists what was found → places of entries that no other one matches.
    """

    a: xr.Dataset
    b: xr.Dataset
    notes: list[str]
    alone: dict[str, tuple[np.ndarray, np.ndarray]]


def align(a: xr.Dataset, b: xr.Dataset, schema: DatasetSchema | None = None) -> Aligned:
    """Both datasets on what they share: by the names of dimensions, and along these by values."""
    notes: list[str] = []
    alone = {}
    lists = {} if schema is None else schema.lists
    if schema is not None:
        a, b, notes = _judged_part(a, b, schema)
    order = list(dict.fromkeys([*a.dims, *b.dims]))
    a, b = (each.transpose(*order, missing_dims="ignore") for each in (a, b))
    for dim in sorted(map(str, set(a.dims) & set(b.dims))):
        if dim in lists and all(
            name in each.variables for name in lists[dim].kinds for each in (a, b)
        ):
            at, note = match(a, b, dim, lists[dim])
            if at:
                alone[dim] = (
                    np.setdiff1d(np.arange(a.sizes[dim]), at[0]),
                    np.setdiff1d(np.arange(b.sizes[dim]), at[1]),
                )
        elif all(each[dim].dims == (dim,) and dim in each.coords for each in (a, b)):
            at, note = on_shared_points(a[dim].values, b[dim].values, dim)
        elif dim in RAGGED and a.sizes[dim] != b.sizes[dim]:
            # lists in a sweep have their lengths beside them; here each is compared by order
            sizes = a.sizes[dim], b.sizes[dim]
            at = [np.arange(min(sizes))] * 2
            note = (
                f"{dim}: the first {min(sizes)} of up to {sizes[0]} and {sizes[1]} "
                "compared by order"
            )
        else:
            continue
        if at:
            a, b = a.isel({dim: at[0]}), b.isel({dim: at[1]})
        if (
            dim in lists
            and dim in a.coords
            and dim in b.coords
            and a[dim].dims == (dim,)
        ):
            b = b.assign_coords({dim: a[dim].variable})
        notes += [note] if note else []
    return Aligned(a, b, notes, alone)


def _judged_part(
    a: xr.Dataset, b: xr.Dataset, schema: DatasetSchema
) -> tuple[xr.Dataset, xr.Dataset, list[str]]:
    """Return both datasets at the entries that a comparison judges, and notes on the others."""
    notes = []
    for dim, (name, value) in schema.judged.items():
        if not all(name in each.variables for each in (a, b)):
            continue
        left_out = [str(v) for v in a[dim].values[a[name].values != value]]
        a, b = (each.isel({dim: each[name].values == value}) for each in (a, b))
        notes += [f"{dim}: not judged: {', '.join(left_out)}"] if left_out else []
    return a, b, notes


def match(
    a: xr.Dataset, b: xr.Dataset, dim: str, how: Listing
) -> tuple[list[np.ndarray], str]:
    """Places of entries of a list that mean the same, in the first one's order; and a note."""
    sizes = a.sizes[dim], b.sizes[dim]
    kinds = [
        list(zip(*(each[name].values.tolist() for name in how.kinds), strict=True))
        or [()] * each.sizes[dim]
        for each in (a, b)
    ]
    if sizes[0] == sizes[1] and kinds[0] == kinds[1] and not how.fillers:
        return [], ""
    pairs: list[tuple[int, int]] = []
    for fromkey in dict.fromkeys(kinds[0]):
        places = [np.flatnonzero([item == fromkey for item in side]) for side in kinds]
        fills = fromkey[:1] and fromkey[0] in how.fillers
        if not fills and len(places[0]) == len(places[1]):
            pairs += zip(*(each.tolist() for each in places), strict=True)
            continue
        left, right = (
            _positions(each, how, dim, at)
            for each, at in zip((a, b), places, strict=True)
        )
        # positions closer than this, relative, differ by round-off alone
        pairs += [
            (int(places[0][i]), int(places[1][j]))
            for i, j in _nearest_of_each_other(left, right)
            if not fills
            or abs(left[i] - right[j]) <= 1e-9 * max(abs(left[i]), abs(right[j]))
        ]
    at = np.array(sorted(pairs), int).reshape(-1, 2)
    by = how.position or ("kind and order" if how.kinds else "order")
    note = f"{dim}: {len(at)} of {sizes[0]} and {sizes[1]} matched by {by}"
    return [*at.T], note if max(sizes) > len(at) else ""


def is_filler(dataset: xr.Dataset, how: Listing, dim: str) -> np.ndarray:
    """Return which entries of a list lie where a method's steps happened to end."""
    if not how.fillers:
        return np.zeros(dataset.sizes[dim], bool)
    return np.isin(dataset[how.kinds[0]].values, how.fillers)


def _positions(
    dataset: xr.Dataset, how: Listing, dim: str, places: np.ndarray
) -> np.ndarray:
    along = dataset.get(how.position) if how.position else None
    if along is not None and along.dtype.kind in "OU":
        along = dataset.get(str(along[0].item()))
    if along is None:  # without the variable the n-th is matched with the n-th
        return np.arange(len(places), dtype=float)
    values = along.isel({dim: places}).values.astype(float)
    return np.where(np.isfinite(values), values, np.inf)


def _nearest_of_each_other(
    left: np.ndarray, right: np.ndarray
) -> list[tuple[int, int]]:
    if not left.size or not right.size:
        return []
    with np.errstate(invalid="ignore"):
        distance = np.abs(left[:, None] - right[None, :])
    distance = np.where(np.isnan(distance), np.inf, distance)
    of_left, of_right = distance.argmin(axis=1), distance.argmin(axis=0)
    return [(int(i), int(j)) for i, j in enumerate(of_left) if of_right[j] == i]


def on_shared_points(
    left: np.ndarray, right: np.ndarray, dim: str
) -> tuple[list[np.ndarray], str]:
    """Places of the points that two one-dimensional grids have in common, and a note."""
    if np.array_equal(left, right):
        return [], ""
    at = _pairs_of_points(left, right)
    shared, sizes = len(at[0]), (len(left), len(right))
    if shared < min(2, *sizes) or not shared:
        raise ValueError(
            f"the grids of {dim} share {shared} of {sizes[0]} and {sizes[1]} points; "
            "compute both on grids of which one holds the other"
        )
    note = f"{dim}: compared on {shared} shared points of {sizes[0]} and {sizes[1]}"
    return at, note if shared < max(sizes) else ""


def _pairs_of_points(left: np.ndarray, right: np.ndarray) -> list[np.ndarray]:
    """Places of equal points, each used once, in the order of the first grid."""
    numbers = left.dtype.kind in "fiu" and right.dtype.kind in "fiu"
    tolerance = 0.0
    if numbers:
        extent = max((np.ptp(side) for side in (left, right) if side.size), default=0.0)
        # grid points closer than this, over the extent of the grid, are the same point
        tolerance = 1e-9 * float(extent)
    else:
        left, right = left.astype(str), right.astype(str)
    orders = np.argsort(left, kind="stable"), np.argsort(right, kind="stable")
    one, other, pairs = 0, 0, []
    while one < len(left) and other < len(right):
        x, y = left[orders[0][one]], right[orders[1][other]]
        if x == y or (numbers and abs(float(x) - float(y)) <= tolerance):
            pairs.append((orders[0][one], orders[1][other]))
            one, other = one + 1, other + 1
        elif x < y:
            one += 1
        else:
            other += 1
    return [*np.array(sorted(pairs), int).reshape(-1, 2).T]
