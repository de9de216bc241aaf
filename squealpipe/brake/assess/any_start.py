"""Where no other motion lasts beside steady sliding: motions are followed to where they end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Self

import numpy as np

from squealpipe.brake.assess.designs import Cure
from squealpipe.brake.assess.search import Side, Test, bisect, nearer, thinned
from squealpipe.brake.assess.settling import MOST, settle, start_at
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.schema.assess import KICKS
from squealpipe.vibration.settled_runs import Start

LOCATED_ANY = 1e-2
"""To which the boundary of any start is located: of the value, or rad."""

ALONG = 0.95
"""How far towards ``quiet_from``, over the whole way, a lasting motion is led before it is followed
in small steps."""

FADES = 6.0
"""Decay of a strike until it is as small as a push, in logarithm."""

MOST_MOTIONS = 2
"""Motions of a side that are followed at most."""


def any_start(
    cures: dict[str, Cure],
    every: Sequence[Side],
    nearest: dict[str, float],
    quiet: bool,
    always: bool,
    test: Test,
    follow: Test,
) -> dict[str, float]:
    """Where the verdict from any start changes; at ``quiet_from`` or beyond it, or before it."""
    sides = []
    for side in every:
        answer = nearest.get(side.name, math.nan)
        ahead = (answer - side.cure.value) * (side.values[0] - side.cure.value) > 0
        if not quiet:
            if not ahead:
                continue
            side.inner = answer
        elif ahead:
            inside = np.abs(side.values - side.cure.value) < abs(
                answer - side.cure.value
            )
            side.values = side.values[inside]
        side.exact = answer if ahead else math.nan
        if side.values.size:
            sides.append(side)
    for side in sides:
        beyond = np.abs(side.values - side.cure.value) > abs(
            side.inner - side.cure.value
        )
        outer = side.values[beyond]
        side.rungs = thinned(outer)
        if not quiet:
            side.rungs = [side.beyond(side.inner, LOCATED_ANY), *side.rungs[1:]]
        elif math.isnan(side.exact):
            side.rungs = _shown(side)
    climbed = _climb(sides, quiet=quiet, always=always, test=test, follow=follow)
    return nearer(cures, climbed)


def _shown(side: Side) -> list[float]:
    """Values up to the first at which strikes decay too slowly to be told from what lasts."""

    def is_slow(value: float) -> bool:
        design = side.cure.apply(value)
        sliding = Sliding.of(design)
        if sliding is None or sliding.is_unstable:
            return False
        return sliding.growth_rate * design.period * MOST > -FADES

    if is_slow(side.cure.value):
        return side.rungs
    return list(takewhile(lambda value: not is_slow(value), side.rungs))


def _climb(
    sides: list[Side], *, quiet: bool, always: bool, test: Test, follow: Test
) -> list[Side]:
    """Test the rungs of each side outward, and bisect where the answer changes."""
    waiting = [side for side in sides if side.rungs]
    while waiting:
        answers = test(waiting, [side.rungs[0] for side in waiting])
        for side, dies in zip(waiting, answers, strict=True):
            rung = side.rungs.pop(0)
            if dies == always:
                side.inner = rung
            elif not quiet and side.inner == side.exact:
                side.answer, side.rungs = side.exact, []
            else:
                side.outer, side.rungs = rung, []
        waiting = [side for side in waiting if side.rungs]
    open_sides = [side for side in sides if math.isnan(side.answer)]
    bisect(open_sides, always, test, LOCATED_ANY)
    brackets = [side for side in open_sides if not math.isnan(side.outer)]
    _follow(brackets, always, follow, test)
    if always:
        for side in sides:
            if math.isnan(side.answer):
                side.answer = side.exact  # quiet from any start as far as it is quiet
    return sides


def _follow(sides: Sequence[Side], always: bool, follow: Test, test: Test) -> None:
    """Follow the motion at the lasting end of each bracket to where it ends.

    Another value may have been tried from a motion at a distant one, which is no start of what
    lasts there. Steps grow while the motion lasts; before one in which it dies out counts, it is
    tried in smaller ones. Where it ends no other start may last either, or that is followed.
    """
    open_ones = [_Step.of(side, always) for side in sides]
    while open_ones:
        at = [step.next for step in open_ones]
        dies = follow([step.side for step in open_ones], at)
        ends = [
            step
            for step, gone in zip(open_ones, dies, strict=True)
            if gone and step.is_small
        ]
        dies_always = test([step.side for step in ends], [step.next for step in ends])
        left = [step for step, gone in zip(ends, dies_always, strict=True) if not gone]
        open_ones = [
            step
            for step, gone in zip(open_ones, dies, strict=True)
            if (step.lasts() if not gone or step in left else step.ended())
        ]


@dataclass(eq=False)
class _Step:
    """One step from a value at which a motion lasts towards one at which it may not.

    Attributes:
        lasting: the value at which it lasts.
        size: of the step, with its sign.
        end: the last value of the range.
    """

    side: Side
    always: bool
    lasting: float
    size: float
    end: float

    @classmethod
    def of(cls, side: Side, always: bool) -> Self:
        if always:
            size = side.inner - side.outer
            return cls(side, always, side.outer, size, side.cure.value)
        size = side.outer - side.inner
        return cls(side, always, side.inner, size, float(side.values[-1]))

    @property
    def next(self) -> float:
        """Where the step leads, within the range."""
        ends = (self.lasting + self.size, self.end)
        return min(ends, key=lambda value: abs(value - self.lasting))

    @property
    def is_small(self) -> bool:
        """Whether the step is as small as a boundary is located."""
        near = min(self.lasting, self.next, key=abs)
        return abs(self.size) <= self.side.scale(LOCATED_ANY, near) * (1.0 + 1e-9)

    def lasts(self) -> bool:
        """Take the step; whether the range goes on."""
        self.lasting, self.size = self.next, 2.0 * self.size
        self.side.answer = self.end if self.always else math.nan
        return self.lasting != self.end

    def ended(self) -> bool:
        """Note where the motion dies out; whether a smaller step is to be tried."""
        self.side.answer = self.next
        if self.is_small:
            return False
        least = self.side.scale(LOCATED_ANY, min(self.lasting, self.next, key=abs))
        self.size = math.copysign(max(0.25 * abs(self.size), least), self.size)
        return True


def lead(sides: Sequence[Side], nearest: dict[str, float], *, tol: float) -> None:
    """Lead the motions of each side that has a ``quiet_from`` to the values next to it.

    From the present value to one beyond ``quiet_from`` they could leave their basin, although they
    last there. What is left of the way is halved until the boundary of any start is not located
    any finer.
    """
    ways = {}
    for row, side in enumerate(sides):
        way = nearest.get(side.name, math.nan) - side.cure.value
        if side.motions and way * (side.values[0] - side.cure.value) > 0:
            ways[row] = way
    left = 1.0 - ALONG
    while ways:
        led = [
            (row, sides[row].cure.apply(sides[row].cure.value + (1.0 - left) * way))
            for row, way in ways.items()
        ]
        starts = [
            start_at(design, Sliding.of(design), state)
            for row, design in led
            for state in sides[row].motions
        ]
        ends = iter(settle(starts, tol=tol))
        for row, _ in led:
            settled = [next(ends) for _ in sides[row].motions]
            lasting = [each.last.final for each in settled if each.lasts]
            quiet_from = nearest[sides[row].name]
            near = sides[row].scale(LOCATED_ANY, quiet_from)
            sides[row].motions = lasting or sides[row].motions
            if not lasting or abs(left * ways[row]) <= near:
                del ways[row]
        left *= 0.5


def dies_out_always(
    sides: Sequence[Side], values: Sequence[float], *, tol: float, kinds: int = 3
) -> list[bool]:
    """Whether each side's design is quiet from all starts, tried one kind after the other.

    First the motions that last at its last value are followed, which finds where they end; then
    come rest under the whole preload, and strikes.

    Args:
        kinds: how many of the three kinds are tried.
    """
    answers = [False] * len(sides)
    open_rows: dict[int, tuple[Design, Sliding]] = {}
    for row, (side, value) in enumerate(zip(sides, values, strict=True)):
        design = side.cure.apply(value)
        sliding = Sliding.of(design)
        if sliding is not None and not sliding.is_unstable:
            answers[row], open_rows[row] = True, (design, sliding)
    for kind in range(kinds):
        owners, starts = [], []
        for row, (design, sliding) in open_rows.items():
            states = [sides[row].motions, [np.zeros(4)], []][kind]
            made = [start_at(design, sliding, state) for state in states]
            made += strikes(design, sliding) if kind == 2 else []
            starts += made
            owners += [row] * len(made)
        lasting: dict[int, list[np.ndarray]] = {}
        for row, settled in zip(
            owners, settle(starts, tol=tol) if starts else [], strict=True
        ):
            if settled.lasts:
                lasting.setdefault(row, []).append(settled.last.final)
        for row, states in lasting.items():
            answers[row], sides[row].motions = False, states[:MOST_MOTIONS]
            del open_rows[row]
    return answers


def strikes(design: Design, sliding: Sliding) -> list[Start]:
    """Steady sliding, struck."""
    speed = design.params.preload * design.rate
    along = design.params.belt_direction
    return [
        start_at(
            design,
            sliding,
            sliding.state + speed * np.array([0.0, 0.0, along * first, second]),
        )
        for first, second in KICKS
    ]
