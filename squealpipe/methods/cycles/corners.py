"""Where a branch of cycles has a corner because a surface is just touched.

The return map is continuous but not smooth where a hold of the motion just begins, and the branch
may turn back there at an angle. On the near side the touch is approached from inside; beyond it
the branch goes along the null vector of the Jacobian taken there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from squealpipe.methods.continuation import ContinuationState, PseudoArclength
from squealpipe.methods.cycles.cycle_equations import CycleEquations, cycle_at
from squealpipe.methods.cycles.cycles import Cycle
from squealpipe.methods.cycles.event_changes import EventChange, event_change, same_events
from squealpipe.methods.cycles.event_flow import Touch
from squealpipe.methods.cycles.special_points import Located

_MOST_TRIALS = 40
_PROBE = 0.1
"""Length of the first trial over that of the step."""
_TOUCHING = 1e-3
"""Distance at a touch over that at the start of the approach."""
_CLOSE = 1e-11
"""Width of the bracket of a touch, over 1 + |z|."""


def approach(
    equations: CycleEquations,
    algorithm: PseudoArclength,
    state: ContinuationState,
    cycle: Cycle,
    distance: Callable[[Cycle], float],
) -> tuple[ContinuationState, Cycle] | None:
    """The last point with the same events, where ``distance`` has fallen to zero.

    None where it does not fall to zero within a step, or the branch cannot be followed that far.
    """
    size = 1.0 + float(np.linalg.norm(state.point))
    start = here = distance(cycle)
    reached = None
    low, high = 0.0, np.inf
    length = _PROBE * state.step * size
    for _ in range(_MOST_TRIALS):
        nearest = state if reached is None else reached[0]
        found = _same_side(equations, algorithm, state, cycle, length, nearest)
        if found is None:
            high = length
            length = 0.5 * (low + high)
        elif found[0].tangent @ state.tangent < algorithm.settings.least_cosine:
            return None  # beyond a turn, which comes first
        else:
            there = distance(found[1])
            if not there < here:
                break  # round-off, or the branch leads away
            ahead = length + (length - low) * there / (here - there)
            if reached is None and ahead > 2.0 * state.step * size:
                return None
            low, here, reached = length, there, found
            length = ahead if ahead < high else 0.5 * (low + high)
        if high - low < _CLOSE * size or here < 1e-12 * start:
            break
        if reached is None and high < 0.1 * _PROBE * state.step * size:
            return None
    return reached if here < _TOUCHING * start else None


def _same_side(
    equations: CycleEquations,
    algorithm: PseudoArclength,
    state: ContinuationState,
    cycle: Cycle,
    length: float,
    nearest: ContinuationState,
) -> tuple[ContinuationState, Cycle] | None:
    """The branch's point so far ahead, if it is near there and has the same events.

    The guess is on the tangent of the nearest point that is known.
    """
    left = length - float(state.tangent @ (nearest.point - state.point))
    guess = nearest.point + left / float(state.tangent @ nearest.tangent) * nearest.tangent
    reached = algorithm.solve(equations, guess, state.tangent, state.step)
    if reached is None or np.linalg.norm(reached.point - state.point) > 2.0 * length:
        return None
    other = cycle_at(equations, reached)
    return (reached, other) if same_events(cycle, other) else None


def turn_corner(
    equations: CycleEquations,
    algorithm: PseudoArclength,
    state: ContinuationState,
    cycle: Cycle,
) -> tuple[ContinuationState, Cycle, EventChange] | None:
    """The branch on the other side of a touch, from a point next to it."""
    size = 1.0 + float(np.linalg.norm(state.point))
    algorithm = replace(algorithm, least_iterations=1)
    for wide in (1e-8, 1e-7, 1e-6, 1e-5):
        _, jacobian = equations.evaluate(state.point + wide * size * state.tangent)
        if not np.isfinite(jacobian).all():
            continue
        direction = np.linalg.svd(jacobian)[2][-1]
        for length in (wide * size * 10.0**power for power in range(4)):
            for way in (direction, -direction):
                guess = state.point + length * way
                following = algorithm.solve(equations, guess, way, length / size)
                if following is None:
                    continue
                if np.linalg.norm(following.point - state.point) > 3.0 * length:
                    continue
                other = cycle_at(equations, following)
                change = None if same_events(cycle, other) else event_change(cycle, other)
                if change is not None:
                    return following, other, change
    return None


def around_corner(
    equations: CycleEquations,
    algorithm: PseudoArclength,
    state: ContinuationState,
    cycle: Cycle,
) -> tuple[Located, tuple[ContinuationState, Cycle, EventChange] | None] | None:
    """(a touch, the first point beyond it or None); None where no touch is near."""
    ending = None
    probe = _same_side(
        equations,
        algorithm,
        state,
        cycle,
        _PROBE * state.step * (1.0 + float(np.linalg.norm(state.point))),
        state,
    )
    if probe is None:
        return None
    for measure in _measures(cycle):
        here, there = measure(cycle), measure(probe[1])
        if not (np.isfinite(here) and there < (1.0 - 0.5 * _PROBE) * here):
            continue
        touched = approach(equations, algorithm, state, cycle, measure)
        beyond = touched and turn_corner(equations, algorithm, *touched)
        if touched and beyond:
            return touched, beyond
        ending = ending or touched
    return (ending, None) if ending else None


def _measures(cycle: Cycle) -> list[Callable[[Cycle], float]]:
    """Distances from every touch that may be near: before it, and beyond it."""
    system, kinds = cycle.system, cycle.passage.event_kinds

    def before(touch: Touch) -> Callable[[Cycle], float]:
        return lambda here: here.system.clearance(touch, here.passage)

    def beyond(touch: Touch, first: int) -> Callable[[Cycle], float]:
        return lambda here: here.system.overlap(touch, here.passage, first)

    found = [before(touch) for touch in (Touch.touch, Touch.split, Touch.passing, Touch.graze)]
    for first in range(len(kinds) - 1):
        touch = system.touch_of(tuple(kinds[first : first + 2]), ())
        if touch is not None:
            found.append(beyond(touch, first))
    return found
