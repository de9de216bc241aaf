"""Special points of a branch of symmetric orbits: period doublings, meetings, folds of the peak."""

from collections.abc import Sequence
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.orbits.orbits import Orbit, OrbitEquations, to_round_off
from squealpipe.brake.orbits.piecewise_linear import PiecewiseLinearSystem
from squealpipe.codes import SpecialPoint
from squealpipe.systems.branch_line import Line
from squealpipe.systems.continuation import ContinuationState

Vector = NDArray[np.float64]


def special_points(
    system: PiecewiseLinearSystem, orbits: Sequence[Orbit]
) -> list[tuple[SpecialPoint, Orbit]]:
    """Period doublings (index −2), other crossings of index 2, and folds of the peak, located.

    Args:
        orbits: consecutive orbits of one branch; each change of sign between two is followed
            down to round-off, and looked for in pairs where the bend of what changes its sign
            leaves room for them.
    """
    equations, specials = OrbitEquations(system), []
    for first, second in pairwise(orbits):
        line = _between(equations, first, second)
        if line is None:
            continue
        # six halvings of a step
        shares = [0.0, *_halved(line, 0.0, 1.0, 6), 1.0]
        for left, right in pairwise(shares):
            signs = _clear_sign(*line.at(left)) * _clear_sign(*line.at(right))
            for kind in SpecialPoint:
                if signs[kind] < 0.0:
                    share = line.root(partial(_measure, kind), right, left)
                    if share is not None:
                        orbit = line.at(share)[1]
                        specials.append((kind, orbit.from_higher_rest()))
    return specials


def _between(
    equations: OrbitEquations, first: Orbit, second: Orbit
) -> Line[Orbit] | None:
    """The branch between two orbits; None where one of them is not found again.

    Of the two instants of rest another may become the higher one between two orbits.
    """
    rests = second.point[:2], second.rest
    nearer = min(rests, key=lambda rest: np.linalg.norm(rest - first.point[:2]))
    last = np.array([*nearer, second.point[2]])
    chord = last - first.point
    start, end = (
        to_round_off.solve(equations, z, chord, 0.0) for z in (first.point, last)
    )
    if start is None or end is None:
        return None
    ends = [(state, equations.orbit(state.point)) for state in (start, end)]
    return Line(to_round_off, equations, ends[0], ends[1], equations.orbit)


def _measures(state: ContinuationState, orbit: Orbit) -> Vector:
    """Return the quantities that change sign at each kind of special point."""
    index = orbit.stability_index
    return np.array([index + 2.0, index - 2.0, state.tangent[1]])


def _measure(kind: SpecialPoint, state: ContinuationState, orbit: Orbit) -> float:
    return float(_measures(state, orbit)[kind])


def _clear_sign(state: ContinuationState, orbit: Orbit) -> Vector:
    """Signs of the measures; 0 within round-off, as of the direction where branches meet."""
    measures = _measures(state, orbit)
    # below it a sign is left to round-off: where a tongue ends, the index tends to 2
    clear = np.abs(measures) > 1e-9
    clear[SpecialPoint.fold] &= clear[SpecialPoint.index_two]
    return np.where(clear, np.sign(measures), 0.0)


def _halved(line: Line[Orbit], left: float, right: float, splits: int) -> list[float]:
    """Shares between two, by halving wherever a measure may have two zeros between them."""
    middle = 0.5 * (left + right)
    try:
        half = _measures(*line.at(middle))
    except ArithmeticError:
        return []
    if not splits:
        return []
    low, high = (_measures(*line.at(share)) for share in (left, right))
    nearest = np.minimum(np.sign(low) * half, np.minimum(abs(low), abs(high)))
    bend = abs(half - 0.5 * (low + high))
    one_side = _clear_sign(*line.at(left)) * _clear_sign(*line.at(right)) > 0.0
    # a pair of zeros is excluded where the measure stays four times its bend from zero
    if not (one_side & (nearest < 4.0 * bend)).any():
        return []
    return [
        *_halved(line, left, middle, splits - 1),
        middle,
        *_halved(line, middle, right, splits - 1),
    ]
