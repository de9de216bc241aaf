"""The boundary of a region in which every one of many smooth functions stays below zero.

The functions are the maxima of a quantity along a run, and its value at the run's end; their number
and order change from place to place, so that they are known by their times. The boundary is made of
arcs, on each of which one function is zero, and of corners, where two are. From a point of it the
slopes of all functions say which of them is met next: the corner there is found by Newton's method
on both. Many fronts are followed at a time, so that their runs share the lanes of one batch.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


class Heights(NamedTuple):
    """All functions at one point, by time; the last one is the value at the end.

    Attributes:
        time: of the maxima, and of the end, (functions,).
        value: of the functions.
        slope: their derivatives by place, (functions, 2).
        drift: derivatives of the times by place, (functions, 2).
        rate, rate_slope: of the quantity at the end, by time, and its derivative by place.
        bend: second derivative at the end.
    """

    time: Vector
    value: Vector
    slope: Vector
    drift: Vector
    rate: float
    rate_slope: Vector
    bend: float

    def moved(self, move: Vector) -> Heights:
        """The same a small move away, where they are linear."""
        return self._replace(
            time=self.time + self.drift @ move,
            value=self.value + self.slope @ move,
            rate=self.rate + float(self.rate_slope @ move),
        )

    def greatest(self) -> int:
        """The function that is largest; the end counts where the quantity rises there."""
        return int(np.argmax(self.valid()))

    def valid(self) -> Vector:
        """Values, that at an end where the quantity falls −∞, for a maximum came before."""
        values = self.value.copy()
        if self.rate <= 0.0 and values.size > 1:
            values[-1] = -np.inf
        return values

    def predicted(self, which: int, move: Vector) -> float:
        """The time of a function a move away; beyond the end it is the value at the end."""
        if which < self.time.size - 1:
            return float(self.time[which] + self.drift[which] @ move)
        rate = self.rate + self.rate_slope @ move
        if rate > 0.0 or self.bend >= 0.0:
            return float(self.time[-1])
        return float(self.time[-1] - rate / self.bend)

    def match(self, time: float) -> int | None:
        """The function of about that time; None where there is none."""
        end = self.time.size - 1
        if time >= self.time[-1] and (self.rate > 0.0 or not end):
            return end
        if not end:
            return None
        nearest = int(np.argmin(np.abs(self.time[:-1] - time)))
        gap = np.min(np.abs(np.delete(self.time[:-1], nearest) - self.time[nearest]), initial=6.0)
        if abs(self.time[nearest] - time) < 0.3 * gap:
            return nearest
        return end if self.rate > 0.0 and time > self.time[-1] - 0.3 * gap else None


EXCESS = 5e-10
"""A function that is no further above zero is taken for zero: round-off of a long run."""
ALIKE = 1e-8
"""Functions that are no further from zero meet at a corner."""
Evaluate = Callable[[Vector], list[Heights]]
Ask = Generator[Vector, Heights, "Reached | None"]


class Kind(IntEnum):
    """What a point of the boundary is."""

    smooth = 0
    corner = 1
    border = 2


class Reached(NamedTuple):
    """A point of the boundary: its functions, which of them it lies on, what it is."""

    place: Vector
    heights: Heights
    on: int
    other: int
    kind: Kind


@dataclass(frozen=True)
class Settings:
    """Step control, in units of the square's side.

    Attributes:
        first, shortest, longest: steps along an arc.
        tolerance: of the functions at a point.
        iterations: of Newton's method.
        turn: largest angle between the tangents of neighbours on an arc.
        area: largest doubt of the area under an arc.
        most_points: of a front, for where motions are chaotic a boundary may have no end.
    """

    first: float = 2e-3
    shortest: float = 1e-10
    longest: float = 0.015
    tolerance: float = 1e-10
    iterations: int = 7
    turn: float = 1.2
    area: float = 1e-8
    most_points: int = 1500

    def following(self, length: float, turned: float, doubt: float) -> float:
        """The next step after one of some length along which the tangent turned."""
        bent = 0.5 * self.turn / max(turned, 1e-9)
        right = float((0.3 * self.area / max(doubt, 1e-99)) ** 0.2)
        return length * min(bent, right, 2.0)


def bulge(length: Any, before: Any, after: Any) -> tuple[Any, Any]:
    """Area between an arc and its chord, to the right, and how far that is to be doubted.

    That of the cubic with the arc's angles to the chord is length² (tan after − tan before)/12; of
    an arc of a circle that turns by φ it is φ²/20 less. As much is to be doubted,
    with |before| + |after| for φ, as an S has no turn.
    """
    round_part = (before - after) ** 2 / 20.0
    area = length**2 * (np.tan(after) - np.tan(before)) / 12.0 * (1.0 - round_part)
    return area, length**2 * (np.abs(before) + np.abs(after)) ** 3 / 240.0


@dataclass
class Front:
    """One trace of the boundary from a start, with the region below zero on its left.

    Attributes:
        points: what was reached, the start first.
        direction: 1, or −1 for a trace against the orientation.
        joins: index of the front at whose start it ended, or −1.
        lost: whether it ended for no step was accepted.
    """

    start: Reached
    direction: float = 1.0
    points: list[Reached] = field(default_factory=list)
    joins: int = -1
    lost: bool = False
    tried: float = 0.0

    def tangent(self, at: Reached) -> Vector:
        """The unit direction in which the front goes on."""
        slope = at.heights.slope[at.on]
        return np.asarray(self.direction * np.array([-slope[1], slope[0]]) / np.hypot(*slope))

    def follow(self, starts: Sequence[Reached], settings: Settings) -> Ask:
        """Go on until the border or the start of a front; asks for the functions at points."""
        self.points.append(self.start)
        step, bend, here = settings.first, 0.0, self.start
        while len(self.points) < settings.most_points:
            tangent = self.tangent(here)
            found = yield from self._advance(here, tangent, bend, step, settings)
            if found is None:
                step = 0.4 * self.tried
                if step < settings.shortest:
                    break
                continue
            self.tried = 0.0
            if (joins := passed(here, found, starts)) >= 0:
                self.joins = joins
                return None
            length = float(np.linalg.norm(found.place - here.place))
            turned = _angle(tangent, self.tangent(found))
            doubt = self._doubt(here, tangent, found)
            step = min(settings.following(length, abs(turned), doubt), settings.longest)
            bend = turned / length
            if found.kind == Kind.corner:
                found, bend = self._onwards(found), 0.0
            self.points.append(found)
            if found.kind == Kind.border:
                return None
            here = found
        self.lost = True
        return None

    def _doubt(self, here: Reached, tangent: Vector, there: Reached) -> float:
        """How far the area under an arc is to be doubted."""
        chord = there.place - here.place
        ways = _angle(chord, tangent), _angle(chord, self.tangent(there))
        return float(bulge(np.linalg.norm(chord), *ways)[1])

    def _onwards(self, corner: Reached) -> Reached:
        """A corner as the beginning of the arc that goes on: there all others that meet fall."""
        meet = np.flatnonzero(corner.heights.valid() > -ALIKE)
        meet = np.union1d(meet, [corner.on, corner.other])
        slopes = corner.heights.slope[meet]
        slopes = slopes / np.linalg.norm(slopes, axis=1)[:, None]
        ways = self.direction * np.stack([-slopes[:, 1], slopes[:, 0]])
        rises = slopes @ ways
        np.fill_diagonal(rises, -np.inf)
        return corner._replace(on=int(meet[np.argmin(rises.max(axis=0))]), other=corner.on)

    def _advance(
        self, here: Reached, tangent: Vector, bend: float, step: float, settings: Settings
    ) -> Ask:
        """The next point within a step, a corner if one is met; None where none is found."""
        at, on = here.heights, here.on
        rates = at.slope @ tangent
        with np.errstate(all="ignore"):
            ahead = np.where(rates > 0.0, -at.valid() / rates, np.inf)
        ahead[on] = np.inf
        other = int(np.argmin(ahead))
        bound = _to_border(here.place, tangent)
        if 0.0 < ahead[other] < min(step, bound) and not self.tried:
            found = yield from self._reach(
                here, tangent, bend, float(ahead[other]), other, Kind.corner, settings
            )
            if found is not None:
                return found
            # the other one may touch zero without crossing it
            step = min(step, 4.0 * float(ahead[other]))
        kind = Kind.smooth
        if bound < step:
            step, kind = bound, Kind.border
        self.tried = step
        return (yield from self._reach(here, tangent, bend, step, -1, kind, settings))

    def _reach(
        self,
        here: Reached,
        tangent: Vector,
        bend: float,
        length: float,
        other: int,
        kind: Kind,
        settings: Settings,
    ) -> Ask:
        """The point about a length away, or what comes before it; None where that is not found."""
        normal = np.array([-tangent[1], tangent[0]])
        guess = here.place + length * tangent + 0.5 * bend * length**2 * normal
        reference = here
        for _ in range(6):
            found = yield from _solve(reference, other, guess, kind, tangent, here.place, settings)
            if found is None:
                return None
            move = found.place - here.place
            if not 0.0 < tangent @ move <= 2.0 * length:
                return None
            values = found.heights.valid()
            values[[found.on] + [found.other] * (kind == Kind.corner)] = -np.inf
            worst = int(np.argmax(values))
            if values[worst] > EXCESS:
                # another function came first: the corner with it lies in between
                before = here.heights.match(found.heights.predicted(worst, -move))
                share = 0.5
                if before is not None and here.heights.value[before] < 0.0:
                    low = here.heights.value[before]
                    share = float(low / (low - values[worst]))
                reference, other, kind = found, worst, Kind.corner
                guess = here.place + share * move
            elif not _inside(found.place):
                reference, other, kind, guess = found, -1, Kind.border, found.place
            else:
                turns = abs(_angle(tangent, self.tangent(found))) > settings.turn
                wild = self._doubt(here, tangent, found) > settings.area
                return None if turns or wild or _skipped(here, found) else found
        return None


def _solve(
    reference: Reached,
    other: int,
    guess: Vector,
    kind: Kind,
    tangent: Vector,
    here: Vector,
    settings: Settings,
) -> Ask:
    """Newton's method on the reference's function and what ``kind`` asks for besides."""
    place, last, at, on = guess, reference.place, reference.heights, reference.on
    before, reach = np.inf, 0.5 * float(np.linalg.norm(guess - here)) + settings.shortest
    side = int(np.argmax(np.maximum(-place, place - 1.0))) if kind == Kind.border else 0
    wall = float(place[side] > 0.5)
    for _ in range(settings.iterations):
        times = [at.predicted(each, place - last) for each in (on, other)]
        at, last = (yield place), place
        first, second = at.match(times[0]), at.match(times[1]) if kind == Kind.corner else -1
        if first is None or second is None or first == second:
            return None
        on, other = first, second
        matrix, right = np.empty((2, 2)), np.empty(2)
        matrix[0], right[0] = at.slope[on], at.value[on]
        if kind == Kind.corner:
            matrix[1], right[1] = at.slope[other], at.value[other]
        elif kind == Kind.border:
            matrix[1], right[1] = np.eye(2)[side], place[side] - wall
        else:
            matrix[1], right[1] = tangent, tangent @ (place - guess)
        error = float(np.abs(right).max())
        if error <= settings.tolerance:
            return Reached(place, at, on, other, kind)
        if error > 0.5 * before:
            return None
        determinant = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
        if abs(determinant) < 1e-14 * np.abs(matrix).max() ** 2:
            return None
        move = np.asarray(-np.linalg.solve(matrix, right), np.float64)
        growth = error / before**2 if before < np.inf else 1e4
        if growth * error**2 <= 0.1 * settings.tolerance:
            # the next error is about the square of this one: it is not run for
            return Reached(place + move, at.moved(move), on, other, kind)
        place, before = place + move, error
        if not np.linalg.norm(place - guess) < reach or not _inside(place, 0.05):
            return None
    return None


def _skipped(here: Reached, there: Reached) -> bool:
    """Whether another function rises above zero between two points: cubics along the chord."""
    chord, a, b = there.place - here.place, here.heights, there.heights
    if min(a.time.size, b.time.size) < 2:
        return False
    times = a.time[:-1] + a.drift[:-1] @ chord
    after = np.abs(b.time[:-1] - times[:, None]).argmin(axis=1)
    same = np.abs(b.time[after] - times) < 0.5
    same &= (a.value[:-1] < -ALIKE) & (b.value[after] < -ALIKE)
    first, last = a.slope[:-1] @ chord, b.slope[after] @ chord
    rows = np.flatnonzero(same & (first > 0.0) & (last < 0.0))
    v, w, r, q = a.value[rows], b.value[after[rows]], first[rows], last[rows]
    t = np.linspace(0.0, 1.0, 17)[:, None]
    cubic = (1 + 2 * t) * (1 - t) ** 2 * v + t * (1 - t) ** 2 * r
    cubic += t**2 * (3 - 2 * t) * w - t**2 * (1 - t) * q
    return bool((cubic > 0.01 * (r - q)).any())


def _inside(place: Vector, beyond: float = 1e-12) -> bool:
    return bool((place >= -beyond).all() and (place <= 1.0 + beyond).all())


def _to_border(place: Vector, tangent: Vector) -> float:
    """How far the square goes on in a direction."""
    with np.errstate(all="ignore"):
        far = np.where(tangent > 0.0, (1.0 - place) / tangent, -place / tangent)
    return float(np.nanmin(np.where(tangent == 0.0, np.inf, far)))


def _angle(a: Vector, b: Vector) -> float:
    return float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b))


def passed(here: Reached, there: Reached, starts: Sequence[Reached]) -> int:
    """The index of a start on the part of an arc between two points, or −1."""
    chord = there.place - here.place
    length = float(np.linalg.norm(chord))
    if not length:
        return -1
    unit = chord / length
    times = here.heights.time[here.on], there.heights.time[there.on]
    best, found = np.inf, -1
    for index, start in enumerate(starts):
        move = start.place - here.place
        along = float(unit @ move)
        if not 1e-12 < along <= length + 1e-12:
            continue
        aside = abs(float(unit[0] * move[1] - unit[1] * move[0]))
        share = along / length
        time = times[0] + share * (times[1] - times[0])
        near = abs(start.heights.time[start.on] - time) < 0.3 + 0.3 * abs(times[1] - times[0])
        if aside < 0.1 * length and near and along < best:
            best, found = along, index
    return found


def start_on(
    evaluate: Evaluate, inside: Vector, outside: Vector, settings: Settings
) -> list[Reached | None]:
    """A point of the boundary on each line from a point inside to one outside, (lines, 2).

    Bracketed Newton's method on the largest function; None where it does not converge.
    """
    low, high = np.zeros(len(inside)), np.ones(len(inside))
    way, share = outside - inside, np.full(len(inside), 0.5)
    found: list[Reached | None] = [None] * len(inside)
    left = np.arange(len(inside))
    for _ in range(60):
        if not left.size:
            break
        places = inside[left] + share[left, None] * way[left]
        going = []
        for row, place, at in zip(left, places, evaluate(places), strict=True):
            on = at.greatest()
            value = at.value[on]
            if abs(value) <= settings.tolerance:
                found[row] = Reached(place, at, on, -1, Kind.smooth)
                continue
            low[row], high[row] = (share[row], high[row]) if value < 0.0 else (low[row], share[row])
            slope = at.slope[on] @ way[row]
            new = share[row] - value / slope if slope else np.nan
            share[row] = new if low[row] < new < high[row] else 0.5 * (low[row] + high[row])
            going.append(row)
        left = np.array(going, int)
    return found


def follow_all(
    evaluate: Evaluate, fronts: Sequence[Front], starts: Sequence[Reached], settings: Settings
) -> None:
    """Follow all fronts, one batch of evaluations after the other."""
    waiting = {}
    for front in fronts:
        asking = front.follow(starts, settings)
        waiting[id(front)] = asking, next(asking)
    while waiting:
        answers = evaluate(np.array([place for _, place in waiting.values()]))
        for (key, (asking, _)), heights in zip(list(waiting.items()), answers, strict=True):
            try:
                waiting[key] = asking, asking.send(heights)
            except StopIteration:
                del waiting[key]
