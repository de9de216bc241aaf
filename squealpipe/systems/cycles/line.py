"""A branch between two of its points, and the functions that vanish where it has a special one."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from squealpipe.methods.continuation import (
    ContinuationSettings,
    ContinuationState,
    PathEquations,
    PseudoArclength,
)
from squealpipe.schema.branch_labels import Label
from squealpipe.systems.cycles.admissible import MARGIN_ROUND_OFF
from squealpipe.systems.cycles.flow import Vector
from squealpipe.systems.cycles.solution import Cycle

# Round-off in the closing error is eps times the longest length over the cycle's: 3e-9 for
# springs of 10⁶ and a cycle of one.
STEPS = ContinuationSettings(
    first_step=1e-3,
    shortest_step=1e-9,
    longest_step=0.05,
    tolerance=1e-11,
    stagnant=1e-8,
)
PRECISE = replace(STEPS, tolerance=3e-14, max_iterations=10)
ALONG, AT = (
    PseudoArclength(steps, least_iterations=0, own_tangent=True)
    for steps in (STEPS, PRECISE)
)
"""Along a branch, and at a special point, which is located to round-off."""
_ZERO = 1e-12
_NEUTRAL = 1e-6
"""Distance of a multiplier from the unit circle on which it counts as on it."""
_ASIDE = 1e-4
"""Step over which the equations' curvature is taken, without units."""
_EVEN = 1e-3
"""Share of the curvature that is none, at a pitchfork."""

Test = Callable[[ContinuationState, Cycle], float]


def flip(cycle: Cycle) -> float:
    """∏ (λ + 1) over the multipliers: zero at a period doubling."""
    return float(np.real(np.prod(cycle.nontrivial + 1.0)))


def pairs(cycle: Cycle) -> float:
    """∏ (λi λj − 1) over pairs of multipliers: zero at a torus, and where real ones are inverse."""
    first, second = np.triu_indices(len(cycle.nontrivial), 1)
    return float(
        np.real(np.prod(cycle.nontrivial[first] * cycle.nontrivial[second] - 1.0))
    )


def is_torus(cycle: Cycle) -> bool:
    """Whether, where :func:`pairs` is zero, a complex pair is on the unit circle."""
    rest = cycle.nontrivial
    return bool(
        ((np.abs(np.abs(rest) - 1.0) < 1e-6) & (np.abs(rest.imag) > 1e-9)).any()
    )


def crossing_one(cycle: Cycle) -> float:
    """∏ (λ − 1) over the multipliers: zero at a fold, and where two branches cross."""
    return float(np.real(np.prod(cycle.nontrivial - 1.0)))


TESTS: tuple[tuple[Label, Test], ...] = (
    (Label.fold, lambda state, _: float(state.tangent[-1])),
    (Label.pitchfork, lambda _, cycle: crossing_one(cycle)),
    (Label.period_doubling, lambda _, cycle: flip(cycle)),
    (Label.torus, lambda _, cycle: pairs(cycle)),
)


def unstable(cycle: Cycle) -> int:
    """How many multipliers are outside the unit circle."""
    return int((np.abs(cycle.nontrivial) > 1.0 + _NEUTRAL).sum())


def explains(change: int, labels: Sequence[Label]) -> bool:
    """Whether special points may be why so many multipliers have left the unit circle.

    Where none has, they need no reason: next to a cycle of a part of the period a branch turns
    back on itself, and its multipliers with it.
    """
    most = sum(2 if label == Label.torus else 1 for label in labels)
    return change == 0 or (abs(change) <= most and (change - most) % 2 == 0)


def branching_label(cycle: Cycle) -> Label:
    """What is at a point where two branches cross: a pitchfork is one by symmetry.

    There the reduced equation has no quadratic term (Kuznetsov, Elements of Applied Bifurcation
    Theory, ch. 7).
    """
    equations, size = cycle.map, cycle.map.size
    left, _, right = np.linalg.svd(equations.evaluate(cycle.point)[1][:, :size])
    step = np.zeros_like(cycle.point)
    step[:size] = _ASIDE * right[-1]
    ahead, behind = (
        equations.evaluate(cycle.point + sign * step)[1][:, :size]
        for sign in (1.0, -1.0)
    )
    bend = (ahead - behind) @ right[-1] / (2.0 * _ASIDE)
    symmetric = abs(left[:, -1] @ bend) <= _EVEN * np.linalg.norm(bend) + _EVEN
    return Label.pitchfork if symmetric else Label.transcritical


def hides_folds(before: ContinuationState, after: ContinuationState) -> bool:
    """Whether the parameter, interpolated by Hermite's cubic, turns twice between two points."""
    step = after.point - before.point
    first, last = float(before.tangent[-1]), float(after.tangent[-1])
    mean = float(step[-1] / np.linalg.norm(step))
    # its slope is first + b s + a s² for s from 0 to 1
    a, b = 3.0 * (first + last) - 6.0 * mean, 6.0 * mean - 4.0 * first - 2.0 * last
    if first * last <= 0.0 or a == 0.0 or not 0.0 < -0.5 * b / a < 1.0:
        return False
    return (first - 0.25 * b * b / a) * first < 0.0


def multiplier_change(one: Cycle, other: Cycle) -> float:
    """Largest relative distance of a multiplier from the nearest of the other cycle."""
    first, second = one.multipliers, other.multipliers
    distance = np.abs(first[:, None] - second) / (1.0 + np.abs(first[:, None]))
    return float(max(distance.min(axis=0).max(), distance.min(axis=1).max()))


class Line:
    """A branch, or a curve, of one event map between two points of it, and a little beyond."""

    def __init__(
        self,
        algorithm: PseudoArclength,
        equations: PathEquations,
        first: tuple[ContinuationState, Cycle],
        last: tuple[ContinuationState, Cycle],
        cycle_at: Callable[[Vector], Cycle],
    ) -> None:
        self.algorithm, self.equations, self.cycle_at = algorithm, equations, cycle_at
        self.known = {0.0: first, 1.0: last}
        self.normal = first[0].tangent
        self.reach = float(self.normal @ (last[0].point - first[0].point))

    def at(self, share: float) -> tuple[ContinuationState, Cycle]:
        """The point over a share of the step; an ArithmeticError where there is none."""
        if share not in self.known:
            shares = sorted(self.known)
            high = next((s for s in shares if s > share), shares[-1])
            low = shares[shares.index(high) - 1]
            (one, _), (other, _) = self.known[low], self.known[high]
            width, part = high - low, (share - low) / (high - low)
            step = other.point - one.point
            slopes = [
                s.tangent * (width * self.reach / float(self.normal @ s.tangent)) - step
                for s in (one, other)
            ]
            bend = (1.0 - part) * slopes[0] - part * slopes[1]
            if not np.linalg.norm(bend) < np.linalg.norm(step):
                bend = np.zeros_like(step)
            guess = one.point + part * step + part * (1.0 - part) * bend
            state = self.algorithm.solve(
                self.equations, guess, self.normal, self.known[0.0][0].step
            )
            if state is None:
                raise ArithmeticError
            self.known[share] = state, self.cycle_at(state.point)
        return self.known[share]

    def root(self, test: Test, end: float = 1.0) -> float | None:
        """Where a test is zero before a share of the step; None where it is not found."""

        def value(share: float) -> float:
            found = test(*self.at(share))
            return 1.0 if found == np.inf else found

        try:
            first = value(0.0)
            if first <= 0.0 and value(end) < 0.0:
                return 0.0 if first > -MARGIN_ROUND_OFF else None
            return float(brentq(value, 0.0, end, xtol=_ZERO, rtol=_ZERO, maxiter=60))
        except (ArithmeticError, ValueError, RuntimeError):
            return None
