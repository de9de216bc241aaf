"""Labels on a fine square grid, computed only where they change.

Level by level the spacing is halved. A point takes the label of its nearest coarser neighbour
unless the labels around it differ; then it is computed, and so is everything around it until no
computed label meets a different one that is not. The boundary is thus followed wherever it leads,
into horns far thinner than the first grid. Islands that no coarse point hits are found only next
to *suspects*: points whose answer was almost another one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_dilation, maximum_filter, minimum_filter

Evaluate = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class RefinedGrid(NamedTuple):
    """Labels of all points, and which of them were computed (the others are inherited)."""

    labels: np.ndarray
    computed: np.ndarray


def refine_grid(evaluate: Evaluate, resolution: int, coarse: int) -> RefinedGrid:
    """Labels on ``resolution`` × ``resolution`` points.

    Args:
        evaluate: (rows, columns) of points → (labels, whether each is a suspect).
        resolution: points a side.
        coarse: points a side of the first grid; (resolution − 1)/(coarse − 1) must be a power
            of two.

    Raises:
        ValueError: the two grids do not nest.
    """
    spacing, rest = divmod(resolution - 1, max(coarse - 1, 1))
    if coarse < 2 or rest or spacing < 1 or spacing & (spacing - 1):
        raise ValueError(
            f"resolution = {resolution}, coarse = {coarse}: resolution − 1 must be coarse − 1 "
            f"times a power of two, for instance resolution = {16 * (coarse - 1) + 1}"
        )
    rows, columns = (index.ravel() for index in np.indices((coarse, coarse)) * spacing)
    found, suspected = evaluate(rows, columns)
    labels, suspects = found.reshape(coarse, coarse), suspected.reshape(coarse, coarse)
    computed = np.ones_like(suspects)
    while spacing > 1:
        spacing //= 2
        labels, computed, suspects = _halve(labels), _spread(computed), _spread(suspects)
        suspected_here = binary_dilation(suspects, np.ones((3, 3)))
        while True:
            changes = maximum_filter(labels, 3) != minimum_filter(labels, 3)
            rows, columns = np.nonzero((changes | suspected_here) & ~computed)
            if not rows.size:
                break
            found, suspected = evaluate(rows * spacing, columns * spacing)
            labels[rows, columns] = found
            suspects[rows, columns] = suspected
            computed[rows, columns] = True
    return RefinedGrid(labels, computed)


def _halve(labels: np.ndarray) -> np.ndarray:
    """The same labels at half the spacing, new points taking those before them."""
    parent = np.arange(2 * len(labels) - 1) // 2
    return labels[np.ix_(parent, parent)]


def _spread(flags: np.ndarray) -> np.ndarray:
    """The same flags at half the spacing, False at new points."""
    spread = np.zeros((2 * flags.shape[0] - 1,) * 2, bool)
    spread[::2, ::2] = flags
    return spread
