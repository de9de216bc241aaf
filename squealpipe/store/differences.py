"""How one variable of two datasets differs, judged by the tolerance that its schema states."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
import xarray as xr

from squealpipe.schema import Variable, flag_table

ALIGNED = 1e-9
"""Grid points that differ by less, relative to the extent of the grid, are the same point."""


LONGEST = 60
"""Characters of a text that an account of flips quotes."""


class Verdict(IntEnum):
    """Ordered: the verdict on a whole is the largest of its parts."""

    equal = 0
    within_tolerance = 1
    different = 2
    not_comparable = 3


@dataclass(frozen=True, kw_only=True)
class VariableDifference:
    """Where and by how much a variable differs.

    Attributes:
        name: of the variable.
        verdict: equal, within tolerance, different; not judged further if volatile.
        compared: number of values on both sides.
        differing: number of values outside the tolerance.
        largest_absolute, largest_relative: largest differences; 0 where all are equal.
        where: coordinate → value at the largest absolute difference.
        flips: "a → b" → count, for flags.
        rtol, atol: the schema's tolerance.
        volatile: differs by nature; no part of the verdict.
        reason: in words, where numbers do not say it.
    """

    name: str
    verdict: Verdict
    compared: int = 0
    differing: int = 0
    largest_absolute: float = 0.0
    largest_relative: float = 0.0
    where: dict[str, float | int | str] = field(default_factory=dict)
    flips: dict[str, int] = field(default_factory=dict)
    rtol: float = 0.0
    atol: float = 0.0
    volatile: bool = False
    reason: str = ""


def align(a: xr.Dataset, b: xr.Dataset) -> tuple[xr.Dataset, xr.Dataset, list[str]]:
    """Both datasets on the grid points that they share, and notes on what was left out.

    Dimensions without a coordinate (events, points of a branch) are lists, not grids: they stay.

    Raises:
        ValueError: a grid shares fewer than two points with the other.
    """
    notes = []
    for dim in sorted(map(str, set(a.dims) & set(b.dims))):
        if dim not in a.coords or dim not in b.coords:
            continue
        left, right = a[dim].values, b[dim].values
        if left.shape == right.shape and np.array_equal(left, right):
            continue
        at_left, at_right = _shared(left, right)
        if len(at_left) < min(2, len(left), len(right)) or not len(at_left):
            raise ValueError(
                f"the grids of {dim} share {len(at_left)} of {len(left)} and {len(right)} points; "
                "compute both on grids of which one holds the other"
            )
        a, b = a.isel({dim: at_left}), b.isel({dim: at_right})
        if len(at_left) < max(len(left), len(right)):
            notes.append(
                f"{dim}: compared on {len(at_left)} shared points of {len(left)} and {len(right)}"
            )
    return a, b, notes


def _shared(left: np.ndarray, right: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the points that two one-dimensional grids have in common."""
    if left.dtype.kind not in "fiu" or right.dtype.kind not in "fiu":
        _, at_left, at_right = np.intersect1d(left, right, return_indices=True)
        order = np.argsort(at_left)
        return at_left[order], at_right[order]
    extent = max(np.ptp(left), np.ptp(right)) if left.size and right.size else 0.0
    order = np.argsort(right, kind="stable")
    if not right.size:
        return np.array([], int), np.array([], int)
    place = np.clip(np.searchsorted(right[order], left), 1, max(len(right) - 1, 1))
    near = np.clip(np.stack([place - 1, place]), 0, len(right) - 1)
    distance = np.abs(right[order][near] - left)
    nearest = order[near[distance.argmin(axis=0), np.arange(len(left))]]
    close = distance.min(axis=0) <= ALIGNED * extent
    return np.flatnonzero(close), nearest[close]


def difference(name: str, a: xr.DataArray, b: xr.DataArray, entry: Variable) -> VariableDifference:
    """Compare one variable of two aligned datasets.

    Args:
        name: of the variable.
        a, b: both sides.
        entry: its line in the schema.
    """
    if a.shape != b.shape:
        lengths = ", ".join(
            f"{a.sizes[dim]} against {b.sizes[dim]} along {dim}"
            for dim in map(str, a.dims)
            if dim in b.sizes and a.sizes[dim] != b.sizes[dim]
        )
        return VariableDifference(
            name=name,
            verdict=Verdict.different,
            volatile=entry.volatile,
            reason=f"lists of different length: {lengths or f'{a.dims} against {b.dims}'}",
        )
    if entry.flags is not None or a.dtype.kind not in "fc":
        return _discrete(name, a, b, entry)
    return _continuous(name, a, b, entry)


def outside_tolerance(a: np.ndarray, b: np.ndarray, entry: Variable) -> np.ndarray:
    """Where two arrays differ by more than the schema allows; NaN equals NaN only."""
    if entry.flags is not None or a.dtype.kind not in "fc":
        return np.asarray(a != b)
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    with np.errstate(invalid="ignore", over="ignore"):
        close = np.abs(a - b) <= entry.atol + entry.rtol * np.maximum(np.abs(a), np.abs(b))
    finite = np.isfinite(a) & np.isfinite(b)
    return np.asarray(~(same | (close & finite)))


def _discrete(name: str, a: xr.DataArray, b: xr.DataArray, entry: Variable) -> VariableDifference:
    left, right = a.values, b.values
    differing = outside_tolerance(left, right, entry)
    count = int(differing.sum())
    meanings = {} if entry.flags is None else flag_table(entry.flags)
    flips = Counter(
        f"{_short(meanings.get(old, old))} → {_short(meanings.get(new, new))}"
        for old, new in zip(left[differing].tolist(), right[differing].tolist(), strict=True)
    )
    return VariableDifference(
        name=name,
        verdict=Verdict.different if count else Verdict.equal,
        compared=left.size,
        differing=count,
        where=_place(a, int(differing.argmax())) if count else {},
        flips=dict(flips.most_common(12)),
        volatile=entry.volatile,
    )


def _short(value: object) -> str:
    text = str(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def _continuous(name: str, a: xr.DataArray, b: xr.DataArray, entry: Variable) -> VariableDifference:
    left, right = a.values, b.values
    differing = outside_tolerance(left, right, entry)
    same = (left == right) | (np.isnan(left) & np.isnan(right))
    if same.all():
        verdict = Verdict.equal
    else:
        verdict = Verdict.different if differing.any() else Verdict.within_tolerance
    with np.errstate(invalid="ignore", over="ignore"):
        gap = np.where(same, 0.0, np.abs(left - right))
    one_sided = ~np.isfinite(gap)
    gap = np.where(one_sided, np.inf, gap)
    scale = np.maximum(np.abs(left), np.abs(right))
    relative = np.divide(gap, scale, out=np.zeros_like(gap), where=np.isfinite(gap) & (scale > 0))
    finite = np.where(one_sided, 0.0, gap)
    worst = int(gap.argmax()) if gap.size else 0
    return VariableDifference(
        name=name,
        verdict=verdict,
        compared=left.size,
        differing=int(differing.sum()),
        largest_absolute=float(finite.max(initial=0.0)),
        largest_relative=float(relative.max(initial=0.0)),
        where=_place(a, worst) if verdict != Verdict.equal else {},
        rtol=entry.rtol,
        atol=entry.atol,
        volatile=entry.volatile,
        reason=f"{int(one_sided.sum())} values are finite on one side only"
        if one_sided.any()
        else "",
    )


def _place(array: xr.DataArray, flat: int) -> dict[str, float | int | str]:
    """Coordinate (or index, where there is none) of one value."""
    place: dict[str, float | int | str] = {}
    for dim, index in zip(array.dims, np.unravel_index(flat, array.shape), strict=True):
        coordinate = array.coords.get(dim)
        place[str(dim)] = int(index) if coordinate is None else coordinate.values[index].item()
    return place
