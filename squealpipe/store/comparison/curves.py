"""Compare points of a curve with another curve that has its points elsewhere.

Idea: step control moves the points of a branch along it without moving the branch. A point without
a counterpart is therefore compared with the cubic through the four nearest points of the other
curve, and may be off by what that cubic is uncertain by: its difference from the parabolas through
three of them. Labels and counts have no values in between and have to be those of a neighbour.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy
import xarray as xr

from squealpipe.schema import DatasetSchema, Variable
from squealpipe.store.comparison.differences import Agreement, VariableDifference
from squealpipe.systems.datasets.agreement import Listing


@dataclass(frozen=True)
class _Column:
    """One number at each point of both curves."""

    name: str
    entry: Variable
    left: np.ndarray
    right: np.ndarray

    @property
    def extent(self) -> float:
        """Range of the finite values of both sides; 1 where there is none."""
        both = np.concatenate([self.left, self.right])
        finite = both[np.isfinite(both)]
        return float(np.ptp(finite)) or 1.0 if finite.size else 1.0

    @property
    def jumps(self) -> bool:
        """Return whether the column is a label or a count, which has no values between its
        neighbours'.
        """
        return self.entry.flags is not None or self.entry.stored.kind != "f"

    @property
    def places(self) -> bool:
        """Return whether the column tells where on the curve a point lies."""
        both = np.concatenate([self.left, self.right])
        # several numbers a point, such as multipliers, may meet and change places
        if self.jumps or len(self.entry.dims) > 1 or not np.isfinite(both).all():
            return False
        # what is the same all along, but for round-off, says nothing
        allowed = self.entry.atol + self.entry.rtol * float(
            np.abs(both).max(initial=0.0)
        )
        return float(np.ptp(both)) > 10 * allowed


def beside_the_curve(
    a: xr.Dataset,
    b: xr.Dataset,
    dim: str,
    how: Listing,
    schema: DatasetSchema,
    unmatched: tuple[np.ndarray, np.ndarray],
) -> list[VariableDifference]:
    """Return how far points without a counterpart lie from the other side's curve, by variable.

    The curve is the cubic through the four points of the other side around the nearest place. Its
    error is taken for twice the difference from the parabolas through three of them, and for no
    more than 1 % of the extent. Several numbers a point, such as multipliers, meet and change
    places between points: these are compared at shared points alone.

    Args:
        unmatched: places of such points along ``dim`` on both sides.
    """
    columns = list(_columns(a, b, dim, schema, skipped={*how.kinds, dim}))
    distances: dict[str, VariableDifference] = {}
    for swapped, points in zip((False, True), unmatched, strict=True):
        sides = (b, a) if swapped else (a, b)
        for place in points.tolist():
            nodes = _same_curve(sides, how, place)
            for column in columns:
                distances.setdefault(
                    column.name,
                    VariableDifference(
                        name=f"{column.name} between points",
                        verdict=Agreement.within_tolerance,
                    ),
                )
            for name, gap, allowed in _gaps(columns, place, nodes, swapped=swapped):
                distances[name] = _with_gap(distances[name], gap, allowed, dim, place)
    return list(distances.values())


def _columns(
    a: xr.Dataset, b: xr.Dataset, dim: str, schema: DatasetSchema, skipped: set[str]
) -> Iterator[_Column]:
    for name, entry in {**schema.coordinates, **schema.variables}.items():
        both = name in a.variables and name in b.variables
        if not both or name in skipped or entry.volatile or entry.round_off is not None:
            continue
        if a[name].dims != (dim,) or b[name].dims != (dim,):
            continue
        left, right = a[name].values, b[name].values
        if left.dtype.kind in "biuf" and right.dtype.kind in "biuf":
            yield _Column(name, entry, left.astype(float), right.astype(float))


def _same_curve(
    sides: tuple[xr.Dataset, xr.Dataset], how: Listing, place: int
) -> np.ndarray:
    """Points of the other side on the curve of one point: with further kinds, those of its own."""
    own, other = sides
    same = np.ones(other[how.kinds[0]].size, bool)
    if len(how.kinds) > 1:
        for name in how.kinds:
            same &= other[name].values == own[name].values[place]
    return np.flatnonzero(same)


def _gaps(
    columns: list[_Column], place: int, nodes: np.ndarray, *, swapped: bool
) -> Iterator[tuple[str, float, float]]:
    """Name, difference from the curve and what is allowed, for each column at one point."""
    point = np.array([(c.right if swapped else c.left)[place] for c in columns])
    curve = np.array([(c.left if swapped else c.right)[nodes] for c in columns])
    extents = np.array([column.extent for column in columns])
    placing = np.array([column.places for column in columns])
    if not nodes.size or not placing.any():
        yield from ((column.name, np.inf, 0.0) for column in columns)
        return
    line = curve[placing] / extents[placing, None]
    # a point that stands twice, as a special one may, is one node
    distinct = np.append(True, (np.diff(line) != 0.0).any(axis=0))
    curve, line = curve[:, distinct], line[:, distinct]
    at = _nearest_place(line, point[placing] / extents[placing])
    # what is not finite is compared with its neighbours
    with np.errstate(invalid="ignore"):
        cubic, error, around = _interpolated(curve, line, at)
        # errors of the columns by which the place was found move it along the curve
        chord = np.abs(around[:, -1] - around[:, 0])
        length = np.linalg.norm((chord / extents)[placing])
        moved = np.linalg.norm((error / extents)[placing]) / length if length else 0.0
        error = 2 * (error + chord * moved)
    # an interpolation's own error is allowed for up to 1 % of the variable's extent
    most_off = 0.01
    for column, value, curved, off, near, extent in zip(
        columns, point, cubic, error, around, extents, strict=True
    ):
        if column.jumps or not np.isfinite(near).all():
            same = any(_equal(value, each, column.entry) for each in near)
            yield column.name, 0.0 if same else np.inf, 0.0
            continue
        allowed = column.entry.atol + column.entry.rtol * max(abs(value), abs(curved))
        yield column.name, abs(value - curved), allowed + min(off, most_off * extent)


def _equal(one: float, other: float, entry: Variable) -> bool:
    allowed = 0.0 if entry.flags is not None else entry.atol + entry.rtol * abs(one)
    return (
        one == other
        or (np.isnan(one) and np.isnan(other))
        or abs(one - other) <= allowed
    )


def _nearest_place(line: np.ndarray, point: np.ndarray) -> float:
    """Place of the curve nearest to a point: 2.25 is a quarter behind the third node."""
    if line.shape[1] == 1:
        return 0.0
    start, step = line[:, :-1].T, np.diff(line).T
    length = np.maximum((step**2).sum(1), np.finfo(float).tiny)
    share = np.clip(((point - start) * step).sum(1) / length, 0.0, 1.0)
    distance = ((point - start - share[:, None] * step) ** 2).sum(1)
    segment = int(distance.argmin())

    def squared_distance(at: float) -> float:
        return float(((_interpolated(line, line, at)[0] - point) ** 2).sum())

    low, high = max(segment - 0.5, 0.0), min(segment + 1.5, line.shape[1] - 1.0)
    refined = scipy.optimize.minimize_scalar(
        squared_distance, bounds=(low, high), method="bounded", options={"xatol": 1e-12}
    )
    choices = [
        float(refined.x),
        segment + float(share[segment]),
        float(segment),
        segment + 1.0,
    ]
    return min(choices, key=squared_distance)


def _interpolated(
    values: np.ndarray, line: np.ndarray, at: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values at a place of a curve, the estimated error, and values at the nodes around it."""
    number = line.shape[1]
    segment = min(int(at), max(number - 2, 0))
    around = values[:, segment : segment + 2]
    if number < 2:
        return values[:, 0], np.zeros(len(values)), around
    first = min(max(segment - 1, 0), max(number - 4, 0))
    used = slice(first, first + 4)
    # nodes at the lengths of their chords, so that steps of any size make one smooth curve
    chords = np.sqrt((np.diff(line[:, used]) ** 2).sum(0))
    knots = np.concatenate([[0.0], np.cumsum(np.maximum(chords, 1e-300))])
    inside = segment - first
    place = knots[inside] + (at - segment) * (knots[inside + 1] - knots[inside])
    shares = np.array([1 - (at - segment), at - segment])
    interpolated = partial(scipy.interpolate.krogh_interpolate, x=place, axis=1)
    curved = interpolated(knots, values[:, used])
    simpler = [around @ shares]
    if knots.size == 4:
        parts = (slice(0, 3), slice(1, 4))
        simpler = [
            interpolated(knots[part], values[:, used][:, part]) for part in parts
        ]
    error = np.max([np.abs(curved - each) for each in simpler], axis=0)
    return curved, error, around


def _with_gap(
    so_far: VariableDifference, gap: float, allowed: float, dim: str, place: int
) -> VariableDifference:
    """An account with one more point."""
    beyond = not gap <= allowed
    worst = gap > so_far.largest_absolute or (beyond and not so_far.differing)
    return VariableDifference(
        name=so_far.name,
        verdict=Agreement.different if beyond else so_far.verdict,
        compared=so_far.compared + 1,
        differing=so_far.differing + beyond,
        largest_absolute=max(so_far.largest_absolute, gap if np.isfinite(gap) else 0.0),
        where={dim: place} if worst else so_far.where,
        compared_as="the distance from the other curve",
    )
