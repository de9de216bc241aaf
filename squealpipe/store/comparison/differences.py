"""How one variable of two datasets differs, judged by the tolerance that its schema states."""

from collections import Counter
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
import xarray as xr
from scipy.stats import ks_2samp

from squealpipe.schema import Variable, flag_table
from squealpipe.schema.agreement import ComparedAs, RoundOff

SMALLEST_CHANCE = 1e-6
"""Two samples of one distribution are taken for different ones at this probability or less."""
LONGEST = 60
"""Characters of a text that an account of flips quotes."""


class Agreement(IntEnum):
    """Ordered: the verdict on a whole is the largest of its parts."""

    equal = 0
    within_tolerance = 1
    different = 2
    not_comparable = 3


@dataclass(frozen=True, kw_only=True)
class VariableDifference:
    """Where and by how much a variable differs.

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
        return self.verdict, self.differing / max(self.compared, 1), self.largest_relative


def difference(name: str, a: xr.DataArray, b: xr.DataArray, entry: Variable) -> VariableDifference:
    """Compare one variable of two aligned datasets."""
    if a.shape != b.shape:
        lengths = ", ".join(
            f"{a.sizes[dim]} against {b.sizes[dim]} along {dim}"
            for dim in map(str, a.dims)
            if dim in b.sizes and a.sizes[dim] != b.sizes[dim]
        )
        return VariableDifference(
            name=name,
            verdict=Agreement.different,
            volatile=entry.volatile,
            reason=f"lists of different length: {lengths or f'{a.dims} against {b.dims}'}",
        )
    if entry.round_off is not None and entry.round_off.compared is ComparedAs.sample:
        return _sampled(name, a, b, entry, entry.round_off)
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
    if entry.round_off is not None and entry.round_off.compared is ComparedAs.magnitude:
        close |= _same_magnitude(a, b, entry.round_off)
    finite = np.isfinite(a) & np.isfinite(b)
    return np.asarray(~(same | (close & finite)))


def _same_magnitude(a: np.ndarray, b: np.ndarray, how: RoundOff) -> np.ndarray:
    sizes = [np.maximum(np.abs(side), how.floor) for side in (a, b)]
    with np.errstate(invalid="ignore", over="ignore"):
        return np.asarray(np.maximum(*sizes) <= how.factor * np.minimum(*sizes))


def _sampled(
    name: str, a: xr.DataArray, b: xr.DataArray, entry: Variable, how: RoundOff
) -> VariableDifference:
    """Both sides as samples along one dimension, by the test of Kolmogorov and Smirnov.

    What did not end in time (NaN) counts as longer than all others.
    """
    left, right = (side.transpose(..., how.sample).values.astype(float) for side in (a, b))
    rows = [side.reshape(-1, side.shape[-1]) for side in (left, right)]
    filled = [np.nan_to_num(side, nan=np.inf, posinf=np.inf) for side in rows]
    chances = np.array([ks_2samp(x, y).pvalue for x, y in zip(*filled, strict=True)])
    unlikely = chances <= SMALLEST_CHANCE
    equal = np.array_equal(left, right, equal_nan=True)
    verdict = Agreement.different if unlikely.any() else Agreement.within_tolerance
    rest = a.isel({how.sample: 0})
    return VariableDifference(
        name=name,
        verdict=Agreement.equal if equal else verdict,
        compared=len(chances),
        differing=int(unlikely.sum()),
        where=_place(rest, int(chances.argmin())) if chances.size and not equal else {},
        volatile=entry.volatile,
        compared_as=how.compared.value,
        reason=""
        if equal
        else f"{len(chances)} samples along {how.sample}, smallest chance that both are "
        f"of one distribution {chances.min(initial=1.0):.2g}",
    )


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
        verdict=Agreement.different if count else Agreement.equal,
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
        verdict = Agreement.equal
    else:
        verdict = Agreement.different if differing.any() else Agreement.within_tolerance
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
        where=_place(a, worst) if verdict != Agreement.equal else {},
        rtol=entry.rtol,
        atol=entry.atol,
        volatile=entry.volatile,
        compared_as="" if entry.round_off is None else entry.round_off.compared.value,
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
