"""Special points of a branch of cycles: what lies between two points, and where."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from squealpipe.methods.continuation import ContinuationState, PseudoArclength
from squealpipe.methods.limit_cycles.cycle_equations import CycleEquations, cycle_at
from squealpipe.methods.limit_cycles.cycles import Cycle
from squealpipe.methods.limit_cycles.event_changes import EventChange
from squealpipe.methods.limit_cycles.event_flow import Touch
from squealpipe.methods.limit_cycles.labels import Label

LABELS = {
    Touch.graze: Label.grazing,
    Touch.touch: Label.stick_onset,
    Touch.split: Label.stick_onset,
    Touch.passing: Label.stick_onset,
}
"""Changes of the events that are located; two events that coincide make no special point."""

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
    before: ContinuationState,
    after: ContinuationState,
    test: Test,
) -> Located | None:
    """The point between two where ``test`` is zero; None where it cannot be solved for."""
    known = {0.0: before, 1.0: after}
    cycles: dict[float, Cycle] = {}

    def value(share: float) -> float:
        if share not in known:
            guess = before.point + share * (after.point - before.point)
            corrected = algorithm.correct(equations, guess, before.tangent)
            if corrected is None:
                raise ArithmeticError
            point, tangent, iterations, residual = corrected
            curvature = np.zeros_like(point)
            known[share] = ContinuationState(
                point, tangent, curvature, before.step, iterations, residual
            )
        cycles[share] = cycle_at(equations, known[share])
        return test(known[share], cycles[share])

    try:
        root = brentq(value, 0.0, 1.0, xtol=1e-13, rtol=1e-13, maxiter=60)
        value(root)
    except (ArithmeticError, ValueError, RuntimeError):
        return None
    return known[root], cycles[root]
