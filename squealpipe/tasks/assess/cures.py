"""Where a brake turns quiet, or, of a quiet one, where it no longer is: one change at a time.

Steady sliding that is linearly unstable is never quiet, so each side of the present value is
searched along the linear boundary first, which costs no run. Runs next to it, and farther out, then
tell whether the motion dies out there. Where it does right beside the linear boundary, that
boundary is the answer; else runs bisect. All cures are tested side by side in one ensemble.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from squealpipe.schema.assess import CURES, Verdict
from squealpipe.tasks.assess.designs import FARTHEST, STEP, Cure, cures_of
from squealpipe.tasks.assess.settling import Start, pushed, settle, start_at
from squealpipe.tasks.assess.sliding import Design, Sliding

LOCATED = 1e-3
"""To which a boundary is located: of the value, or rad."""
LOCATED_ANY = 1e-2
"""The same, for the verdict from any start."""
RUNGS = 8
"""Values beyond the linear boundary that are run at most."""
RAYS = 24
"""Directions in which the nearest quiet pair of angles is looked for."""
HALVINGS = 50
"""Bisections of the linear boundary."""
KICKS = ((0.0, 1.0), (-1.0, -0.5), (1.0, 2.0))
"""Velocities of strikes along and across the belt, over l_pre √((k1 + k2)/2m)."""

Test = Callable[[Sequence[Design]], list[bool]]


class Boundary(NamedTuple):
    """What is known of one cure; values that were not found are NaN."""

    value: float
    quiet_from: float
    quiet_from_any_start: float
    change: float
    change_any_start: float
    lowest: float
    highest: float


@dataclass
class Side:
    """One side of the present value of one cure.

    Attributes:
        values: outward.
        inner: the last value known to be like the present one, in what is tested.
        exact: the linear boundary, if the answer may be that.
        rungs: values to run, outward.
        answer: what was found; NaN: nothing.
    """

    name: str
    cure: Cure
    values: np.ndarray
    inner: float
    exact: float = math.nan
    rungs: list[float] = field(default_factory=list)
    answer: float = math.nan
    outer: float = math.nan

    def scale(self, located: float) -> float:
        """Distance that counts as located."""
        if self.name.startswith("alpha"):
            return located
        return located * max(abs(self.cure.value), abs(float(self.inner)), 1e-12)

    def beyond(self, value: float, located: float) -> float:
        """The next value outward that counts as another, within the range."""
        farthest = float(self.values[-1])
        step = math.copysign(self.scale(located), farthest - self.cure.value)
        return min((value + step, farthest), key=lambda end: abs(end - value))


def boundaries(
    design: Design, verdict: Verdict, motions: Sequence[np.ndarray], *, tol: float
) -> dict[str, Boundary]:
    """All cures of a design.

    Args:
        verdict: of its steady sliding, pushed.
        motions: states of its settled motions that are not quiet.
    """
    cures = cures_of(design)
    quiet = verdict is Verdict.quiet

    def dies_out(designs: Sequence[Design]) -> list[bool]:
        return _dies_out(designs, _pushed, tol)

    def dies_out_always(designs: Sequence[Design]) -> list[bool]:
        return _dies_out_always(designs, motions, tol)

    nearest = _nearest(cures, _search(_sides(cures), quiet, dies_out, LOCATED))
    always = quiet and not motions and dies_out_always([design])[0]
    anywhere = _any_start(cures, nearest, quiet, always, dies_out_always)
    found = {}
    for name, cure in cures.items():
        ends = [*cure.below, cure.value, *cure.above]
        first, second = nearest.get(name, math.nan), anywhere.get(name, math.nan)
        found[name] = Boundary(
            cure.value,
            first,
            second,
            _change(name, cure.value, first),
            _change(name, cure.value, second),
            min(ends),
            max(ends),
        )
    return dict(
        sorted(
            found.items(),
            key=lambda item: (
                math.inf if math.isnan(item[1].change) else abs(item[1].change),
                list(CURES).index(item[0]),
            ),
        )
    )


def nearest_angles(
    design: Design, verdict: Verdict, *, tol: float
) -> tuple[float, float]:
    """The nearest pair of angles at which the verdict changes, along rays; NaN: none.

    Along each ray it is located as a cure is; the nearest lies between two rays, a few per cent
    nearer.
    """
    steps = STEP * np.arange(1, 1 + round(FARTHEST / STEP))
    sides = []
    for turn in np.linspace(0.0, 2.0 * math.pi, RAYS, endpoint=False):
        along, across = math.cos(turn), math.sin(turn)

        def apply(
            distance: float, along: float = along, across: float = across
        ) -> Design:
            return design._replace(
                alpha1=design.alpha1 + distance * along,
                alpha2=design.alpha2 + distance * across,
            )

        cure = Cure(0.0, apply, np.zeros(0), steps)
        sides.append(Side("alpha", cure, steps, 0.0))

    def dies_out(designs: Sequence[Design]) -> list[bool]:
        return _dies_out(designs, _pushed, tol)

    found = _search(sides, verdict is Verdict.quiet, dies_out, LOCATED)
    known = [side for side in found if not math.isnan(side.answer)]
    if not known:
        return math.nan, math.nan
    best = min(known, key=lambda side: side.answer)
    there = best.cure.apply(best.answer)
    return there.alpha1, there.alpha2


def _change(name: str, value: float, found: float) -> float:
    """Per cent of the present value, or degrees; points of critical damping from none."""
    if name.startswith("alpha"):
        return math.degrees(found - value)
    return 100.0 * (found - value) / (value or 1.0)


def _sides(cures: dict[str, Cure]) -> list[Side]:
    return [
        Side(name, cure, values, cure.value)
        for name, cure in cures.items()
        for values in (cure.below, cure.above)
        if values.size
    ]


def _nearest(cures: dict[str, Cure], sides: Sequence[Side]) -> dict[str, float]:
    """The nearer answer of both sides of each cure that has one."""
    found: dict[str, float] = {}
    for side in sides:
        value = cures[side.name].value
        best = found.get(side.name, math.nan)
        if not math.isnan(side.answer) and not abs(best - value) <= abs(
            side.answer - value
        ):
            found[side.name] = side.answer
    return found


def _search(sides: list[Side], quiet: bool, test: Test, located: float) -> list[Side]:
    """Find the answer of each side."""
    for side in sides:
        _plan(side, quiet, located)
    planned = [side for side in sides if side.rungs]
    first = test([side.cure.apply(side.rungs[0]) for side in planned])
    left = []
    for side, dies in zip(planned, first, strict=True):
        if dies == quiet and quiet and not math.isnan(side.exact):
            side.answer = side.exact  # quiet up to the linear boundary
        elif dies != quiet and not quiet and not math.isnan(side.exact):
            side.answer = side.exact  # quiet from the linear boundary on
        elif dies != quiet:
            side.outer = side.rungs[0]
        else:
            side.inner = side.rungs[0]
            left.append(side)
    later = [(side, rung) for side in left for rung in side.rungs[1:]]
    answers = test([side.cure.apply(rung) for side, rung in later])
    for (side, rung), dies in zip(later, answers, strict=True):
        if not math.isnan(side.outer):
            continue
        if dies == quiet:
            side.inner = rung
        else:
            side.outer = rung
    _bisect(sides, quiet, test, located)
    return sides


def _plan(side: Side, quiet: bool, located: float) -> None:
    """The linear boundary of a side, and the values that are to be run."""

    def stable(value: float) -> bool:
        sliding = Sliding.of(side.cure.apply(value))
        return sliding is not None and not sliding.is_unstable

    now = stable(side.inner)
    flags = []
    for value in side.values:
        flags.append(stable(float(value)))
        if quiet and not flags[-1]:
            break
        if not quiet and len(flags) > 1 and flags[-2] and not flags[-1]:
            break  # the first stretch of stable values has ended
    reached = side.values[: len(flags)]
    if quiet:
        if flags[-1]:
            side.rungs = _thinned(reached)
            return
        low = float(reached[-2]) if len(reached) > 1 else side.inner
        kept, side.exact = _halve(stable, low, float(reached[-1]))
        back = kept - math.copysign(side.scale(located), kept - side.inner)
        beyond = (back - side.inner) * (kept - side.inner) > 0
        side.rungs = [back if beyond else 0.5 * (side.inner + kept)]
        side.exact = kept
        return
    steady = np.flatnonzero(flags)
    if not steady.size:
        return
    outer = reached[steady]
    if now:
        side.rungs = _thinned(outer)
        return
    first = int(steady[0])
    low = float(reached[first - 1]) if first else side.inner
    _, side.exact = _halve(stable, low, float(reached[first]))
    check = side.beyond(side.exact, located)
    side.inner = side.exact
    rest = [v for v in outer if abs(v - side.cure.value) > abs(check - side.cure.value)]
    side.rungs = [check, *_thinned(np.array(rest))]


def _halve(
    stable: Callable[[float], bool], inner: float, outer: float
) -> tuple[float, float]:
    """The last value like the inner one and the first like the outer one."""
    like = stable(inner)
    for _ in range(HALVINGS):
        middle = 0.5 * (inner + outer)
        if middle in (inner, outer):
            break
        if stable(middle) == like:
            inner = middle
        else:
            outer = middle
    return inner, outer


def _thinned(values: np.ndarray) -> list[float]:
    """Some of the values, the last among them."""
    if not values.size:
        return []
    count = min(RUNGS, values.size)
    places = np.unique(np.geomspace(1, values.size, count).astype(int)) - 1
    return [float(value) for value in values[places]]


def _bisect(sides: Sequence[Side], quiet: bool, test: Test, located: float) -> None:
    """Answers of the sides that have a bracket, side by side."""
    while True:
        wide = [
            side
            for side in sides
            if not math.isnan(side.outer)
            and abs(side.outer - side.inner) > side.scale(located)
        ]
        if not wide:
            break
        middles = [0.5 * (side.inner + side.outer) for side in wide]
        answers = test(
            [side.cure.apply(at) for side, at in zip(wide, middles, strict=True)]
        )
        for side, at, dies in zip(wide, middles, answers, strict=True):
            if dies == quiet:
                side.inner = at
            else:
                side.outer = at
    for side in sides:
        if not math.isnan(side.outer):
            side.answer = side.inner if quiet else side.outer


def _any_start(
    cures: dict[str, Cure],
    nearest: dict[str, float],
    quiet: bool,
    always: bool,
    test: Test,
) -> dict[str, float]:
    """Where the verdict from any start changes; at ``quiet_from`` or beyond it, or before it."""
    sides = []
    for side in _sides(cures):
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
        side.rungs = _thinned(outer)
        if not quiet:
            side.rungs = [side.beyond(side.inner, LOCATED_ANY), *side.rungs[1:]]
    return _nearest(cures, _climb(sides, quiet=quiet, always=always, test=test))


def _climb(sides: list[Side], *, quiet: bool, always: bool, test: Test) -> list[Side]:
    """Test the rungs of each side outward, and bisect where the answer changes."""
    waiting = [side for side in sides if side.rungs]
    while waiting:
        answers = test([side.cure.apply(side.rungs[0]) for side in waiting])
        for side, dies in zip(waiting, answers, strict=True):
            rung = side.rungs.pop(0)
            if dies == always:
                side.inner = rung
            elif not quiet and side.inner == side.exact:
                side.answer, side.rungs = side.exact, []
            else:
                side.outer, side.rungs = rung, []
        waiting = [side for side in waiting if side.rungs]
    _bisect(
        [side for side in sides if math.isnan(side.answer)], always, test, LOCATED_ANY
    )
    if always:
        for side in sides:
            if math.isnan(side.answer):
                side.answer = side.exact  # quiet from any start as far as it is quiet
    return sides


def _pushed(design: Design, sliding: Sliding) -> list[Start]:
    return [pushed(design, sliding)]


def _dies_out(
    designs: Sequence[Design],
    starts_of: Callable[[Design, Sliding], list[Start]],
    tol: float,
) -> list[bool]:
    """Whether all starts of each design end quiet; without steady sliding none does."""
    found, starts, owners = [True] * len(designs), [], []
    for index, design in enumerate(designs):
        sliding = Sliding.of(design)
        if sliding is None or sliding.is_unstable:
            found[index] = False
            continue
        made = starts_of(design, sliding)
        starts += made
        owners += [index] * len(made)
    if starts:
        for index, settled in zip(owners, settle(starts, tol=tol), strict=True):
            found[index] &= settled.verdict is Verdict.quiet
    return found


def _dies_out_always(
    designs: Sequence[Design], motions: Sequence[np.ndarray], tol: float
) -> list[bool]:
    """Whether each design is quiet from all starts, which are tried one after the other."""
    found = [True] * len(designs)
    kinds = [
        lambda design, sliding, state=state: [start_at(design, sliding, state)]
        for state in (np.zeros(4), *motions)
    ]
    for starts_of in (*kinds, strikes):
        rows = [index for index, quiet in enumerate(found) if quiet]
        if not rows:
            break
        answers = _dies_out([designs[row] for row in rows], starts_of, tol)
        for row, quiet in zip(rows, answers, strict=True):
            found[row] = quiet
    return found


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
