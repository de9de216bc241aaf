"""Find the value of a parameter beyond which steady sliding is the only motion.

Idea: every other motion is followed until it disappears. Another value may have been tried from a
motion at a distant one, which is no start of what lasts there; so motions are led to the quiet
value in steps that halve, and followed beyond it in steps that grow while they last.

Invariant: a value counts as quiet from any start if none of the starts that were tried there lasts:
motions that were followed, the sudden start, and strikes or random starts. Cost: a handful of runs
for each value. Each side of a parameter is searched by a generator, which yields starts and is sent
what they settle to, so that the runs of all sides are made together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import takewhile
from typing import Any, Protocol, TypeVar

import numpy as np

from squealpipe.systems.progress import report
from squealpipe.vibration.boundaries import Cure, thinned
from squealpipe.vibration.settled_runs import SettledRun, Start
from squealpipe.vibration.settling import difference, settling_of_verdicts


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


_Found = TypeVar("_Found")
_Search = Generator[list[Start], list[SettledRun], _Found]
"""Search that yields starts, is sent the runs of them, and returns what it has found."""

MOTIONS, OWN_STARTS = (0,), (1, 2)
"""Kinds of starts: the motions that are followed; the sudden start, and strikes or random ones."""


@dataclass
class Side:
    """One side of the present value of one cure.

    Attributes:
        values: outward.
        inner: the last value known to be like the present one, in what is tested.
        outer: the nearest one known not to be; NaN: none.
        answer: what was found; NaN: nothing.
        motions: states of motions that last at the value tried last at which any does.
        all_die_out: values at which the sudden start and all others die out.
    """

    name: str
    cure: Cure
    values: np.ndarray
    inner: float
    outer: float = math.nan
    answer: float = math.nan
    motions: list[np.ndarray] = field(default_factory=list)
    all_die_out: set[float] = field(default_factory=set)

    def scale(self, value: float) -> float:
        """Distance next to a value that counts as located."""
        return self.cure.scale(Following.located, value)

    def distance(self, value: float) -> float:
        """Distance from the present value."""
        return abs(value - self.cure.value)

    def beyond(self, value: float) -> float:
        """The next value outward that counts as another, within the range."""
        farthest = float(self.values[-1])
        step = math.copysign(self.scale(value), farthest - self.cure.value)
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
    sides: Sequence[Side],
    nearest: Mapping[str, float],
    subjects: Subjects,
    *,
    quiet: bool,
    always: bool,
    closely: bool = True,
) -> dict[str, float]:
    """Return where the verdict from any start changes: at ``quiet_from``, beyond or before it.

    Args:
        sides: of the cures, with the motions that last now.
        nearest: ``quiet_from`` of each cure.
        quiet: whether a push dies out now.
        always: whether any start does.
        closely: whether motions are followed; otherwise the answer is the nearest value tried.
    """
    reach = {
        side.name: side.distance(nearest.get(side.name, math.nan))
        for side in sides
        if always
    }
    searches = []
    for side in sides:
        answer = nearest.get(side.name, math.nan)
        ahead = (answer - side.cure.value) * (side.values[0] - side.cure.value) > 0
        exact = answer if ahead else math.nan
        if quiet:
            way = _of_quiet(side, exact, reach, subjects, always, closely)
        elif ahead:
            way = _of_noisy(side, exact, subjects, closely)
        else:
            continue
        searches.append(way)
    side_by_side(searches, subjects.settle)
    return nearer(cures, sides)


def side_by_side(
    searches: Sequence[_Search[None]],
    settle: Callable[[Sequence[Start]], Sequence[SettledRun]],
) -> None:
    """Run generators to their ends; what they ask for at a time is settled together."""
    # rounds after which a search is told to be half done; one takes ten to forty
    typical = 20
    answers: dict[int, Any] = dict.fromkeys(range(len(searches)))
    rounds = 0
    while answers:
        asked: dict[int, list[Start]] = {}
        for number, runs in answers.items():
            with suppress(StopIteration):
                asked[number] = searches[number].send(runs)
        rounds += 1
        left = len(asked) / len(searches) * typical / (typical + rounds)
        report(partial(float, 1.0 - left))
        starts = [start for those in asked.values() for start in those]
        settled = iter(settle(starts) if starts else [])
        answers = {
            number: [next(settled) for _ in those] for number, those in asked.items()
        }


def _of_quiet(
    side: Side,
    exact: float,
    reach: dict[str, float],
    subjects: Subjects,
    always: bool,
    closely: bool,
) -> _Search[None]:
    """Search a side of a subject that is quiet after a push.

    Args:
        exact: where pushes cease to die out on this side, NaN: nowhere.
        reach: for each cure how far the answer is at most, if any start dies out now; what is
            farther on either side is not looked at.
    """
    now = side.cure.value
    if not math.isnan(exact):
        inside = side.values[np.abs(side.values - now) < side.distance(exact)]
        # a boundary nearer than the first value needs one on the way to it, too
        side.values = inside if inside.size else np.array([0.5 * (now + exact)])
    trials = thinned(side.values)
    if math.isnan(exact):
        trials = _shown(side, trials, subjects)
    if always:
        side.answer = exact  # quiet from any start as far as it is quiet
    for trial in trials:
        if side.distance(side.inner) >= reach.get(side.name, math.inf):
            return
        if (yield from dies_out(side, trial, subjects)) != always:
            side.outer = trial
            break
        side.inner = trial
    yield from _located(side, reach, subjects, always, closely)


def _of_noisy(
    side: Side, exact: float, subjects: Subjects, closely: bool
) -> _Search[None]:
    """Search the side of a noisy subject on which pushes die out from ``exact`` on."""
    if closely:
        yield from lead(side, exact, subjects)
    side.inner = exact
    outer = side.values[np.abs(side.values - side.cure.value) > side.distance(exact)]
    trials = thinned(outer)
    trials = [side.beyond(exact), *trials[1:]]
    for trial in trials:
        if (yield from dies_out(side, trial, subjects)):
            if side.inner == exact:
                side.answer = exact
                return
            side.outer = trial
            break
        side.inner = trial
    yield from _located(side, {}, subjects, False, closely)


def _shown(side: Side, trials: list[float], subjects: Subjects) -> list[float]:
    """Values up to the first at which strikes decay too slowly to be told from what lasts."""

    def is_slow(value: float) -> bool:
        return subjects.fading(side.cure.apply(value)) > -Following.fades

    if is_slow(side.cure.value):
        return trials
    return list(takewhile(lambda value: not is_slow(value), trials))


def _located(
    side: Side, reach: dict[str, float], subjects: Subjects, always: bool, closely: bool
) -> _Search[None]:
    """Bisect the bracket of a side, if it has one, and follow the motion at its lasting end."""
    if math.isnan(side.outer):
        return
    while closely and abs(side.outer - side.inner) > side.scale(
        min(side.inner, side.outer, key=abs)
    ):
        if always:  # a motion is followed towards the present value
            best = reach.get(side.name, math.nan)
            if side.distance(side.inner) >= best:
                return
            reach[side.name] = min(side.distance(side.outer), best)
        middle = 0.5 * (side.inner + side.outer)
        if (yield from dies_out(side, middle, subjects)) == always:
            side.inner = middle
        else:
            side.outer = middle
    side.answer = side.inner if always else side.outer
    if closely:
        yield from _follow(side, subjects, always)


def _follow(side: Side, subjects: Subjects, always: bool) -> _Search[None]:
    """Follow the motion at the lasting end of the bracket to where it ends.

    Another value may have been tried from a motion at a distant one, which is no start of what
    lasts there. Steps grow while the motion lasts; before one in which it dies out counts, it is
    tried in smaller ones. Where it ends no other start may last either, or that is followed.
    """
    lasting, other = (side.outer, side.inner) if always else (side.inner, side.outer)
    size = other - lasting
    end = side.cure.value if always else float(side.values[-1])
    while True:
        ahead = min(lasting + size, end, key=lambda value: abs(value - lasting))
        least = side.scale(min(lasting, ahead, key=abs))
        is_small = abs(size) <= least * (1.0 + 1e-9)
        gone = yield from dies_out(side, ahead, subjects, MOTIONS)
        if gone and is_small:
            gone = yield from dies_out(side, ahead, subjects, OWN_STARTS)
        if not gone:
            side.answer = end if always else math.nan
            lasting, size = ahead, 2.0 * size
            if lasting == end:
                return
            continue
        side.answer = ahead
        if is_small:
            return
        size = math.copysign(max(0.25 * abs(size), least), size)


def lead(side: Side, quiet_from: float, subjects: Subjects) -> _Search[None]:
    """Lead the motions of a side to the values next to where pushes die out.

    From the present value to one beyond ``quiet_from`` they could leave their basin, although they
    last there. What is left of the way is halved until the boundary of any start is not located
    any finer.
    """
    way, left = quiet_from - side.cure.value, 1.0 - Following.along
    while side.motions:
        subject = side.cure.apply(side.cure.value + (1.0 - left) * way)
        # none where it has no steady sliding
        runs = yield [
            replace(start, is_led=True)
            for start in subjects.starts(subject, 0, side.motions)
        ]
        lasting = [run.last.final for run in runs if run.lasts]
        side.motions = lasting or side.motions
        if not lasting or abs(left * way) <= side.scale(quiet_from):
            return
        left *= 0.5


def different_motions(runs: Sequence[SettledRun]) -> list[np.ndarray]:
    """Return the last states of the first runs that are not known to show the same motion."""
    kept: list[SettledRun] = []
    for run in runs:
        if len(kept) < Following.most_motions and not any(
            run.agrees
            and run.verdict is other.verdict
            and difference(run.last.levels(1.0), other.last.levels(1.0))
            <= settling_of_verdicts.agreement
            for other in kept
        ):
            kept.append(run)
    return [run.last.final for run in kept]


def dies_out(
    side: Side,
    value: float,
    subjects: Subjects,
    kinds: Iterable[int] = (*MOTIONS, *OWN_STARTS),
) -> _Search[bool]:
    """Find whether a side's subject is quiet from all starts, one kind of them after the other.

    First the motions that last at its last value are followed, which finds where they end.
    """
    subject = side.cure.apply(value)
    if not subjects.is_quiet_linearly(subject):
        return False
    for kind in kinds:
        if kind in OWN_STARTS and value in side.all_die_out:
            continue
        runs = yield subjects.starts(subject, kind, side.motions)
        lasting = different_motions([run for run in runs if run.lasts])
        if lasting:
            side.motions = lasting
            return False
        if kind == OWN_STARTS[-1]:
            side.all_die_out.add(value)
    return True
