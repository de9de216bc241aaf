"""Contact points of neighbouring nodes, merged to as many as are asked for.

Idea: the points are halved again and again, across the longer side of where they lie, in proportion
to the number of contacts on each side. Merged points act at the middle of their forces, which keeps
stiffness, force and first moments of the face. Invariant: each point is in one group, and none of
the groups is empty. Cost: a sort for each halving.
"""

import numpy as np


def merged(
    middles: np.ndarray, weights: np.ndarray, numbers: np.ndarray, count: int
) -> list[np.ndarray]:
    """Return so many groups of neighbouring points, ordered by their smallest number.

    Args:
        middles: of the points, (points, 3).
        weights: their areas, (points,), greater than 0.
        numbers: of their nodes, (points,).
        count: number of groups, at most that of points.
    """
    parts = _halved(np.arange(len(middles)), middles, weights, numbers, count)
    groups = [part[np.argsort(numbers[part])] for part in parts]
    return sorted(groups, key=lambda group: int(numbers[group[0]]))


def _halved(
    chosen: np.ndarray,
    middles: np.ndarray,
    weights: np.ndarray,
    first: np.ndarray,
    count: int,
) -> list[np.ndarray]:
    if count == 1:
        return [chosen]
    fewer = count // 2
    order = chosen[_order(middles[chosen], weights[chosen], first[chosen])]
    covered = np.cumsum(weights[order])
    target = covered[-1] * fewer / count
    # where the area is nearest to its part; each half has points for its groups
    split = int(np.argmin(np.abs(covered - target))) + 1
    split = min(max(split, fewer), len(order) - (count - fewer))
    return [
        *_halved(order[:split], middles, weights, first, fewer),
        *_halved(order[split:], middles, weights, first, count - fewer),
    ]


def _order(middles: np.ndarray, weights: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Return the order along the direction in which the points extend farthest."""
    center = np.average(middles, axis=0, weights=weights)
    apart = middles - center
    extent = np.linalg.norm(apart, axis=1).max() or 1.0
    apart = apart / extent
    axis = _longest_axis((apart.T * (weights / weights.sum())) @ apart)
    # round-off must not order points that are level
    along = np.round(apart @ axis, 9)
    return np.lexsort((first, along))


def _longest_axis(spread: np.ndarray) -> np.ndarray:
    """Return the principal axis of the largest spread, the same for any round-off.

    Of a face that extends equally far in several directions, as a square does, round-off would
    choose one; here it is the one nearest to a coordinate axis.

    Args:
        spread: second moments, (3, 3).
    """
    values, axes = np.linalg.eigh(spread)
    longest = axes[:, values >= values[-1] * (1.0 - 1e-6)]
    onto = longest @ longest.T
    nearest = int(np.round(np.diag(onto), 6).argmax())
    axis = onto[:, nearest]
    return np.asarray(axis / np.linalg.norm(axis))
