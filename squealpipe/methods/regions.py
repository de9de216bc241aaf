"""Regions of the unit square from the curves that bound them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from squealpipe.methods.union_boundary import Front, Kind, Reached, Vector, bulge

FLAT = 1e-6
"""Distance of a polygon from an arc, over the side of the square."""
_ON_BORDER = 1e-9
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


class Curve(NamedTuple):
    """A piece of the boundary, the region below zero on its left.

    Attributes:
        points: in order; of a closed one the first does not come again.
        closed: whether it ends where it begins.
        gap: longest line that bridges what could not be followed.
    """

    points: list[Reached]
    closed: bool
    gap: float = 0.0

    def slopes(self) -> tuple[Vector, Vector]:
        """Slopes of the functions before and after each point, (points, 2)."""
        before = [p.heights.slope[p.other if p.kind == Kind.corner else p.on] for p in self.points]
        after = [p.heights.slope[p.on] for p in self.points]
        return np.array(before), np.array(after)


class Loop(NamedTuple):
    """A closed line around a region, counter-clockwise, or around a hole of it, clockwise.

    Attributes:
        vertices: points of arcs, and of the square's border.
        outline: with more points on long arcs, so that a polygon is within :data:`FLAT` of them.
        area: enclosed, negative for a hole, with the arcs' own bulges.
        error: of the area, from the shape of the arcs.
    """

    vertices: Vector
    outline: Vector
    area: float
    error: float


def link(fronts: Sequence[Front], back: Sequence[Front]) -> list[Curve]:
    """Curves of the fronts that go on from one another.

    Args:
        fronts: by the index of their start.
        back: traces against the orientation, from starts that no front leads to.
    """
    before = {id(front.start): front for front in back}
    left, curves, open_ends = dict(enumerate(fronts)), [], []
    led_to = {front.joins for front in fronts}
    for index in [*(i for i in left if i not in led_to), *left]:
        if index not in left:
            continue
        points: list[Reached] = []
        first = fronts[index]
        if id(first.start) in before:
            points += [_turned(p) for p in before[id(first.start)].points[:0:-1]]
        at = index
        while at in left:
            points += left.pop(at).points
            at = fronts[at].joins
        lost_start = id(first.start) in before and before[id(first.start)].lost
        if at >= 0 and index in led_to:
            curves.append(Curve(points, closed=True))
        elif lost_start or at >= 0 or points[-1].kind != Kind.border:
            open_ends.append(points)
        else:
            curves.append(Curve(points, closed=False))
    return curves + _bridged(open_ends)


def _turned(point: Reached) -> Reached:
    """A point of a trace against the orientation as one along it."""
    return point._replace(on=point.other, other=point.on) if point.kind == Kind.corner else point


def _bridged(pieces: list[list[Reached]]) -> list[Curve]:
    """Pieces whose ends were lost, joined by straight lines to the nearest beginning."""
    curves, gaps = [], [0.0] * len(pieces)
    while pieces:
        ends = np.array([p[-1].place for p in pieces])
        begins = np.array([p[0].place for p in pieces])
        far = np.linalg.norm(ends[:, None] - begins[None, :], axis=2)
        far[[p[-1].kind == Kind.border for p in pieces]] = np.inf
        far[:, [p[0].kind == Kind.border for p in pieces]] = np.inf
        i, j = np.unravel_index(int(np.argmin(far)), far.shape)
        gap = max(gaps[i], gaps[j], float(far[i, j]))
        if not np.isfinite(far[i, j]):
            curves += [Curve(p, closed=False, gap=g) for p, g in zip(pieces, gaps, strict=True)]
            break
        if i == j:
            curves.append(Curve(pieces[i], closed=True, gap=gap))
        else:
            pieces[i], gaps[i] = pieces[i] + pieces[j], gap
        del pieces[j], gaps[j]
    return curves


def loops_around(curves: Sequence[Curve], *, below: bool, all_below: bool) -> list[Loop]:
    """Closed lines around the region below zero, or around the rest.

    Args:
        curves: its boundary.
        below: which of both.
        all_below: whether the border of the square is below zero where no curve meets it.
    """
    found, open_curves = [], []
    for curve in curves:
        piece = _piece(curve, below)
        if curve.closed:
            found.append(piece._replace(area=piece.area + _polygon(piece.vertices)))
        else:
            open_curves.append(piece)
    if not open_curves and all_below == below:
        found.append(Loop(CORNERS, CORNERS, 1.0, 0.0))
    begins = np.array([_around(piece.vertices[0]) for piece in open_curves])
    left = set(range(len(open_curves)))
    while left:
        first = at = min(left)
        parts: list[Loop] = []
        while at in left:
            left.discard(at)
            parts.append(open_curves[at])
            end = _around(parts[-1].vertices[-1])
            ahead = (begins - end) % 4.0
            at = int(np.argmin(np.where(ahead > 0.0, ahead, 4.0)))
            passed = [c for c in range(1, 9) if end < c < end + ahead[at]]
            border = CORNERS[[c % 4 for c in passed]].reshape(-1, 2)
            parts.append(Loop(border, border, 0.0, 0.0))
        if at != first:
            continue
        vertices, outline = (np.concatenate([part[k] for part in parts]) for k in (0, 1))
        area = _polygon(vertices) + sum(part.area for part in parts)
        found.append(Loop(vertices, outline, area, sum(part.error for part in parts)))
    return found


def _piece(curve: Curve, below: bool) -> Loop:
    """A curve, with the part of the area that a polygon of its points lacks."""
    places = np.array([p.place for p in curve.points])
    places = np.where(places > 1.0 - _ON_BORDER, 1.0, np.where(places < _ON_BORDER, 0.0, places))
    before, after = curve.slopes()
    following = [*range(1, len(places)), *([0] if curve.closed else [])]
    chord = places[following] - places[: len(following)]
    length = np.linalg.norm(chord, axis=1)
    unit = chord / np.where(length > 0.0, length, 1.0)[:, None]

    def angle(slopes: Vector) -> Vector:
        ways = np.stack([-slopes[:, 1], slopes[:, 0]], axis=1)
        cross = unit[:, 0] * ways[:, 1] - unit[:, 1] * ways[:, 0]
        return np.asarray(np.arctan2(cross, (unit * ways).sum(axis=1)))

    a, b = angle(after[: len(following)]), angle(before[following])
    wild = np.maximum(np.abs(a), np.abs(b)) > 1.2  # a bridge, or no arc
    a, b = np.where(wild, 0.0, a), np.where(wild, 0.0, b)
    area, doubt = bulge(length, a, b)
    doubt = doubt + wild * length**2
    sign = 1 if below else -1
    pieces = [_cubic(places[i], chord[i], np.array([a[i], b[i]])) for i in range(len(following))]
    outline = np.concatenate([*pieces, places[len(following) :]])
    return Loop(places[::sign], outline[::sign], sign * float(area.sum()), float(doubt.sum()))


def _cubic(place: Vector, chord: Vector, angles: Vector) -> Vector:
    """Points of an arc from a place on, without its end: the cubic over its chord."""
    length = float(np.linalg.norm(chord))
    count = int(np.clip(np.ceil(np.sqrt(length * np.abs(angles).sum() / (8.0 * FLAT))), 1, 200))
    t = np.arange(count) / count
    slope = np.tan(angles)
    height = t * (1.0 - t) * ((1.0 - t) * slope[0] - t * slope[1])
    return np.asarray(
        place + t[:, None] * chord + height[:, None] * np.array([-chord[1], chord[0]])
    )


def _polygon(line: Vector) -> float:
    x, y = line.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def _around(place: Vector) -> float:
    """Where a point of the border is, counter-clockwise from the origin, 0 to 4."""
    x, y = place
    near = int(np.argmin([abs(y), abs(x - 1.0), abs(y - 1.0), abs(x)]))
    return float((x, 1.0 + y, 3.0 - x, 4.0 - y)[near]) % 4.0


def inside(loops: Sequence[Vector], x: Vector, y: Vector) -> np.ndarray:
    """Whether the points of a grid lie inside closed lines, (x, y): an odd number around them."""
    odd = np.zeros((len(x), len(y)), bool)
    for line in loops:
        after = np.roll(line, -1, axis=0)
        low, high = np.minimum(line[:, 0], after[:, 0]), np.maximum(line[:, 0], after[:, 0])
        first, last = np.searchsorted(x, low), np.searchsorted(x, high)
        which = np.repeat(np.arange(len(line)), last - first)
        column = np.arange(which.size) - np.repeat(
            np.cumsum(last - first) - (last - first), last - first
        )
        column += first[which]
        share = (x[column] - line[which, 0]) / (after[which, 0] - line[which, 0])
        height = line[which, 1] + share * (after[which, 1] - line[which, 1])
        flips = np.zeros((len(x), len(y) + 1), int)
        np.add.at(flips, (column, np.searchsorted(y, height)), 1)
        odd ^= flips.cumsum(axis=1)[:, :-1] % 2 == 1
    return odd


def gathered(loops: Sequence[Loop]) -> list[list[int]]:
    """Indices of loops by region: one around it, and those of its holes."""
    outer = [i for i, loop in enumerate(loops) if loop.area > 0.0]
    regions = {i: [i] for i in outer}
    for i, loop in enumerate(loops):
        if loop.area > 0.0:
            continue
        at = loop.vertices[0] + 0.5 * (loop.vertices[1] - loop.vertices[0])
        around = [o for o in outer if loops[o].area > -loop.area and _holds(loops[o].vertices, at)]
        if around:
            regions[min(around, key=lambda o: loops[o].area)].append(i)
    return list(regions.values())


def _holds(line: Vector, place: Vector) -> bool:
    return bool(inside([line], place[:1], place[1:])[0, 0])
