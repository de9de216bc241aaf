"""The search for the value at which an answer changes, on either side of the present one.

Steady sliding that is linearly unstable is never quiet, so each side is searched along the linear
boundary first, which costs no run. Runs next to it, and farther out, then tell whether the motion
dies out there. Where it does right beside the linear boundary, that boundary is the answer; else
runs bisect. All sides are tested side by side in one ensemble.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import scipy

from squealpipe.brake.assess.designs import Cure
from squealpipe.brake.assess.sliding import Sliding

LOCATED = 1e-3
"""To which a boundary is located: of the value, or rad."""

LEAST = 1e-3
"""Values below this, over the present one, are located as if they were this."""

RUNGS = 8
"""Values beyond the linear boundary that are run at most."""

ROOT = 1e-14
"""To which the linear boundary is located, relatively."""


@dataclass
class Side:
    """One side of the present value of one cure.

    Attributes:
        values: outward.
        inner: the last value known to be like the present one, in what is tested.
        exact: the linear boundary, if the answer may be that.
        rungs: values to run, outward.
        answer: what was found; NaN: nothing.
        motions: states of motions that last at the value tried last at which any does.
    """

    name: str
    cure: Cure
    values: np.ndarray
    inner: float
    exact: float = math.nan
    rungs: list[float] = field(default_factory=list)
    answer: float = math.nan
    outer: float = math.nan
    motions: list[np.ndarray] = field(default_factory=list)

    def scale(self, located: float, value: float) -> float:
        """Distance next to a value that counts as located."""
        if self.name.startswith("alpha"):
            return located
        return located * max(abs(value), LEAST * abs(self.cure.value), 1e-12)

    def beyond(self, value: float, located: float) -> float:
        """The next value outward that counts as another, within the range."""
        farthest = float(self.values[-1])
        step = math.copysign(self.scale(located, value), farthest - self.cure.value)
        return min((value + step, farthest), key=lambda end: abs(end - value))


Test = Callable[[Sequence[Side], Sequence[float]], list[bool]]
"""Whether the designs of some sides at some values are quiet."""


def sides_of(cures: dict[str, Cure]) -> list[Side]:
    """Both sides of each cure, as far as there are any values."""
    return [
        Side(name, cure, values, cure.value)
        for name, cure in cures.items()
        for values in (cure.below, cure.above)
        if values.size
    ]


def nearer(cures: dict[str, Cure], sides: Sequence[Side]) -> dict[str, float]:
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


def search(sides: list[Side], quiet: bool, test: Test, located: float) -> list[Side]:
    """Find the answer of each side."""
    for side in sides:
        _plan(side, quiet, located)
    planned = [side for side in sides if side.rungs]
    first = test(planned, [side.rungs[0] for side in planned])
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
    answers = test([side for side, _ in later], [rung for _, rung in later])
    for (side, rung), dies in zip(later, answers, strict=True):
        if not math.isnan(side.outer):
            continue
        if dies == quiet:
            side.inner = rung
        else:
            side.outer = rung
    bisect(sides, quiet, test, located)
    return sides


def _plan(side: Side, quiet: bool, located: float) -> None:
    """The linear boundary of a side, and the values that are to be run."""
    now = _is_stable(side, side.inner)
    reached, flags = _reached(side, quiet)
    if quiet:
        if flags[-1]:
            side.rungs = thinned(reached)
            return
        low = float(reached[-2]) if len(reached) > 1 else side.inner
        kept, side.exact = _locate(side, low, float(reached[-1]))
        back = kept - math.copysign(side.scale(located, kept), kept - side.inner)
        beyond = (back - side.inner) * (kept - side.inner) > 0
        side.rungs = [back if beyond else 0.5 * (side.inner + kept)]
        side.exact = kept
        return
    steady = np.flatnonzero(flags)
    if not steady.size:
        return
    outer = reached[steady]
    if now:
        side.rungs = thinned(outer)
        return
    first = int(steady[0])
    low = float(reached[first - 1]) if first else side.inner
    _, side.exact = _locate(side, low, float(reached[first]))
    check = side.beyond(side.exact, located)
    side.inner = side.exact
    rest = [v for v in outer if abs(v - side.cure.value) > abs(check - side.cure.value)]
    side.rungs = [check, *thinned(np.array(rest))]


def _reached(side: Side, quiet: bool) -> tuple[np.ndarray, list[bool]]:
    """Values outward as far as the linear boundary is looked for, and which of them are stable.

    Of a quiet brake, growth may come up to zero between three stable values and cross it twice; of
    another one, a stretch of quiet as short is no cure.
    """
    values, margins = [side.inner], [_margin(side, side.inner)]
    for value in side.values:
        values.append(float(value))
        margins.append(_margin(side, values[-1]))
        stable = [margin <= 0.0 for margin in margins]
        turns = quiet and _turns(margins[-3:])
        peak = _peak(side, values[-3:]) if turns else None
        if peak is not None:
            nearer = [v for v in values if abs(v - side.inner) < abs(peak - side.inner)]
            return np.array([*nearer[1:], peak]), [*stable[1 : len(nearer)], False]
        if quiet and not stable[-1]:
            break
        if not quiet and len(stable) > 2 and stable[-2] and not stable[-1]:
            break  # the first stretch of stable values has ended
    return np.array(values[1:]), stable[1:]


def _turns(margins: Sequence[float]) -> bool:
    """Whether three margins are all stable, the middle one least."""
    if len(margins) < 3 or max(margins) > 0.0:
        return False
    return margins[1] > max(margins[0], margins[2])


def _peak(side: Side, values: Sequence[float]) -> float | None:
    """Where small motions grow beside the middle one of three stable values, if anywhere."""
    found = scipy.optimize.minimize_scalar(
        lambda value: -_margin(side, float(value)),
        bounds=sorted((values[0], values[2])),
        method="bounded",
        options={"xatol": 0.02 * abs(values[2] - values[0])},
    )
    return None if _is_stable(side, float(found.x)) else float(found.x)


def _locate(side: Side, inner: float, outer: float) -> tuple[float, float]:
    """The last value like the inner one and the first like the outer one, round-off apart.

    Where the growth rate crosses zero (Brent's method, which bisects where it jumps).
    """
    ends, signs = [inner, outer], [_is_stable(side, end) for end in (inner, outer)]
    if signs[0] == signs[1]:
        return outer, outer
    near = ROOT * abs(outer - inner)
    root = scipy.optimize.brentq(
        partial(_margin, side), inner, outer, xtol=near, rtol=ROOT
    )
    for at, end in enumerate(ends):
        step = near + ROOT * abs(root)
        value = root
        while value != end and _is_stable(side, value) != signs[at]:
            way = min(step, abs(end - root))
            value, step = root + math.copysign(way, end - root), 4.0 * step
        ends[at] = value
    return ends[0], ends[1]


def _margin(side: Side, value: float) -> float:
    """By how much small motions grow faster than round-off, 1/s; positive without any sliding."""
    design = side.cure.apply(value)
    sliding = Sliding.of(design)
    if sliding is None:
        return design.rate
    return sliding.margin


def _is_stable(side: Side, value: float) -> bool:
    return _margin(side, value) <= 0.0


def thinned(values: np.ndarray) -> list[float]:
    """Some of the values, the last among them."""
    if not values.size:
        return []
    count = min(RUNGS, values.size)
    places = np.unique(np.geomspace(1, values.size, count).astype(int)) - 1
    return [float(value) for value in values[places]]


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
