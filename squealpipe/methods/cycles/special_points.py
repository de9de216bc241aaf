"""Special points of a branch of cycles: what lies between two points, and where."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from squealpipe.methods.continuation import ContinuationState, PseudoArclength
from squealpipe.methods.cycles.cycle_equations import CycleEquations, cycle_at
from squealpipe.methods.cycles.cycles import Cycle
from squealpipe.methods.cycles.event_changes import EventChange
from squealpipe.methods.cycles.event_flow import Touch, Vector
from squealpipe.methods.cycles.labels import Label

LABELS = {
    Touch.graze: Label.grazing,
    Touch.touch: Label.stick_onset,
    Touch.split: Label.stick_onset,
    Touch.passing: Label.stick_onset,
}
"""Changes of the events that are located; two events that coincide make no special point."""

_ZERO, _MOST = 1e-12, 40
"""A test is zero below this share of its values at both ends; most of its evaluations."""

Test = Callable[[ContinuationState, Cycle], float]
Located = tuple[ContinuationState, Cycle]


def special_tests(
    before: ContinuationState,
    cycle: Cycle,
    after: ContinuationState,
    reached: Cycle,
    change: EventChange | None,
) -> list[tuple[Label, Test]]:
    """What happens between two points, each with a function that is zero where it does."""
    found: list[tuple[Label, Test]] = []
    if change is not None and change.touch in LABELS:
        found.append((LABELS[change.touch], lambda _, here: change.distance(here)))
    smooth: tuple[tuple[Label, Test], ...] = (
        (Label.fold, lambda state, _: float(state.tangent[5])),
        (Label.period_doubling, lambda _, here: _flip(here)),
        (Label.torus, lambda _, here: _modulus(here)),
    )
    for label, test in smooth:
        first, second = test(before, cycle), test(after, reached)
        if first * second < 0.0 and np.isfinite(first * second):
            found.append((label, test))
    return found


def hides_folds(before: ContinuationState, after: ContinuationState) -> bool:
    """Whether the parameter, interpolated by Hermite's cubic, turns twice between two points."""
    step = after.point - before.point
    first, last = float(before.tangent[5]), float(after.tangent[5])
    mean = float(step[5] / np.linalg.norm(step))
    # its slope is first + b s + a s² for s from 0 to 1
    a, b = 3.0 * (first + last) - 6.0 * mean, 6.0 * mean - 4.0 * first - 2.0 * last
    if first * last <= 0.0 or a == 0.0 or not 0.0 < -0.5 * b / a < 1.0:
        return False
    return (first - 0.25 * b * b / a) * first < 0.0


def _flip(cycle: Cycle) -> float:
    """∏ (λ + 1) over the multipliers: zero at a period doubling."""
    return float(np.real(np.prod(cycle.multipliers + 1.0)))


def _modulus(cycle: Cycle) -> float:
    """Largest |λ| − 1 of the complex pairs: zero at a torus bifurcation; NaN without a pair."""
    values = cycle.multipliers[1:]
    pairs = values[np.abs(values.imag) > 1e-9]
    return float(np.abs(pairs).max() - 1.0) if len(pairs) else np.nan


def locate(
    equations: CycleEquations,
    algorithm: PseudoArclength,
    before: Located,
    after: Located,
    test: Test,
) -> Located | None:
    """The point between two where ``test`` is zero; None where it cannot be solved for."""
    (first, _), (last, _) = before, after
    known = {0.0: before, 1.0: after}
    reach = float(first.tangent @ (last.point - first.point))
    ends = test(*before), test(*after)
    zero = _ZERO * max(map(abs, ends))

    def value(share: float) -> float:
        if share not in known:
            guess = _between(known, share, first.tangent, reach)
            state = algorithm.solve(equations, guess, first.tangent, first.step)
            if state is None:
                raise ArithmeticError
            known[share] = state, cycle_at(equations, state)
        result = test(*known[share])
        return 0.0 if abs(result) < zero else result

    try:
        root = brentq(value, 0.0, 1.0, xtol=1e-13, rtol=1e-13, maxiter=_MOST)
    except (ArithmeticError, ValueError, RuntimeError):
        return None
    return known[root]


def _between(known: dict[float, Located], share: float, normal: Vector, reach: float) -> Vector:
    """The branch between its two nearest known points by Hermite's cubic, over ``normal``."""
    low = max(at for at in known if at < share)
    high = min(at for at in known if at > share)
    (one, _), (other, _) = known[low], known[high]
    width, part = high - low, (share - low) / (high - low)
    step = other.point - one.point
    slopes = [
        state.tangent * (width * reach / float(normal @ state.tangent)) - step
        for state in (one, other)
    ]
    bend = (1.0 - part) * slopes[0] - part * slopes[1]
    if not np.linalg.norm(bend) < np.linalg.norm(step):
        bend = np.zeros_like(step)
    return np.asarray(one.point + part * step + part * (1.0 - part) * bend)
