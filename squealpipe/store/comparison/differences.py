"""Differences of one variable of two datasets, judged by the tolerance that its schema states."""

from collections import Counter
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Any

import numpy as np
import scipy
import xarray as xr

from squealpipe.schema import Outcome, Variable, flag_table
from squealpipe.systems.datasets.agreement import ComparedAs, RoundOff

SMALLEST_CHANCE = 1e-6
"""Two samples of one distribution are taken for different ones at this probability or less."""


class Agreement(IntEnum):
    """Ordered: the verdict on a whole is the largest of its parts."""

    equal = 0
    within_tolerance = 1
    different = 2
    not_comparable = 3


@dataclass(frozen=True, kw_only=True)
class VariableDifference:
    """Difference of one variable: where, and by how much.

    Attributes:
        verdict: equal, within tolerance, different; not judged further if volatile.
        largest_absolute, largest_relative: largest differences; 0 where all are equal.
        where: coordinate → value at the largest absolute difference.
        flips: "a → b" → count, for flags.
        compared_as: what was compared where round-off decides the digits; empty: the values.
        reason: in words, where numbers do not say it.
    """

    name: str
    verdict: Agreement
    compared: int = 0
    differing: int = 0
    largest_absolute: float = 0.0
    largest_relative: float = 0.0
    where: dict[str, float | int | str] = field(default_factory=dict)
    flips: dict[str, int] = field(default_factory=dict)
    rtol: float = 0.0
    atol: float = 0.0
    volatile: bool = False
    compared_as: str = ""
    reason: str = ""

    @property
    def severity(self) -> tuple[int, float, float]:
        """Larger is worse: verdict, share of values that differ, largest relative difference."""
        return (
            self.verdict,
            self.differing / max(self.compared, 1),
            self.largest_relative,
        )


def judge(
    name: str, a: xr.Dataset, b: xr.Dataset, entry: Variable
) -> VariableDifference:
    """Compare one variable of two aligned datasets, as its line in the schema says."""
    how = entry.round_off
    if how is None or how.compared in (ComparedAs.magnitude, ComparedAs.sample):
        return difference(name, a[name], b[name], entry)
    entry = replace(entry, round_off=None)
    stated = how.by in a.variables and how.by in b.variables
    if (
        how.compared is ComparedAs.beyond_horizon
        and stated
        and a[name].dims == a[how.by].dims
    ):
        return _beyond_horizon(name, a, b, entry, how)
    if how.compared is ComparedAs.judged and a[name].shape == b[name].shape:
        left, right = a[name].values, b[name].values
        unjudged = (left == how.none) | (right == how.none)
        matched = b[name].copy(data=np.where(unjudged, left, right))
        return difference(name, a[name], matched, entry)
    if how.compared is ComparedAs.grown and stated:
        size = max(
            float(np.abs(side[name]).max()) if side[name].size else 0.0
            for side in (a, b)
        )
        growth = max(float(a[how.by]), float(b[how.by]), 1.0)
        # growth begins at fifty units of round-off, relative to the size of the motion
        entry = replace(entry, atol=entry.atol + 1e-14 * growth * size)
    judged = difference(name, a[name], b[name], entry)
    allowed = {ComparedAs.unjudged: 1.0, ComparedAs.most: how.share}.get(
        how.compared, 0.0
    )
    if (
        judged.verdict == Agreement.different
        and judged.differing <= allowed * judged.compared
    ):
        return replace(judged, verdict=Agreement.within_tolerance, reason=how.reason)
    return judged


def difference(
    name: str, a: xr.DataArray, b: xr.DataArray, entry: Variable
) -> VariableDifference:
    """Compare one variable of two aligned datasets by its values."""
    if a.shape != b.shape:
        lengths = ", ".join(
            f"{a.sizes[dim]} against {b.sizes[dim]} along {dim}"
            for dim in map(str, a.dims)
            if dim in b.sizes and a.sizes[dim] != b.sizes[dim]
        )
        found: dict[str, Any] = {
            "verdict": Agreement.different,
            "reason": f"lists of different length: {lengths or f'{a.dims} against {b.dims}'}",
        }
    elif entry.round_off is not None and entry.round_off.compared is ComparedAs.sample:
        found = _sampled(a, b, entry.round_off)
    elif _discrete(a.values, b.values, entry):
        found = _flipped(a, b, entry)
    else:
        found = _continuous(a, b, entry)
    return VariableDifference(name=name, volatile=entry.volatile, **found)


def outside_tolerance(a: np.ndarray, b: np.ndarray, entry: Variable) -> np.ndarray:
    """Return where two arrays differ by more than the schema allows; NaN equals NaN only."""
    if _discrete(a, b, entry):
        return np.asarray(a != b)
    with np.errstate(invalid="ignore", over="ignore"):
        close = np.abs(a - b) <= entry.atol + entry.rtol * np.maximum(
            np.abs(a), np.abs(b)
        )
        if (
            entry.round_off is not None
            and entry.round_off.compared is ComparedAs.magnitude
        ):
            sizes = [np.maximum(np.abs(side), entry.round_off.floor) for side in (a, b)]
            close |= np.maximum(*sizes) <= entry.round_off.factor * np.minimum(*sizes)
    return np.asarray(~(_same(a, b) | (close & np.isfinite(a) & np.isfinite(b))))


def _discrete(a: np.ndarray, b: np.ndarray, entry: Variable) -> bool:
    return entry.flags is not None or {a.dtype.kind, b.dtype.kind}.isdisjoint("fc")


def _same(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray((a == b) | (np.isnan(a) & np.isnan(b)))


def _sampled(a: xr.DataArray, b: xr.DataArray, how: RoundOff) -> dict[str, Any]:
    """Both sides as samples along one dimension, by the test of Kolmogorov and Smirnov.

    What did not end in time (NaN) counts as longer than all others.
    """
    sides = [side.transpose(..., how.sample).values.astype(float) for side in (a, b)]
    rows = [np.nan_to_num(side, nan=np.inf, posinf=np.inf) for side in sides]
    rows = [side.reshape(-1, side.shape[-1]) for side in rows]
    chances = np.array(
        [scipy.stats.ks_2samp(x, y).pvalue for x, y in zip(*rows, strict=True)]
    )
    unlikely = int((chances <= SMALLEST_CHANCE).sum())
    numbers: dict[str, Any] = {
        "compared": len(chances),
        "differing": unlikely,
        "compared_as": how.compared.value,
    }
    if np.array_equal(sides[0], sides[1], equal_nan=True):
        return numbers | {"verdict": Agreement.equal}
    return numbers | {
        "verdict": Agreement.different if unlikely else Agreement.within_tolerance,
        "where": _place(a.isel({how.sample: 0}), int(chances.argmin()))
        if chances.size
        else {},
        "reason": f"{len(chances)} samples along {how.sample}, smallest chance that both are "
        f"of one distribution {chances.min(initial=1.0):.2g}",
    }


def _beyond_horizon(
    name: str, a: xr.Dataset, b: xr.Dataset, entry: Variable, how: RoundOff
) -> VariableDifference:
    """Cells that are predictable on both sides one by one, the others as one sample."""
    lost = sum(side[how.by].values == Outcome.beyond_horizon for side in (a, b)) > 0
    left, right = a[name].values, b[name].values
    late_difference = difference(
        name, a[name], b[name].copy(data=np.where(lost, left, right)), entry
    )
    samples = [
        np.nan_to_num(side[lost].astype(float), nan=np.inf) for side in (left, right)
    ]
    if np.array_equal(*samples):
        return late_difference
    chance = float(scipy.stats.ks_2samp(*samples, method="asymp").pvalue)
    verdict = (
        Agreement.different if chance <= SMALLEST_CHANCE else Agreement.within_tolerance
    )
    stated = (
        f"{int((samples[0] != samples[1]).sum())} of {lost.sum()} values beyond the predictability "
        f"horizon differ; chance that both are of one distribution {chance:.2g}"
    )
    return replace(
        late_difference,
        verdict=max(late_difference.verdict, verdict),
        compared_as=how.compared.value,
        reason="; ".join(filter(None, (late_difference.reason, stated))),
    )


def _flipped(a: xr.DataArray, b: xr.DataArray, entry: Variable) -> dict[str, Any]:
    differing = outside_tolerance(a.values, b.values, entry)
    count = int(differing.sum())
    words = {} if entry.flags is None else flag_table(entry.flags)
    flips = Counter(
        " → ".join(shortened(str(words.get(value, value)), 60) for value in pair)
        for pair in zip(
            a.values[differing].tolist(), b.values[differing].tolist(), strict=True
        )
    )
    return {
        "verdict": Agreement.different if count else Agreement.equal,
        "compared": a.size,
        "differing": count,
        "where": _place(a, int(differing.argmax())) if count else {},
        "flips": dict(flips.most_common(12)),
    }


def _continuous(a: xr.DataArray, b: xr.DataArray, entry: Variable) -> dict[str, Any]:
    left, right = (
        np.asarray(side.values, np.result_type(side.dtype, float)) for side in (a, b)
    )
    differing, same = outside_tolerance(left, right, entry), _same(left, right)
    numbers: dict[str, Any] = {
        "compared": left.size,
        "rtol": entry.rtol,
        "atol": entry.atol,
    }
    if entry.round_off is not None:
        numbers["compared_as"] = entry.round_off.compared.value
    if same.all():
        return numbers | {"verdict": Agreement.equal}
    with np.errstate(invalid="ignore", over="ignore"):
        gap = np.where(same, 0.0, np.abs(left - right))
    one_sided = ~np.isfinite(gap)
    gap[one_sided] = np.inf
    scale = np.maximum(np.abs(left), np.abs(right))
    relative = np.divide(
        gap, scale, out=np.zeros_like(gap), where=np.isfinite(gap) & (scale > 0)
    )
    return numbers | {
        "verdict": Agreement.different
        if differing.any()
        else Agreement.within_tolerance,
        "differing": int(differing.sum()),
        "largest_absolute": float(gap.max(where=~one_sided, initial=0.0)),
        "largest_relative": float(relative.max()),
        "where": _place(a, int(gap.argmax())),
        "reason": f"{one_sided.sum()} values are finite on one side only"
        if one_sided.any()
        else "",
    }


def shortened(text: str, width: int) -> str:
    """A text of at most so many characters."""
    return text if len(text) <= width else f"{text[: width - 1]}…"


def _place(array: xr.DataArray, flat: int) -> dict[str, float | int | str]:
    """Coordinate (or index, where there is none) of one value."""
    place: dict[str, float | int | str] = {}
    for dim, index in zip(array.dims, np.unravel_index(flat, array.shape), strict=True):
        coordinate = array.coords.get(dim)
        place[str(dim)] = (
            int(index) if coordinate is None else coordinate.values[index].item()
        )
    return place
