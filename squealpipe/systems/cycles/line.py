"""Steps along a branch of cycles, and the functions that vanish where it has a special point."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from squealpipe.systems.branch_labels import Label
from squealpipe.systems.continuation import (
    ContinuationSettings,
    ContinuationState,
    PseudoArclength,
)
from squealpipe.systems.cycles.event_map import EventMap
from squealpipe.systems.cycles.solution import Cycle

# Round-off in the closing error is eps times the longest length over the cycle's: 3e-9 for
# springs of 10⁶ and a cycle of one.
branch_steps = ContinuationSettings(
    first_step=1e-3,
    shortest_step=1e-9,
    longest_step=0.05,
    tolerance=1e-11,
    stagnant=1e-8,
)
precise_steps = replace(branch_steps, tolerance=3e-14, max_iterations=10)
along_branch, at_special_points = (
    PseudoArclength(steps, least_iterations=0, own_tangent=True)
    for steps in (branch_steps, precise_steps)
)
"""Along a branch, and at a special point, which is located to round-off."""


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
    """Return whether, where :func:`pairs` is zero, a complex pair is on the unit circle."""
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
    """Count the multipliers outside the unit circle."""
    # a multiplier this close to the unit circle is on it, apart from round-off
    return int((np.abs(cycle.nontrivial) > 1.0 + 1e-6).sum())


def explains(change: int, labels: Sequence[Label]) -> bool:
    """Return whether special points may be why so many multipliers have left the unit circle.

    Where none has, they need no reason: next to a cycle of a part of the period a branch turns
    back on itself, and its multipliers with it.
    """
    most = sum(2 if label == Label.torus else 1 for label in labels)
    return change == 0 or (abs(change) <= most and (change - most) % 2 == 0)


def branching_label(cycle: Cycle) -> Label:
    """Return the label of a point where two branches cross: a pitchfork is one by symmetry.

    There the reduced equation has no quadratic term (Kuznetsov, Elements of Applied Bifurcation
    Theory, ch. 7).
    """
    equations, size = cycle.map, cycle.map.size
    left, _, right = np.linalg.svd(equations.evaluate(cycle.point)[1][:, :size])
    step = np.zeros_like(cycle.point)
    # without units: the curvature is a central difference over this step
    aside = 1e-4
    step[:size] = aside * right[-1]
    ahead, behind = (
        equations.evaluate(cycle.point + sign * step)[1][:, :size]
        for sign in (1.0, -1.0)
    )
    bend = (ahead - behind) @ right[-1] / (2.0 * aside)
    # share of the curvature that is round-off where symmetry makes it zero
    even = 1e-3
    symmetric = abs(left[:, -1] @ bend) <= even * np.linalg.norm(bend) + even
    return Label.pitchfork if symmetric else Label.transcritical


def hides_folds(before: ContinuationState, after: ContinuationState) -> bool:
    """Return whether the parameter, interpolated by Hermite's cubic, turns twice between two
    points.
    """
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


def next_length(state: ContinuationState, following: ContinuationState) -> float:
    """The step after this one: longer, but not so that the branch turns by too much in it."""
    most = np.arccos(branch_steps.least_cosine)
    turn = float(np.linalg.norm(following.tangent - state.tangent))
    # after few iterations the next step may grow, but by no more than three times
    growth = 3.0 if following.iterations <= 3 else 1.0
    # the next step is meant for 0.7 of the largest turn, so that few steps are refused
    length = state.step * float(np.clip(0.7 * most / max(turn, 1e-300), 0.5, growth))
    return min(length, branch_steps.longest_step)


def at_edge(
    equations: EventMap, state: ContinuationState, low: float, high: float
) -> ContinuationState | None:
    """The point at the end of the parameter's range, if the next step would leave it."""
    unit = float(equations.units[-1])
    length = state.step * (1.0 + float(np.linalg.norm(state.point)))
    ahead = float(state.point[-1] + length * state.tangent[-1]) * unit
    if low < ahead < high:
        return None
    edge = low if ahead <= low else high
    share = (edge / unit - state.point[-1]) / state.tangent[-1]
    if share <= 0.0:
        return None
    guess = state.point + share * state.tangent
    guess[-1] = edge / unit
    normal = math.copysign(1.0, state.tangent[-1]) * np.eye(len(guess))[-1]
    edge_point = along_branch.solve(equations, guess, normal, state.step)
    if (
        edge_point is None
        or float(np.linalg.norm(edge_point.point - guess)) > 0.3 * length
    ):
        return None
    return edge_point
