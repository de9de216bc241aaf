"""Find the value of a parameter beyond which steady sliding is the only motion.

Idea: every other motion is followed until it disappears. Another value may have been tried from a
motion at a distant one, which is no start of what lasts there; so motions are led to the quiet
value in steps that halve, and followed beyond it in steps that grow while they last.

Invariant: a value counts as quiet from any start if none of the starts that were tried there lasts:
motions that were followed, the sudden start, and strikes or random starts. Cost: a handful of runs
for each value.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile
from typing import Any, Protocol, Self

import numpy as np

from squealpipe.vibration.boundaries import Cure, thinned
from squealpipe.vibration.settled_runs import SettledRun, Start


@dataclass(frozen=True)
class Following:
    """Thresholds of following; each comment says what another value would do."""

    located: float = 1e-2
    """Width to which the boundary of any start is located: of the value, or rad. Half as much: one
    run more, and twice as many small steps where a motion ends."""
    along: float = 0.95
    """Share of the way to the quiet value that a motion is led at once. More: it may leave its
    basin, although it lasts there."""
    fades: float = 6.0
    """Decay of a strike until it is as small as a push, in logarithm: up to where strikes decay
    slower than that within a run, they cannot be told from what lasts."""
    most_motions: int = 2
    """Motions of a side that are followed at most; more cost a run each for every value."""


class Subjects(Protocol):
    """Functions that the search asks of the subjects that a cure makes."""

    def is_quiet_linearly(self, subject: Any) -> bool:
        """Tell whether steady sliding exists, and small motions about it do not grow."""

    def push(self, subject: Any) -> Start | None:
        """Return steady sliding, pushed in the direction in which small motions grow fastest.

        None where that surely dies out, and need not be run.
        """

    def fading(self, subject: Any) -> float:
        """Return ln of the decay of small motions within the longest run; NaN where they grow."""

    def starts(
        self, subject: Any, number: int, motions: Sequence[np.ndarray]
    ) -> list[Start]:
        """Return one kind of starts: 0 the states of motions, 1 a sudden start, 2 all others."""

    def settle(self, starts: Sequence[Start]) -> list[SettledRun]:
        """Run starts until they have settled."""


Test = Callable[[Sequence["Side"], Sequence[float]], list[bool]]
"""Test that tells whether the subjects of some sides at some values are quiet."""


@dataclass
class Side:
    """One side of the present value of one cure.

    Attributes:
        values: outward.
        inner: the last value known to be like the present one, in what is tested.
        exact: the linear boundary, if the answer may be that.
        trial_values: those to run, outward.
        answer: what was found; NaN: nothing.
        motions: states of motions that last at the value tried last at which any does.
    """

    name: str
    cure: Cure
    values: np.ndarray
    inner: float
    exact: float = math.nan
    trial_values: list[float] = field(default_factory=list)
    answer: float = math.nan
    outer: float = math.nan
    motions: list[np.ndarray] = field(default_factory=list)

    def scale(self, located: float, value: float) -> float:
        """Distance next to a value that counts as located."""
        return self.cure.scale(located, value)

    def beyond(self, value: float, located: float) -> float:
        """The next value outward that counts as another, within the range."""
        farthest = float(self.values[-1])
        step = math.copysign(self.scale(located, value), farthest - self.cure.value)
        return min((value + step, farthest), key=lambda end: abs(end - value))


def sides_of(cures: Mapping[str, Cure]) -> list[Side]:
    """Both sides of each cure, as far as there are any values."""
    return [
        Side(name, cure, values, cure.value)
        for name, cure in cures.items()
        for values in (cure.below, cure.above)
        if values.size
    ]


def nearer(cures: Mapping[str, Cure], sides: Sequence[Side]) -> dict[str, float]:
    """The nearer answer of both sides of each cure that has one."""
    steps: dict[str, float] = {}
    for side in sides:
        value = cures[side.name].value
        best = steps.get(side.name, math.nan)
        if not math.isnan(side.answer) and not abs(best - value) <= abs(
            side.answer - value
        ):
            steps[side.name] = side.answer
    return steps


def any_start(
    cures: Mapping[str, Cure],
    every: Sequence[Side],
    nearest: Mapping[str, float],
    quiet: bool,
    always: bool,
    subjects: Subjects,
    test: Test,
    follow: Test | None,
) -> dict[str, float]:
    """Return where the verdict from any start changes: at ``quiet_from``, beyond or before it.

    Args:
        every: sides of the cures, with the motions that last now.
        nearest: ``quiet_from`` of each cure.
        quiet: whether a push dies out now.
        always: whether any start does.
        test: whether all starts die out.
        follow: whether the motions that are followed do; None: the answer is the nearest value
            tried, and no motion is followed to it.
    """
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
            # a boundary nearer than the first value needs one on the way to it, too
            half_way = np.array([0.5 * (side.cure.value + answer)])
            side.values = side.values[inside] if inside.any() else half_way
        side.exact = answer if ahead else math.nan
        if side.values.size:
            sides.append(side)
    for side in sides:
        beyond = np.abs(side.values - side.cure.value) > abs(
            side.inner - side.cure.value
        )
        outer = side.values[beyond]
        side.trial_values = thinned(outer)
        if not quiet:
            side.trial_values = [
                side.beyond(side.inner, Following.located),
                *side.trial_values[1:],
            ]
        elif math.isnan(side.exact):
            side.trial_values = _shown(side, subjects)
    climbed = _climb(sides, quiet=quiet, always=always, test=test, follow=follow)
    return nearer(cures, climbed)


def _shown(side: Side, subjects: Subjects) -> list[float]:
    """Values up to the first at which strikes decay too slowly to be told from what lasts."""

    def is_slow(value: float) -> bool:
        return subjects.fading(side.cure.apply(value)) > -Following.fades

    if is_slow(side.cure.value):
        return side.trial_values
    return list(takewhile(lambda value: not is_slow(value), side.trial_values))


def _climb(
    sides: list[Side], *, quiet: bool, always: bool, test: Test, follow: Test | None
) -> list[Side]:
    """Test the trial values of each side outward, and bisect where the answer changes."""
    waiting = [side for side in sides if side.trial_values]
    while waiting:
        answers = test(waiting, [side.trial_values[0] for side in waiting])
        for side, dies in zip(waiting, answers, strict=True):
            trial = side.trial_values.pop(0)
            if dies == always:
                side.inner = trial
            elif not quiet and side.inner == side.exact:
                side.answer, side.trial_values = side.exact, []
            else:
                side.outer, side.trial_values = trial, []
        waiting = [side for side in waiting if side.trial_values]
    open_sides = [side for side in sides if math.isnan(side.answer)]
    located = math.inf if follow is None else Following.located
    bisect(open_sides, always, test, located)
    brackets = [side for side in open_sides if not math.isnan(side.outer)]
    if follow is not None:
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
        last_steps = [
            step
            for step, gone in zip(open_ones, dies, strict=True)
            if gone and step.is_small
        ]
        dies_always = test(
            [step.side for step in last_steps], [step.next for step in last_steps]
        )
        left = [
            step for step, gone in zip(last_steps, dies_always, strict=True) if not gone
        ]
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
        """Return where the step leads, within the range."""
        reach = (self.lasting + self.size, self.end)
        return min(reach, key=lambda value: abs(value - self.lasting))

    @property
    def is_small(self) -> bool:
        """True if the step is as small as a boundary is located."""
        near = min(self.lasting, self.next, key=abs)
        return abs(self.size) <= self.side.scale(Following.located, near) * (1.0 + 1e-9)

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
        least = self.side.scale(
            Following.located, min(self.lasting, self.next, key=abs)
        )
        self.size = math.copysign(max(0.25 * abs(self.size), least), self.size)
        return True


def lead(
    sides: Sequence[Side], nearest: Mapping[str, float], subjects: Subjects
) -> None:
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
    left = 1.0 - Following.along
    while ways:
        owners: list[int] = []
        starts: list[Start] = []
        for row, way in ways.items():
            cure = sides[row].cure
            subject = cure.apply(cure.value + (1.0 - left) * way)
            # none where it has no steady sliding
            made = [
                replace(start, is_led=True)
                for start in subjects.starts(subject, 0, sides[row].motions)
            ]
            starts += made
            owners += [row] * len(made)
        runs = list(zip(owners, subjects.settle(starts), strict=True))
        for row in list(ways):
            lasting = [
                run.last.final for owner, run in runs if owner == row and run.lasts
            ]
            quiet_from = nearest[sides[row].name]
            near = sides[row].scale(Following.located, quiet_from)
            sides[row].motions = lasting or sides[row].motions
            if not lasting or abs(left * ways[row]) <= near:
                del ways[row]
        left *= 0.5


def dies_out_always(
    sides: Sequence[Side],
    values: Sequence[float],
    *,
    subjects: Subjects,
    kinds: int = 3,
) -> list[bool]:
    """Tell whether each side's subject is quiet from all starts, tried one kind after the other.

    First the motions that last at its last value are followed, which finds where they end.

    Args:
        kinds: how many of the three kinds of starts are tried.
    """
    answers = [False] * len(sides)
    open_rows: dict[int, Any] = {}
    for row, (side, value) in enumerate(zip(sides, values, strict=True)):
        subject = side.cure.apply(value)
        if subjects.is_quiet_linearly(subject):
            answers[row], open_rows[row] = True, subject
    for number in range(kinds):
        owners: list[int] = []
        starts: list[Start] = []
        for row, subject in open_rows.items():
            made = subjects.starts(subject, number, sides[row].motions)
            starts += made
            owners += [row] * len(made)
        lasting: dict[int, list[np.ndarray]] = {}
        runs = subjects.settle(starts) if starts else []
        for row, settled in zip(owners, runs, strict=True):
            if settled.lasts:
                lasting.setdefault(row, []).append(settled.last.final)
        for row, states in lasting.items():
            answers[row] = False
            sides[row].motions = states[: Following.most_motions]
            del open_rows[row]
    return answers


def bisect(sides: Sequence[Side], quiet: bool, test: Test, located: float) -> None:
    """Answers of the sides that have a bracket, side by side."""
    while True:
        wide = [
            side
            for side in sides
            if not math.isnan(side.outer)
            and abs(side.outer - side.inner)
            > side.scale(located, min(side.inner, side.outer, key=abs))
        ]
        if not wide:
            break
        middles = [0.5 * (side.inner + side.outer) for side in wide]
        answers = test(wide, middles)
        for side, at, dies in zip(wide, middles, answers, strict=True):
            if dies == quiet:
                side.inner = at
            else:
                side.outer = at
    for side in sides:
        if not math.isnan(side.outer):
            side.answer = side.inner if quiet else side.outer
