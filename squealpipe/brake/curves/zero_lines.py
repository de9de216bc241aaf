r"""Lines over the unit square on which a function is zero.

*Idea.* Where the function's sign changes on an adaptive grid, its zero on each edge of the grid
is found, and neighbours are joined by chords. Each chord is divided until the cubic over it,
from the tangents at its ends, predicts the zero next to it. It is divided where the tangents
meet: in the middle of a smooth arc, and next to a kink (the function may have kinks, as the
largest of many maxima has), which is so enclosed in a few steps::

      smooth arc             kink                 tongue
                              /\                    |
       ___*___               /  \                 __|__   zero beyond the chord,
     a ------- b           a ---- b              a -- b   up to 30 chord lengths away

*Source.* Marching squares for the start, secants safeguarded by bisection for zeros,
Hermite's cubic for the prediction; saddles of the grid are decided by the value at their centre.

*Invariant.* The positive side lies on the left of every chord, before and after each division,
so chords of a line follow one another and areas have a sign. ``error`` bounds the area between
chord and line; what could not be divided is told by ``unresolved``.

*Cost.* About a dozen evaluations for each point (324,417 runs for 25,819 points of the paper's two
boundaries), all chords of a level at once; the number of points grows as the inverse fourth root of
``off`` on smooth arcs.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.adaptive_grid import refine_grid
from squealpipe.brake.curves.chords import Chords, Indices, Mark, Vector, cubic, split

Function = Callable[[Vector], Vector]
"""Places, (places, 2) → values."""


@dataclass(frozen=True)
class ZeroLineSettings:
    """Limits of the search for zero lines. Lengths are those of the unit square, or relative to
    a chord.
    """

    shortest_chord: float = 50.0
    """Relative to the accuracy ``off``: a shorter chord is not divided any more, and next to a
    kink ends where the tangents meet. Doubled, corners are half as sharp."""
    most_divisions: int = 30
    """A chord is divided in two up to so many times."""
    most_points: int = 25_000
    """Division stops at so many points, since a line of long motions may have corners without end;
    the stored error says what is left."""
    closed: float = 1e-12
    """A zero is enclosed to this share of the line that it is searched on: round-off."""
    ends_checked: int = 5
    """After so many secants and halvings the end of a line that these make for is looked at: one
    without a zero is given up, not halved forty times. Fewer may miss two zeros next to that end.
    """
    difference: float = 1e-8
    """Step of the difference that gives a tangent: the root of round-off."""
    secant: tuple[float, float] = (1e-9, 1e-5)
    """A last secant between these lengths gives the tangent for free; a shorter one is round-off,
    a longer one no derivative."""
    longest_tongue: float = 30.0
    """A tongue of the line beyond a chord is searched for up to so many chord lengths; longer ones
    are missed."""
    ladder: tuple[float, ...] = (
        -3.0,
        -1.0,
        -0.3,
        -0.1,
        -0.03,
        -0.01,
        0.0,
        0.01,
        0.03,
        0.1,
        0.3,
        1.0,
        3.0,
    )
    """Distances across a chord, over its length, between which a zero is searched where the
    tangents predict none."""
    along_tangents: float = 0.6
    """Both edges of regions that touch are followed along their tangents for this share of the way
    to the meeting ..."""
    across_tangents: float = 0.06
    """... and the line is searched for across them within this share of that way. Doubled, another
    line might be found."""
    flattest_tongue: float = 0.5
    """Slope over a chord up to which the line beside it is a cubic; a steeper one may be a
    tongue."""
    sharp_corner: float = 0.5
    """Cosine of the turn between both tangents: a sharper corner is enclosed along them."""


settings = ZeroLineSettings()


def _image(places: Vector, slopes: Vector) -> tuple[Vector, Vector]:
    """Mirror images of places and of derivatives there, by (u, v) → (1 − v, 1 − u)."""
    return 1.0 - places[:, ::-1], -slopes[:, ::-1]


class FirstGrid(NamedTuple):
    """Points at which a function is first looked at.

    Attributes:
        coarse: points per side of the grid that sees the whole square.
        finer: how many times finer the grid is where the sign changes, a power of two.
    """

    coarse: int
    finer: int


class ZeroLines(Chords):
    """The lines on which a function is zero.

    Args:
        value: the function, of order one.
        mark: of points on the lines.
        grid: the points that see the whole square.
        off: how far lines may be on average, over a chord, from those that are drawn.
        residual: of the function at a point.
        touching: whether regions may touch in a point. Sharp corners are enclosed along both
            tangents then, which takes more places.
        mirrored: whether the function is the same at (u, v) and (1 − v, 1 − u). Lines are then
            followed in the cells on one side of the diagonal u + v = 1 and on it, and copied.

    Attributes:
        residual: of the points.
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
        mirrored: bool = False,
    ) -> None:
        super().__init__(mark, jump)
        self.value, self._touching = value, touching
        self.off, self.most, self.residual = off, residual, np.empty(0)
        self.chords, self.error = np.empty((0, 2), int), np.empty(0)
        self.unresolved = 0.0
        self._mirrored = mirrored
        size = (grid.coarse - 1) * grid.finer + 1
        chords, cells = self._on_grid(size, grid.coarse)
        if not mirrored:
            self._trace(chords)
            return
        below, across = (
            side(cells.sum(axis=1), size - 2) for side in (np.less, np.equal)
        )
        levels = self._trace(chords[below], copies=2)
        self._mirror()
        # a line that crosses the diagonal is its own mirror image: as many times divided as others
        self._trace(chords[across], levels=levels)

    def _on_grid(self, size: int, coarse: int) -> tuple[Indices, Indices]:
        """Zeros on the edges of a grid as points, and the chords between them with their cells."""
        known = np.zeros((size, size))

        def look(rows: Indices, columns: Indices) -> tuple[Any, Any, Any]:
            places = np.stack([rows, columns], axis=1)
            back: Any = slice(None)
            if self._mirrored:
                beyond = (places.sum(axis=1) > size - 1)[:, None]
                places = np.where(beyond, size - 1 - places[:, ::-1], places)
                places, back = np.unique(places, axis=0, return_inverse=True)
            values_on_grid = self.value(places / (size - 1))[back]
            known[rows, columns] = values_on_grid
            return (
                values_on_grid > 0.0,
                np.zeros(values_on_grid.shape, bool),
                np.abs(values_on_grid),
            )

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
        # middles of edges in half cells, of which none is on the diagonal
        middle = high + low
        mine = (not self._mirrored) | (middle.sum(axis=1) < 2 * (size - 1))
        start, way, before, after = (each[mine] for each in (start, way, before, after))
        share, *there = self._roots(
            start, way, before / (before - after), after - before, between=True
        )
        first = np.flatnonzero(mine)
        place = np.empty(middle.shape)
        slope, residual = np.empty(middle.shape), np.empty(len(middle))
        place[first] = start + share[:, None] * way
        slope[first] = self._slopes(place[first], way, *there)
        residual[first] = there[0]
        self._partner = np.full(len(middle), -1)
        if self._mirrored:
            number = np.full((2 * size, 2 * size), -1)
            number[tuple(middle.T)] = np.arange(len(middle))
            other = number[tuple((2 * (size - 1) - middle[first][:, ::-1]).T)]
            place[other], slope[other] = _image(place[first], slope[first])
            residual[other] = residual[first]
            self._partner[first], self._partner[other] = other, first
        self._append(place, slope, residual, np.full(len(place), np.nan))
        return self._joined(positive, *numbers)

    def _mirror(self) -> None:
        """Copy the chords that are kept, and their points, beyond the diagonal."""
        new = np.arange(len(self._partner), len(self.place))
        self._partner = np.concatenate(
            [self._partner, len(self.place) + np.arange(len(new))]
        )
        place, slope = _image(self.place[new], self.slope[new])
        self._append(place, slope, self.residual[new], self.mark[new])
        marked = np.flatnonzero(~np.isnan(self.mark[: len(self._partner)]))
        self.mark[self._partner[marked]] = self.mark[marked]
        # reflected, the positive side stays on the left of a chord that is turned
        self._keep(self._partner[self.chords][:, ::-1], self.error)

    def _joined(
        self, positive: NDArray[np.bool_], along: Indices, up: Indices
    ) -> tuple[Indices, Indices]:
        """Chords from where the sign falls along a cell's edge to its rise, and their cells."""
        corners = [
            positive[:-1, :-1],
            positive[1:, :-1],
            positive[1:, 1:],
            positive[:-1, 1:],
        ]
        # the lines cross few of the cells
        mixed = np.argwhere(
            np.any([each != corners[0] for each in corners[1:]], axis=0)
        )
        i, j = mixed.T
        sides = np.stack([along[i, j], up[i + 1, j], along[i, j + 1], up[i, j]], axis=1)
        around = np.stack([each[i, j] for each in corners], axis=1)
        falls = around & ~np.roll(around, -1, axis=1)
        rises = ~around & np.roll(around, -1, axis=1)
        once = falls.sum(axis=1) == 1
        chords = [
            np.stack([sides[once][falls[once]], sides[once][rises[once]]], axis=1)
        ]
        cells = [mixed[once]]
        twice = np.flatnonzero(falls.sum(axis=1) == 2)
        if len(twice):
            middles = (mixed[twice] + 0.5) / (len(positive) - 1)
            for k, joins in zip(twice, self.value(middles) > 0.0, strict=True):
                for side in np.flatnonzero(falls[k]):
                    other = (side + (1 if joins else -1)) % 4
                    chords.append(sides[k][[[side, other]]])
                    cells.append(mixed[[k]])
        return np.concatenate(chords), np.concatenate(cells)

    def _add(self, places: Vector, way: Vector, value: Vector, rate: Vector) -> Indices:
        """New points of one branch, by ways across it with the rates there; their indices."""
        slope = self._slopes(places, way, value, rate)
        return self._append(places, slope, value, np.full(len(places), np.nan))

    def _slopes(
        self, places: Vector, way: Vector, value: Vector, rate: Vector
    ) -> Vector:
        """Derivatives of the function by both coordinates, from its rate along a way."""
        length = np.linalg.norm(way, axis=1)
        along, rate = way / length[:, None], rate / length
        across, rough = along[:, ::-1] * [-1.0, 1.0], np.isnan(rate)
        rate[rough] = self._change(places[rough], along[rough], value[rough])
        change = self._change(places, across, value)
        return np.asarray(rate[:, None] * along + change[:, None] * across)

    def _change(self, places: Vector, way: Vector, value: Vector) -> Vector:
        """Return the rate of the function along unit vectors, by a step into the square."""
        step = np.where(
            (way * (places - 0.5)).sum(axis=1) > 0.0,
            -settings.difference,
            settings.difference,
        )
        return np.asarray((self.value(places + step[:, None] * way) - value) / step)

    def _append(
        self, place: Vector, slope: Vector, residual: Vector, mark: Vector
    ) -> Indices:
        self.place = np.concatenate([self.place, place])
        self.slope = np.concatenate([self.slope, slope])
        self.residual = np.concatenate([self.residual, np.abs(residual)])
        self.mark = np.concatenate([self.mark, mark])
        return len(self.place) - len(place) + np.arange(len(place))

    def _trace(
        self, chords: Indices, *, copies: int = 1, levels: int | None = None
    ) -> int:
        """Divide chords until their areas are known; return how many times.

        Args:
            copies: how many points each new one will make.
            levels: divide as many times at most, whatever the number of points.
        """
        error, level, before = self.length(chords) ** 2, 0, len(self.place)
        self.marks(chords)
        for level in range(settings.most_divisions if levels is None else levels + 1):
            points = before + copies * (len(self.place) - before)
            if not len(chords) or (
                points > settings.most_points if levels is None else level == levels
            ):
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
            self._keep(chords[ended], self.length(chords[ended]) ** 2)
            self._not_divided(chords[ended])
            chords, middle, error = chords[divided], middle[divided], error[divided]
            kinked = self.jumps(chords) | (error > self.bent(chords))
            self.marks(np.concatenate([chords[kinked].ravel(), middle[kinked]]))
            chords, error = split(chords, middle), np.repeat(0.5 * error, 2)
            length = self.length(chords)
            jumps = self.jumps(chords)
            bent = self.bent(chords)
            error = np.where(jumps, error, np.minimum(error, bent))
            # by chance the middle of a chord may be right where the rest is not
            going = ((np.maximum(error, 0.5 * bent) > self.off * length) | jumps) & (
                length > settings.shortest_chord * self.off
            )
            self._keep(chords[~going & ~jumps], error[~going & ~jumps])
            around = chords[~going & jumps]
            place, none = self.meeting(around)[1], np.full((len(around), 2), np.nan)
            place = np.where(np.isnan(place), self.place[around].mean(axis=1), place)
            corner = self._append(
                place, none, self.value(place), self.mark[around[:, 0]]
            )
            self._keep(split(around, corner), np.repeat(0.5 * error[~going & jumps], 2))
            chords = np.concatenate([chords[going], shorter])
        else:
            level += 1
        self._not_divided(chords)
        self._keep(chords, self.length(chords) ** 2)
        return level

    def _not_divided(self, chords: Indices) -> None:
        """Take account of chords that should be shorter; the shortest ones need not."""
        length = self.length(chords)
        long = length > settings.shortest_chord * self.off
        self.unresolved = max([self.unresolved, *length[long]])

    def _astray(self, chords: Indices, middle: Indices) -> Any:
        """Return whether chords have a sharp corner beside them, or middles may lie beyond one.

        Where two regions touch, a zero beside such a chord may be that of a line that leads
        elsewhere. The line through such a middle runs back, or does not meet the branch of one end.
        """
        kinked = self.jumps(chords)
        self.marks(middle[kinked])
        first, last = self.tangents(chords)
        astray = (first * last).sum(axis=-1) < settings.sharp_corner
        for parts in split(chords, middle).reshape(-1, 2, 2).swapaxes(0, 1):
            chord = np.diff(self.place[parts], axis=1)
            forward = self.slope[parts][..., ::-1] * [1.0, -1.0]
            astray |= ((chord * forward).sum(axis=-1) < 0.0).any(axis=1)
            apart = np.isnan(self.meeting(parts)[1][:, 0])
            astray |= self.jumps(parts) & apart
        return astray & kinked

    def _cut(self, chords: Indices) -> tuple[Indices, Any]:
        """Chords across a place at which lines meet, in three pieces each, and which could be cut.

        Where two regions touch in a point, no zero lies beside the chord from the edge of one to
        that of the other, or one of a line that leads elsewhere. So both edges are followed by
        their tangents, most of the way to where these meet.
        """
        ends = self.place[chords]
        ahead = self.meeting(chords)[1][:, None] - ends
        far = np.linalg.norm(ahead, axis=-1)
        longest = settings.longest_tongue * self.length(chords)[:, None]
        cut = ((far > 0.0) & (far < longest)).all(axis=1)
        slope = self.slope[chords[cut]]
        normal = slope / np.linalg.norm(slope, axis=-1)[..., None]
        way = (-2.0 * settings.across_tangents * far[cut, :, None] * normal).reshape(
            -1, 2
        )
        start = (ends + settings.along_tangents * ahead)[cut].reshape(-1, 2) - 0.5 * way
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

    def _keep(self, chords: Indices, error: Vector) -> None:
        self.chords = np.concatenate([self.chords, chords])
        self.error = np.concatenate([self.error, error])

    def _divided(self, chords: Indices) -> tuple[Vector, ...]:
        """Return how far the areas beside chords are to be doubted, and zeros there; NaN: none.

        With each zero the way on which it was found, and the function and its rate there.
        """
        chord, left, slopes = self.slopes(chords)
        length = self.length(chords)
        share, meeting = self.meeting(chords)
        at = 0.05 + 0.9 * share
        foot = self.place[chords[:, 0]] + at[:, None] * chord
        height, doubt = cubic(at, slopes), length**2 / 8.0
        steep = (np.abs(slopes) > settings.flattest_tongue).any(axis=1)
        ahead, back = at * slopes[:, 0], (at - 1.0) * slopes[:, 1]
        kinked = self.jumps(chords)
        nearer = np.abs(ahead) < np.abs(back)
        lower = np.where(ahead * back > 0.0, np.where(nearer, ahead, back), 0.0)
        height = np.where(steep | kinked, lower, height)
        reach = 0.3 * np.minimum(at, 1.0 - at) + np.abs(height)
        # a tongue is crossed between the chord and where the tangents meet
        axis = meeting - self.place[chords[:, 0]] - share[:, None] * chord
        long = np.linalg.norm(axis, axis=1)
        side = np.sign((axis * left).sum(axis=1))
        tongue = (
            steep & (long > 0.3 * length) & (long < settings.longest_tongue * length)
        )
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
        start[lost], way[lost], *across_values = self._searched_across(
            foot[lost], left[lost]
        )
        for each, across_value in zip((share, *there), across_values, strict=True):
            each[lost] = across_value
        doubt *= np.where(steep | lost, 1.0, np.abs(off))
        return doubt, start + share[:, None] * way, way, *there

    def _searched_across(self, foot: Vector, left: Vector) -> tuple[Vector, ...]:
        """The zeros next to chords among those between rungs of a ladder across; NaN: none."""
        ladder = np.array(settings.ladder)
        places = foot[:, None] + ladder[:, None] * left[:, None]
        signs = self.value(places.reshape(-1, 2)).reshape(-1, ladder.size) > 0.0
        middle = 0.5 * np.abs(ladder[1:] + ladder[:-1])
        far = np.where(signs[:, 1:] & ~signs[:, :-1], middle, np.inf)
        rung, is_reached = far.argmin(axis=1), np.isfinite(far.min(axis=1))
        start = foot + ladder[rung + 1, None] * left
        way = (ladder[rung] - ladder[rung + 1])[:, None] * left
        unknown = np.full(len(foot), np.nan)
        share, *there = self._roots(start, way, np.full(len(foot), 0.5), unknown)
        return start, way, np.where(is_reached, share, np.nan), *there

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
        roots, last, slope = np.full((3, len(start)), np.nan)
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
            closed = high[left] - low[left] < settings.closed
            zero = (np.abs(here) <= self.most) | (closed & (enclosed | between))
            roots[left[zero]], last[left[zero]] = at[zero], here[zero]
            good = zero & (step > settings.secant[0]) & (step < settings.secant[1])
            slope[left[good]] = secant[good]
            left = left[~zero & ~closed]
            if iteration == settings.ends_checked and not between:
                ends = (each[left] for each in (start, way, low, high))
                left = left[self._encloses(*ends)]
        return roots, last, slope

    def _encloses(
        self, start: Vector, way: Vector, low: Vector, high: Vector
    ) -> NDArray[np.bool_]:
        """Return whether signs differ at both ends of lines of which one end was not looked at."""
        at_end = high == 1.0
        unseen = at_end | (low == 0.0)
        enclosed = np.ones(len(start), bool)
        places = (start + at_end[:, None] * way)[unseen]
        enclosed[unseen] = (self.value(places) > 0.0) != at_end[unseen]
        return enclosed
