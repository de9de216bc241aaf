"""Lines over the unit square on which a function is zero, and the regions that they bound.

The function may have kinks, as the largest of many maxima has. Where its sign changes on an
adaptive grid, its zero on each edge of the grid is found, and neighbours are joined. Each chord
between two of them is divided until the cubic over it, from the tangents at its ends, predicts the
zero beside it. It is divided where the tangents meet: in the middle of a smooth arc, and next to a
kink, which is so enclosed in a few steps.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from squealpipe.methods.adaptive_grid import refine_grid

Vector = NDArray[np.float64]
Indices = NDArray[np.int64]
Function = Callable[[Vector], Vector]
"""Places, (places, 2) → values."""
Mark = Callable[[Vector, Vector], Vector]
"""Places and slopes there → what jumps from one branch of a function to another."""

SHORTEST = 50.0
"""Chord beside a kink, over off, below which the tangents meet in it."""
BENT, SKEW, ROUGH = 0.6, 0.08, 1e-6
"""Area beside a chord of one arc that is doubted, over its length squared and its turn cubed; what
a curvature that changes along it, and the error of the tangents, add to that."""
MOST_DIVISIONS, MOST_POINTS = 30, 25_000
"""Where motions last long a line may have corners without end: its error then says what is left."""
CLOSED = 1e-12
"""Share of a line that encloses a zero."""
STEP, SECANT = 1e-8, (1e-9, 1e-5)
"""Of the differences that give tangents; of those that a zero's last secant gives."""
FLAT = 1e-6
"""Distance of a polygon from a line."""
LONGEST = 30.0
"""Tongue beyond a chord, over it, that is looked for."""
RUNGS = np.array(
    [-3.0, -1.0, -0.3, -0.1, -0.03, -0.01, 0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0]
)
"""Distances from a chord, over its length, between which a zero is looked for."""
SHORT_OF, BESIDE_TANGENT = 0.6, 0.06
"""Share of the way to where tangents meet that is gone along them; how far beside them, over that
way, a line is looked for."""
SHARP = 0.5
"""Cosine of the turn at a corner that is enclosed along both tangents."""
FLATTISH, STEEPEST = 0.5, 3.0
"""Slope over a chord up to which a line is taken for a cubic; largest in the area beside it."""
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


class Loop(NamedTuple):
    """A closed line around a region, counter-clockwise, or around a hole of it, clockwise.

    Attributes:
        outline: a polygon next to it.
        area: enclosed, negative for a hole; with its error.
    """

    outline: Vector
    area: float
    error: float


class FirstGrid(NamedTuple):
    """Points at which a function is first looked at.

    Attributes:
        coarse: points per side of the grid that sees the whole square.
        finer: how many times finer the grid is where the sign changes, a power of two.
    """

    coarse: int
    finer: int


class ZeroLines:
    """The lines on which a function is zero.

    Args:
        value: the function, of order one.
        mark: of points on the lines.
        grid: the points that see the whole square.
        off: how far lines may be on average, over a chord, from those that are drawn.
        residual: of the function at a point.
        touching: whether regions may touch in a point. Sharp corners are enclosed along both
            tangents then, which takes more places.

    Attributes:
        place: (points, 2).
        slope: derivatives of the function, (points, 2); NaN at a corner, where two branches meet.
        residual: of the points.
        mark: of the points where it was asked for, else NaN.
        chords: indices of first and last points, (chords, 2), the positive side on their left.
        error: of the area beside each chord.
        positive: whether the function is so at the square's origin.
        unresolved: length of the longest chord that could not be divided as far as it should, or 0.
    """

    def __init__(
        self,
        value: Function,
        mark: Mark,
        grid: FirstGrid,
        *,
        jump: float,
        off: float = 1e-8,
        residual: float = 1e-11,
        touching: bool = False,
    ) -> None:
        self.value, self._mark, self._touching = value, mark, touching
        self.jump, self.off, self.most = jump, off, residual
        self.place, self.slope = np.empty((0, 2)), np.empty((0, 2))
        self.residual, self.mark = np.empty(0), np.empty(0)
        self.chords, self.error = np.empty((0, 2), int), np.empty(0)
        self.unresolved = 0.0
        self._trace(self._on_grid((grid.coarse - 1) * grid.finer + 1, grid.coarse))

    def _on_grid(self, size: int, coarse: int) -> Indices:
        """Zeros on the edges of a grid as points, and the chords between them."""
        known = np.zeros((size, size))

        def look(rows: Indices, columns: Indices) -> tuple[Any, Any, Any]:
            found = self.value(np.stack([rows, columns], axis=1) / (size - 1))
            known[rows, columns] = found
            return found > 0.0, np.zeros(found.shape, bool), np.abs(found)

        positive = refine_grid(look, size, coarse).labels
        self.positive = bool(positive[0, 0])
        count, numbers, up, down = 0, [], [], []
        for axis in (0, 1):
            labels = np.moveaxis(positive, axis, 0)
            changes = np.argwhere(labels[1:] != labels[:-1])
            ends = changes[:, None, :] + np.array([[0, 0], [1, 0]])
            falls = labels[tuple(changes.T)]
            ends = np.where(falls[:, None, None], ends, ends[:, ::-1])
            number = np.full((size - 1, size), -1)
            number[tuple(changes.T)] = count + np.arange(len(changes))
            count += len(changes)
            up.append(ends[:, 0, :: 1 - 2 * axis])
            down.append(ends[:, 1, :: 1 - 2 * axis])
            numbers.append(np.moveaxis(number, 0, axis))
        high, low = np.concatenate(up), np.concatenate(down)
        before, after = known[tuple(high.T)], known[tuple(low.T)]
        start, way = high / (size - 1), (low - high) / (size - 1)
        found = self._roots(
            start, way, before / (before - after), after - before, between=True
        )
        self._add(start + found[0][:, None] * way, way, *found[1:])
        return self._joined(positive, *numbers)

    def _joined(
        self, positive: NDArray[np.bool_], along: Indices, up: Indices
    ) -> Indices:
        """Chords across the cells, from where the sign falls along a cell's edge to its rise."""
        corners = [
            positive[:-1, :-1],
            positive[1:, :-1],
            positive[1:, 1:],
            positive[:-1, 1:],
        ]
        sides = np.stack([along[:, :-1], up[1:], along[:, 1:], up[:-1]], axis=-1)
        around = np.stack(corners, axis=-1)
        falls = around & ~np.roll(around, -1, axis=-1)
        rises = ~around & np.roll(around, -1, axis=-1)
        once = falls.sum(axis=-1) == 1
        chords = [
            np.stack([sides[once][falls[once]], sides[once][rises[once]]], axis=1)
        ]
        saddles = np.argwhere(falls.sum(axis=-1) == 2)
        if len(saddles):
            through = self.value((saddles + 0.5) / (len(positive) - 1)) > 0.0
            for (i, j), joins in zip(saddles, through, strict=True):
                for side in np.flatnonzero(falls[i, j]):
                    other = (side + (1 if joins else -1)) % 4
                    chords.append(sides[i, j][[[side, other]]])
        return np.concatenate(chords)

    def _add(self, places: Vector, way: Vector, value: Vector, rate: Vector) -> Indices:
        """New points of one branch, by ways across it with the rates there; their indices."""
        length = np.linalg.norm(way, axis=1)
        along, rate = way / length[:, None], rate / length
        across, rough = along[:, ::-1] * [-1.0, 1.0], np.isnan(rate)
        rate[rough] = self._change(places[rough], along[rough], value[rough])
        change = self._change(places, across, value)
        slope = rate[:, None] * along + change[:, None] * across
        return self._append(places, slope, value, np.full(len(places), np.nan))

    def _change(self, places: Vector, way: Vector, value: Vector) -> Vector:
        """How fast the function changes along unit vectors, by a step into the square."""
        step = np.where((way * (places - 0.5)).sum(axis=1) > 0.0, -STEP, STEP)
        return np.asarray((self.value(places + step[:, None] * way) - value) / step)

    def _append(
        self, place: Vector, slope: Vector, residual: Vector, mark: Vector
    ) -> Indices:
        self.place = np.concatenate([self.place, place])
        self.slope = np.concatenate([self.slope, slope])
        self.residual = np.concatenate([self.residual, np.abs(residual)])
        self.mark = np.concatenate([self.mark, mark])
        return len(self.place) - len(place) + np.arange(len(place))

    def _trace(self, chords: Indices) -> None:
        """Divide chords until their areas are known."""
        error = self._length(chords) ** 2
        self.marks(chords)
        for _ in range(MOST_DIVISIONS):
            if not len(chords) or len(self.place) > MOST_POINTS:
                break
            error, new, *across = self._divided(chords)
            lost = ~((new >= 0.0) & (new <= 1.0)).all(axis=1) | ~across[0].any(axis=1)
            middle = np.full(len(chords), -1)
            middle[~lost] = self._add(new[~lost], *(each[~lost] for each in across))
            cut = np.zeros(len(chords), bool)
            if self._touching:
                cut[lost] = True
                cut[~lost] = self._astray(chords[~lost], middle[~lost])
            shorter, cut[cut] = self._cut(chords[cut])
            ended, divided = lost & ~cut, ~lost & ~cut
            self._keep(chords[ended], self._length(chords[ended]) ** 2)
            self._not_divided(chords[ended])
            chords, middle, error = chords[divided], middle[divided], error[divided]
            kinked = self._jumps(chords) | (error > self._bent(chords))
            self.marks(np.concatenate([chords[kinked].ravel(), middle[kinked]]))
            chords, error = _split(chords, middle), np.repeat(0.5 * error, 2)
            length = self._length(chords)
            jumps = self._jumps(chords)
            bent = self._bent(chords)
            error = np.where(jumps, error, np.minimum(error, bent))
            # by chance the middle of a chord may be right where the rest is not
            going = ((np.maximum(error, 0.5 * bent) > self.off * length) | jumps) & (
                length > SHORTEST * self.off
            )
            self._keep(chords[~going & ~jumps], error[~going & ~jumps])
            around = chords[~going & jumps]
            place, none = self._meeting(around)[1], np.full((len(around), 2), np.nan)
            place = np.where(np.isnan(place), self.place[around].mean(axis=1), place)
            corner = self._append(
                place, none, self.value(place), self.mark[around[:, 0]]
            )
            self._keep(
                _split(around, corner), np.repeat(0.5 * error[~going & jumps], 2)
            )
            chords = np.concatenate([chords[going], shorter])
        self._not_divided(chords)
        self._keep(chords, self._length(chords) ** 2)

    def _not_divided(self, chords: Indices) -> None:
        """Take account of chords that should be shorter; the shortest ones need not."""
        length = self._length(chords)
        long = length > SHORTEST * self.off
        self.unresolved = max([self.unresolved, *length[long]])

    def _astray(self, chords: Indices, middle: Indices) -> Any:
        """Whether chords have a sharp corner beside them, or middles may lie beyond one.

        Where two regions touch, a zero beside such a chord may be that of a line that leads
        elsewhere. The line through such a middle runs back, or does not meet the branch of one end.
        """
        kinked = self._jumps(chords)
        self.marks(middle[kinked])
        first, last = self._tangents(chords)
        astray = (first * last).sum(axis=-1) < SHARP
        for parts in _split(chords, middle).reshape(-1, 2, 2).swapaxes(0, 1):
            chord = np.diff(self.place[parts], axis=1)
            forward = self.slope[parts][..., ::-1] * [1.0, -1.0]
            astray |= ((chord * forward).sum(axis=-1) < 0.0).any(axis=1)
            apart = np.isnan(self._meeting(parts)[1][:, 0])
            astray |= self._jumps(parts) & apart
        return astray & kinked

    def _cut(self, chords: Indices) -> tuple[Indices, Any]:
        """Chords across a place at which lines meet, in three pieces each, and which could be cut.

        Where two regions touch in a point, no zero lies beside the chord from the edge of one to
        that of the other, or one of a line that leads elsewhere. So both edges are followed by
        their tangents, most of the way to where these meet.
        """
        ends = self.place[chords]
        ahead = self._meeting(chords)[1][:, None] - ends
        far = np.linalg.norm(ahead, axis=-1)
        longest = LONGEST * self._length(chords)[:, None]
        cut = ((far > 0.0) & (far < longest)).all(axis=1)
        slope = self.slope[chords[cut]]
        normal = slope / np.linalg.norm(slope, axis=-1)[..., None]
        way = (-2.0 * BESIDE_TANGENT * far[cut, :, None] * normal).reshape(-1, 2)
        start = (ends + SHORT_OF * ahead)[cut].reshape(-1, 2) - 0.5 * way
        rate = (slope.reshape(-1, 2) * way).sum(axis=1)
        share, *there = self._roots(start, way, np.full(len(way), 0.5), rate)
        new = start + share[:, None] * way
        known = ((new >= 0.0) & (new <= 1.0)).all(axis=1).reshape(-1, 2).all(axis=1)
        cut[cut] = known
        both = np.repeat(known, 2)
        nearer = self._add(new[both], way[both], *(each[both] for each in there))
        first, last = chords[cut].T
        line = np.stack([first, *nearer.reshape(-1, 2).T, last], axis=1)
        pieces = np.concatenate([line[:, i : i + 2] for i in range(3)])
        self.marks(pieces)
        return pieces, cut

    def _jumps(self, chords: Indices) -> Any:
        """Whether chords join two branches, as far as the marks of their ends are known."""
        return np.abs(np.diff(self.mark[chords], axis=1)[:, 0]) > self.jump

    def _bent(self, chords: Indices) -> Vector:
        """What a cubic leaves beside a chord of one branch: the third power of its turn."""
        slopes = self._slopes(chords)[2]
        turn = np.abs(slopes).max(axis=1)
        skew = SKEW * slopes.sum(axis=1) ** 2 / np.maximum(turn, ROUGH)
        return np.asarray(BENT * self._length(chords) ** 2 * (turn**3 + skew + ROUGH))

    def marks(self, points: Indices) -> Vector:
        """What tells branches apart, at some points."""
        new = np.unique(points[np.isnan(self.mark[points])])
        self.mark[new] = self._mark(self.place[new], self.slope[new])
        return np.asarray(self.mark[points])

    def _keep(self, chords: Indices, error: Vector) -> None:
        self.chords = np.concatenate([self.chords, chords])
        self.error = np.concatenate([self.error, error])

    def _length(self, chords: Indices) -> Vector:
        return np.asarray(
            np.linalg.norm(np.diff(self.place[chords], axis=1)[:, 0], axis=1)
        )

    def _slopes(self, chords: Indices) -> tuple[Vector, Vector, Vector]:
        """Chords as vectors, those to their left, and slopes of the lines at both ends."""
        chord = np.diff(self.place[chords], axis=1)
        left = np.stack([-chord[..., 1], chord[..., 0]], axis=-1)
        # the line goes where the slope is turned to, clockwise
        forward, aside = (
            (self.slope[chords] * way).sum(axis=-1) for way in (left, -chord)
        )
        with np.errstate(all="ignore"):
            slopes = np.clip(aside / np.maximum(forward, 0.0), -STEEPEST, STEEPEST)
        return chord[:, 0], left[:, 0], np.nan_to_num(slopes)

    def _meeting(self, chords: Indices) -> tuple[Vector, Vector]:
        """Where the tangent at the first end, forwards, meets that at the last, backwards.

        Returns:
            The share of its way from end to end, 0.5 where there is none, and the place, NaN there.
        """
        chord = np.diff(self.place[chords], axis=1)[:, 0]
        first, last = self._tangents(chords)
        with np.errstate(all="ignore"):
            along = _cross(chord, last) / _cross(first, last)
            back = _cross(first, chord) / _cross(first, last)
            share = np.where(
                (along > 0.0) & (back > 0.0), along / (along + back), np.nan
            )
        meeting = np.where(np.isnan(share), np.nan, along)[:, None] * first
        return np.nan_to_num(share, nan=0.5), self.place[chords[:, 0]] + meeting

    def _tangents(self, chords: Indices) -> Vector:
        """Unit vectors along the lines at both ends, (2, chords, 2)."""
        slope = np.moveaxis(self.slope[chords], 1, 0)
        slope = slope / np.linalg.norm(slope, axis=-1)[..., None]
        return np.stack([slope[..., 1], -slope[..., 0]], axis=-1)

    def _divided(self, chords: Indices) -> tuple[Vector, ...]:
        """How far the areas beside chords are to be doubted, and zeros there; NaN: none.

        With each zero the way on which it was found, and the function and its rate there.
        """
        chord, left, slopes = self._slopes(chords)
        length = self._length(chords)
        share, meeting = self._meeting(chords)
        at = 0.05 + 0.9 * share
        foot = self.place[chords[:, 0]] + at[:, None] * chord
        height, doubt = _cubic(at, slopes), length**2 / 8.0
        steep = (np.abs(slopes) > FLATTISH).any(axis=1)
        ahead, back = at * slopes[:, 0], (at - 1.0) * slopes[:, 1]
        kinked = self._jumps(chords)
        nearer = np.abs(ahead) < np.abs(back)
        lower = np.where(ahead * back > 0.0, np.where(nearer, ahead, back), 0.0)
        height = np.where(steep | kinked, lower, height)
        reach = 0.3 * np.minimum(at, 1.0 - at) + np.abs(height)
        # a tongue is crossed between the chord and where the tangents meet
        axis = meeting - self.place[chords[:, 0]] - share[:, None] * chord
        long = np.linalg.norm(axis, axis=1)
        side = np.sign((axis * left).sum(axis=1))
        tongue = steep & (long > 0.3 * length) & (long < LONGEST * length)
        axis = np.where(tongue[:, None], side[:, None] * axis, left)
        height = np.where(tongue, 0.7 * side, height)
        reach = np.where(tongue, 1.0, reach)
        doubt[steep] = length[steep] * np.fmax(length, long)[steep]
        start = foot + (height + reach)[:, None] * axis
        way = -2.0 * reach[:, None] * axis
        rates = (self.slope[chords] * way[:, None]).sum(axis=2)
        rate = np.where(kinked, np.where(nearer, *rates.T), rates.mean(axis=1))
        share, *there = self._roots(start, way, np.full(len(at), 0.5), rate)
        off = reach * (1.0 - 2.0 * share)
        lost = np.isnan(off)
        start[lost], way[lost], *sought = self._sought(foot[lost], left[lost])
        for each, found in zip((share, *there), sought, strict=True):
            each[lost] = found
        doubt *= np.where(steep | lost, 1.0, np.abs(off))
        return doubt, start + share[:, None] * way, way, *there

    def _sought(self, foot: Vector, left: Vector) -> tuple[Vector, ...]:
        """The zeros next to chords among those between rungs of a ladder across; NaN: none."""
        places = foot[:, None] + RUNGS[:, None] * left[:, None]
        signs = self.value(places.reshape(-1, 2)).reshape(-1, RUNGS.size) > 0.0
        middle = 0.5 * np.abs(RUNGS[1:] + RUNGS[:-1])
        far = np.where(signs[:, 1:] & ~signs[:, :-1], middle, np.inf)
        rung, found = far.argmin(axis=1), np.isfinite(far.min(axis=1))
        start = foot + RUNGS[rung + 1, None] * left
        way = (RUNGS[rung] - RUNGS[rung + 1])[:, None] * left
        unknown = np.full(len(foot), np.nan)
        share, *there = self._roots(start, way, np.full(len(foot), 0.5), unknown)
        return start, way, np.where(found, share, np.nan), *there

    def _roots(
        self,
        start: Vector,
        way: Vector,
        share: Vector,
        rate: Vector,
        *,
        between: bool = False,
    ) -> tuple[Vector, Vector, Vector]:
        """Shares of lines at which the function is zero, and it and its rate there; NaN: none.

        The secant method, within what the signs enclose.

        Args:
            start, way: lines from where it is positive to where it is not, (lines, 2).
            share, rate: guesses of the shares, and of the function's derivatives by them.
            between: the signs at both ends differ, so that a zero may be at an end.
        """
        low, high, now = np.zeros(len(start)), np.ones(len(start)), share.copy()
        found, last, slope = np.full((3, len(start)), np.nan)
        old = now.copy()
        before = np.full(len(start), np.nan)
        left = np.arange(len(start))
        size, rate = np.linalg.norm(way, axis=1), rate.copy()
        for iteration in range(60):
            if not left.size:
                break
            here, at = self.value(start[left] + now[left, None] * way[left]), now[left]
            low[left] = np.where(here > 0.0, at, low[left])
            high[left] = np.where(here > 0.0, high[left], at)
            with np.errstate(all="ignore"):
                secant = (here - before[left]) / (at - old[left])
                rate[left] = np.where(np.isfinite(secant), secant, rate[left])
                new = at - here / rate[left]
            step = np.abs(at - old[left]) * size[left]
            old[left], before[left] = at, here
            enclosed = (
                (new > low[left])
                & (new < high[left])
                & (iteration % 8 < 6)
                & (iteration < 20)
            )
            now[left] = np.where(enclosed, new, 0.5 * (low[left] + high[left]))
            enclosed = (low[left] > 0.0) & (high[left] < 1.0)
            closed = high[left] - low[left] < CLOSED
            zero = (np.abs(here) <= self.most) | (closed & (enclosed | between))
            found[left[zero]], last[left[zero]] = at[zero], here[zero]
            good = zero & (step > SECANT[0]) & (step < SECANT[1])
            slope[left[good]] = secant[good]
            left = left[~zero & ~closed]
        return found, last, slope

    def chains(self) -> list[list[int]]:
        """Points of each line in order; of a closed one the first comes again."""
        return _chains(self.chords)

    def loops(self, *, positive: bool, flat: float = FLAT) -> list[Loop]:
        """Closed lines around the regions in which the function is positive, or around others."""
        chord, left, slopes = self._slopes(self.chords)
        length = np.linalg.norm(chord, axis=1)
        bulge = length**2 * (slopes[:, 0] - slopes[:, 1]) / 12.0
        count = np.ceil(np.sqrt(length * np.abs(slopes).sum(axis=1) / (8.0 * flat)))
        between = {}
        for k in np.flatnonzero(count > 1):
            t = np.arange(1, count[k]) / count[k]
            height = _cubic(t, slopes[k : k + 1])
            start, end = self.chords[k]
            inner = (
                self.place[start] + t[:, None] * chord[k] + height[:, None] * left[k]
            )
            between[start, end], between[end, start] = inner, inner[::-1]
        chords = self.chords if positive else self.chords[:, ::-1]
        place = np.concatenate([self.place, CORNERS])
        sign = -1.0 if positive else 1.0
        number = {(i, j): k for k, (i, j) in enumerate(chords)}
        found = []
        for chain in _chains(np.concatenate([chords, self._border(positive)])):
            pairs = list(pairwise(chain))
            on = [number[pair] for pair in pairs if pair in number]
            none = np.empty((0, 2))
            line = [
                each
                for i, j in pairs
                for each in (place[[i]], between.get((i, j), none))
            ]
            x, y = place[chain].T
            area = (
                0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) + sign * bulge[on].sum()
            )
            found.append(
                Loop(np.concatenate(line), float(area), float(self.error[on].sum()))
            )
        return found

    def holds(self, x: Vector, y: Vector) -> np.ndarray:
        """Whether the function is positive at the points of a grid, (x, y)."""
        return inside([loop.outline for loop in self.loops(positive=True)], x, y)

    def _border(self, positive: bool) -> Indices:
        """Pieces of the square's border with one sign, counter-clockwise, as pairs of points."""
        place = np.concatenate([self.place, CORNERS])
        on = np.flatnonzero(np.isin(place, (0.0, 1.0)).any(axis=1))
        on = on[(on >= len(self.place)) | np.isin(on, self.chords)]
        x, y = place[on].T
        around = np.select(
            [y == 0.0, x == 1.0, y == 1.0], [x, 1.0 + y, 3.0 - x], 4.0 - y
        )
        on = on[
            np.lexsort(
                (on < len(self.place), np.where(on == len(self.place), 0.0, around))
            )
        ]
        has = np.cumsum(on < len(self.place)) % 2 == (self.positive != positive)
        return np.asarray(np.stack([on, np.roll(on, -1)], axis=1)[has])


def _split(chords: Indices, middle: Indices) -> Indices:
    return np.stack([chords[:, 0], middle, middle, chords[:, 1]], axis=1).reshape(-1, 2)


def _cross(a: Vector, b: Vector) -> Vector:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _cubic(at: Vector, slopes: Vector) -> Vector:
    """Height over a chord, in its lengths, of the cubic with some slopes at its ends."""
    return np.asarray(at * (1.0 - at) * ((1.0 - at) * slopes[:, 0] - at * slopes[:, 1]))


def _chains(pairs: Indices) -> list[list[int]]:
    """Pairs (before, after) as lines; of a closed one the first point comes again."""
    after = dict(pairs.tolist())
    found = []
    for first in [*(set(after) - set(after.values())), *after]:
        if first in after:
            chain = [first]
            while chain[-1] in after:
                chain.append(after.pop(chain[-1]))
            found.append(chain)
    return found


def inside(loops: Sequence[Vector], x: Vector, y: Vector) -> np.ndarray:
    """Whether the points of a grid lie inside closed lines, (x, y): an odd number around them."""
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
