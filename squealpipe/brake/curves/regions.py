"""Turn lines of zeros of a function on the unit square into the regions that they bound.

Idea: pieces of lines are joined into chains; chains that end at the border are closed along it, on
the side where the function is positive. A loop that another one contains is a hole of it.
Invariant: loops run counter-clockwise around a region and clockwise around a hole, so areas add up;
a point is inside if an odd number of loops surround it.
"""

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from squealpipe.brake.curves.chords import Indices, Vector, cubic
from squealpipe.brake.curves.zero_lines import ZeroLines

SQUARE_CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


class Loop(NamedTuple):
    """A closed line around a region, counter-clockwise, or around a hole of it, clockwise.

    Attributes:
        outline: a polygon next to it.
        area: enclosed, negative for a hole; with its error.
    """

    outline: Vector
    area: float
    error: float


def chains_of(pairs: Indices) -> list[list[int]]:
    """Pairs (before, after) of points as lines; of a closed one the first point comes again."""
    after = dict(pairs.tolist())
    chains = []
    for first in [*(set(after) - set(after.values())), *after]:
        if first in after:
            chain = [first]
            while chain[-1] in after:
                chain.append(after.pop(chain[-1]))
            chains.append(chain)
    return chains


def inside(loops: Sequence[Vector], x: Vector, y: Vector) -> np.ndarray:
    """Return whether the points of a grid lie inside closed lines, (x, y): an odd number around
    them.
    """
    odd = np.zeros((len(x), len(y)), bool)
    for line in loops:
        after = np.roll(line, -1, axis=0)
        low = np.minimum(line[:, 0], after[:, 0])
        high = np.maximum(line[:, 0], after[:, 0])
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
    """Indices of loops by region: the one around it, and those of its holes."""
    outer = [
        i for i in np.argsort([loop.area for loop in loops]) if loops[i].area > 0.0
    ]
    low = np.array([loops[o].outline.min(axis=0) for o in outer]).reshape(-1, 2)
    high = np.array([loops[o].outline.max(axis=0) for o in outer]).reshape(-1, 2)
    regions = {i: [i] for i in outer}
    for i, loop in enumerate(loops):
        if loop.area > 0.0:
            continue
        place = loop.outline[:2].mean(axis=0)
        for k in np.flatnonzero(((low < place) & (place < high)).all(axis=1)):
            around = loops[outer[k]]
            if (
                around.area > -loop.area
                and inside([around.outline], *place[:, None])[0, 0]
            ):
                regions[outer[k]].append(i)
                break
    return list(regions.values())


@lru_cache(maxsize=2)
def loops_of(lines: ZeroLines, *, positive: bool, flat: float = 1e-6) -> list[Loop]:
    """Closed lines around the regions in which the function is positive, or around others."""
    chord, left, slopes = lines.slopes(lines.chords)
    length = np.linalg.norm(chord, axis=1)
    bulge = length**2 * (slopes[:, 0] - slopes[:, 1]) / 12.0
    count = np.ceil(np.sqrt(length * np.abs(slopes).sum(axis=1) / (8.0 * flat)))
    more = np.maximum(count, 1.0).astype(int) - 1
    k, last = np.repeat(np.arange(len(count)), more), np.cumsum(more)
    t = (np.arange(1, k.size + 1) - (last - more)[k]) / count[k]
    height = cubic(t, slopes[k])
    inner = (
        lines.place[lines.chords[k, 0]]
        + t[:, None] * chord[k]
        + height[:, None] * left[k]
    )
    between = {}
    for (start, end), n, to in zip(lines.chords.tolist(), more, last, strict=True):
        if n:
            points = inner[to - n : to]
            between[start, end], between[end, start] = points, points[::-1]
    chords = lines.chords if positive else lines.chords[:, ::-1]
    place = np.concatenate([lines.place, SQUARE_CORNERS])
    sign = -1.0 if positive else 1.0
    number = {(i, j): k for k, (i, j) in enumerate(chords.tolist())}
    loops = []
    for chain in chains_of(np.concatenate([chords, _border(lines, positive)])):
        pairs = list(pairwise(chain))
        on = [number[pair] for pair in pairs if pair in number]
        none = np.empty((0, 2))
        line = [
            each
            for i, j in pairs
            for each in (place[i : i + 1], between.get((i, j), none))
        ]
        x, y = place[chain].T
        area = 0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) + sign * bulge[on].sum()
        loops.append(
            Loop(np.concatenate(line), float(area), float(lines.error[on].sum()))
        )
    return loops


def holds(lines: ZeroLines, x: Vector, y: Vector) -> np.ndarray:
    """Return whether the function is positive at the points of a grid, (x, y)."""
    return inside([loop.outline for loop in loops_of(lines, positive=True)], x, y)


def _border(lines: ZeroLines, positive: bool) -> Indices:
    """Pieces of the square's border with one sign, counter-clockwise, as pairs of points."""
    place = np.concatenate([lines.place, SQUARE_CORNERS])
    on = np.flatnonzero(np.isin(place, (0.0, 1.0)).any(axis=1))
    on = on[(on >= len(lines.place)) | np.isin(on, lines.chords)]
    x, y = place[on].T
    around = np.select([y == 0.0, x == 1.0, y == 1.0], [x, 1.0 + y, 3.0 - x], 4.0 - y)
    on = on[
        np.lexsort(
            (on < len(lines.place), np.where(on == len(lines.place), 0.0, around))
        )
    ]
    has = np.cumsum(on < len(lines.place)) % 2 == (lines.positive != positive)
    return np.asarray(np.stack([on, np.roll(on, -1)], axis=1)[has])
