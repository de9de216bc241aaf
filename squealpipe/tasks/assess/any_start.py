"""Where no other motion lasts beside steady sliding: motions are followed to where they end."""

import math
from collections.abc import Sequence

import numpy as np

from squealpipe.schema.assess import Verdict
from squealpipe.tasks.assess.designs import Cure
from squealpipe.tasks.assess.search import Side, Test, bisect, nearer, thinned
from squealpipe.tasks.assess.settling import Start, settle, start_at
from squealpipe.tasks.assess.sliding import Design, Sliding

LOCATED_ANY = 1e-2
"""To which the boundary of any start is located: of the value, or rad."""

ALONG = 0.95
"""How far towards ``quiet_from``, over the whole way, a lasting motion is led before it is followed
in small steps."""

MOST_MOTIONS = 2
"""Motions of a side that are followed at most."""

KICKS = ((0.0, 1.0), (-1.0, -0.5), (1.0, 2.0))
"""Velocities of strikes along and across the belt, over l_pre √((k1 + k2)/2m)."""


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
    climbed = _climb(sides, quiet=quiet, always=always, test=test, follow=follow)
    return nearer(cures, climbed)


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
    _follow([side for side in open_sides if not math.isnan(side.outer)], always, follow)
    if always:
        for side in sides:
            if math.isnan(side.answer):
                side.answer = side.exact  # quiet from any start as far as it is quiet
    return sides


def _follow(sides: Sequence[Side], always: bool, test: Test) -> None:
    """Move each bracket on as long as the motion at its lasting end lasts at the other one, too.

    A value may have been tried from a motion at a distant one, which is no start of what lasts.
    """
    while sides:
        ends = [side.inner if always else side.outer for side in sides]
        answers = test(sides, ends)
        moved = []
        for side, end, dies in zip(sides, ends, answers, strict=True):
            if dies:
                continue
            if always:
                step = side.inner - side.outer
                side.inner, side.outer = side.inner + step, end
                within = (side.inner - side.cure.value) * step < 0
                side.inner = side.inner if within else side.cure.value
            else:
                side.inner, side.outer = end, side.beyond(end, LOCATED_ANY)
                within = side.outer != end
                side.outer = side.outer if within else math.nan
            side.answer = side.inner if always else side.outer
            if within:
                moved.append(side)
        sides = moved


def lead(sides: Sequence[Side], nearest: dict[str, float], *, tol: float) -> None:
    """Lead the motions of each side that has a ``quiet_from`` to the values next to it.

    From the present value to one beyond ``quiet_from`` they could leave their basin, although they
    last there.
    """
    led = []
    for side in sides:
        way = nearest.get(side.name, math.nan) - side.cure.value
        if way * (side.values[0] - side.cure.value) > 0:
            led.append((side, side.cure.apply(side.cure.value + ALONG * way)))
    starts = [
        start_at(design, Sliding.of(design), state)
        for side, design in led
        for state in side.motions
    ]
    ends = iter(settle(starts, tol=tol) if starts else [])
    for side, _ in led:
        side.motions = [next(ends).last.final for _ in side.motions]


def dies_out_always(
    sides: Sequence[Side], values: Sequence[float], *, tol: float, kinds: int = 3
) -> list[bool]:
    """Whether each side's design is quiet from all starts, tried one kind after the other.

    First the motions that last at its last value are followed, which finds where they end; then
    come rest under the whole preload, and strikes.

    Args:
        kinds: how many of the three kinds are tried.
    """
    found = [False] * len(sides)
    open_rows: dict[int, tuple[Design, Sliding]] = {}
    for row, (side, value) in enumerate(zip(sides, values, strict=True)):
        design = side.cure.apply(value)
        sliding = Sliding.of(design)
        if sliding is not None and not sliding.is_unstable:
            found[row], open_rows[row] = True, (design, sliding)
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
            if settled.verdict is not Verdict.quiet:
                lasting.setdefault(row, []).append(settled.last.final)
        for row, states in lasting.items():
            found[row], sides[row].motions = False, states[:MOST_MOTIONS]
            del open_rows[row]
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
