"""Labels on a fine square grid, computed only where they change.

Level by level the spacing is halved. A point takes the label of its nearest coarser neighbour
unless the labels around it differ; then it is computed, and so is everything around it until no
computed label meets a different one that is not. The boundary is thus followed wherever it leads,
into horns far thinner than the first grid. Islands that no coarse point hits are found only next
to *suspects*: points whose answer was almost another one, and points whose *reserve*, the distance
of their answer from the other one, is less than half of what it changes by between neighbours, so
that it may be used up before the next point.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy

Evaluate = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


class RefinedGrid(NamedTuple):
    """Labels of all points, and which of them were computed (the others are inherited)."""

    labels: np.ndarray
    computed: np.ndarray


def refine_grid(evaluate: Evaluate, resolution: int, coarse: int) -> RefinedGrid:
    """Labels on ``resolution`` × ``resolution`` points.

    Args:
        evaluate: (rows, columns) of points → (labels, whether each is a suspect, reserve); the
            reserve is NaN where none is known.
        coarse: points per side of the first grid; (resolution − 1)/(coarse − 1) must be a power
            of two.
    """
    spacing, rest = divmod(resolution - 1, max(coarse - 1, 1))
    if coarse < 2 or rest or spacing < 1 or spacing & (spacing - 1):
        raise ValueError(
            f"resolution = {resolution}, coarse = {coarse}: resolution − 1 must be coarse − 1 "
            f"times a power of two, for instance resolution = {16 * (coarse - 1) + 1}"
        )
    rows, columns = (index.ravel() for index in np.indices((coarse, coarse)) * spacing)
    labels, suspects, reserve = (
        found.reshape(coarse, coarse) for found in evaluate(rows, columns)
    )
    computed = np.ones_like(suspects)
    while spacing > 1:
        spacing //= 2
        doubtful = _refined(suspects | _nearly_used_up(reserve), False)
        labels = labels.repeat(2, 0).repeat(2, 1)[
            :-1, :-1
        ]  # new points take those before them
        computed = _refined(computed, False)
        suspects, reserve = _refined(suspects, False), _refined(reserve, np.nan)
        suspected_here = scipy.ndimage.binary_dilation(doubtful, np.ones((3, 3)))
        while True:
            rows, columns = np.nonzero((_changes(labels) | suspected_here) & ~computed)
            if not rows.size:
                break
            found = evaluate(rows * spacing, columns * spacing)
            labels[rows, columns], suspects[rows, columns], reserve[rows, columns] = (
                found
            )
            computed[rows, columns] = True
    return RefinedGrid(labels, computed)


def follow_boundaries(evaluate: Evaluate, grid: RefinedGrid) -> None:
    """Compute all points of the finest grid where labels change, after some were put right."""
    while True:
        rows, columns = np.nonzero(_changes(grid.labels) & ~grid.computed)
        if not rows.size:
            return
        grid.labels[rows, columns] = evaluate(rows, columns)[0]
        grid.computed[rows, columns] = True


def _changes(labels: np.ndarray) -> np.ndarray:
    """Points with another label next to them."""
    changes, around = np.zeros(labels.shape, bool), np.pad(labels, 1, "edge")
    rows, columns = labels.shape
    for row, column in np.ndindex(3, 3):
        changes |= around[row : row + rows, column : column + columns] != labels
    return changes


def _refined(values: np.ndarray, between: object) -> np.ndarray:
    """Return the same values at half the spacing, with another value at new points."""
    spread = np.full((2 * values.shape[0] - 1,) * 2, between, values.dtype)
    spread[::2, ::2] = values
    return spread


def _nearly_used_up(reserve: np.ndarray) -> np.ndarray:
    """Points whose reserve is small against its range among the points around."""
    known = np.isfinite(reserve)
    most = scipy.ndimage.maximum_filter(np.where(known, reserve, -np.inf), 3)
    least = scipy.ndimage.minimum_filter(np.where(known, reserve, np.inf), 3)
    with np.errstate(invalid="ignore"):
        # a reserve below half of its change between neighbours may be used up between them
        return np.asarray(known & (reserve < 0.5 * (most - least)))
