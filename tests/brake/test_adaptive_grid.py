"""The refined grid finds thin shapes where a uniform one would, at a share of the points."""

import numpy as np
import pytest

from squealpipe.brake.adaptive_grid import refine_grid

SIZE = 257
ROWS, COLUMNS = np.indices((SIZE, SIZE)) / (SIZE - 1)


def test_boundary_is_exact_to_the_cell():
    """A disc with a horn; no point is asked for twice."""
    x, y = ROWS, COLUMNS
    horn = (np.abs(x - 0.5) < 0.008 * (0.95 - y) / 0.15) & (y > 0.5)
    shape, asked = (
        ((x - 0.5) ** 2 + (y - 0.5) ** 2 < 0.09) | horn,
        np.zeros((SIZE, SIZE), int),
    )

    def evaluate(rows, columns):
        asked[rows, columns] += 1
        labels = shape[rows, columns]
        return labels, np.zeros_like(labels), np.full(labels.shape, np.nan)

    grid = refine_grid(evaluate, SIZE, 17)
    np.testing.assert_array_equal(grid.labels, shape)
    np.testing.assert_array_equal(asked, grid.computed)
    assert grid.computed.mean() < 0.1


NONE, NO_WARNING = np.full((SIZE, SIZE), np.nan), np.zeros((SIZE, SIZE), bool)
NEAR = (np.abs(ROWS - 0.51) < 0.05) & (np.abs(COLUMNS - 0.51) < 0.05)
ISLAND = (np.abs(ROWS - 0.51) < 0.004) & (np.abs(COLUMNS - 0.51) < 0.004)
DEPTH = np.abs(ROWS - 0.512) + 0.5 * np.abs(COLUMNS - 0.43) - 0.01


@pytest.mark.parametrize(
    ("lost", "warned", "reserve"),
    [
        (ISLAND, NEAR, NONE),
        (DEPTH < 0.0, NO_WARNING, np.where(DEPTH < 0.0, np.nan, DEPTH)),
    ],
    ids=["beside suspects", "in the floor of a wide valley of the reserve"],
)
def test_thin_islands_are_found_where_something_points_to_them(lost, warned, reserve):
    def refined(warned, reserve):
        return refine_grid(lambda *at: (lost[at], warned[at], reserve[at]), SIZE, 17)

    blind, seeing = refined(NO_WARNING, NONE), refined(warned, reserve)
    assert lost.any()
    assert not blind.labels.any()
    np.testing.assert_array_equal(seeing.labels, lost)
    assert seeing.computed.mean() < 0.1


@pytest.mark.parametrize(
    ("resolution", "coarse"), [(1441, 90), (100, 10), (5, 1), (9, 9 * 2)]
)
def test_grids_that_do_not_nest_are_refused(resolution, coarse):
    with pytest.raises(ValueError, match="power of two"):
        refine_grid(lambda r, c: (r > 0, c > 0, 1.0 * r), resolution, coarse)
