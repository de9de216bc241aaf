"""The refined grid finds thin shapes where a uniform one would, at a share of the points."""

import numpy as np
import pytest

from squealpipe.methods.adaptive_grid import refine_grid


def _counted(shape, resolution):
    """The labels of a shape given over 0 … 1, and a record of the points asked for."""
    asked = np.zeros((resolution, resolution), int)

    def evaluate(rows, columns):
        asked[rows, columns] += 1
        labels = shape(rows / (resolution - 1), columns / (resolution - 1))
        return labels, np.zeros_like(labels), np.full(labels.shape, np.nan)

    return evaluate, asked


def _disc_with_horn(x, y):
    disc = (x - 0.5) ** 2 + (y - 0.5) ** 2 < 0.09
    horn = (np.abs(x - 0.5) < 0.004 * (0.95 - y) / 0.15) & (y > 0.5)
    return disc | horn


def test_boundary_is_exact_to_the_cell():
    resolution = 513
    evaluate, asked = _counted(_disc_with_horn, resolution)
    grid = refine_grid(evaluate, resolution, 17)
    rows, columns = np.indices((resolution, resolution)) / (resolution - 1)
    np.testing.assert_array_equal(grid.labels, _disc_with_horn(rows, columns))
    np.testing.assert_array_equal(asked, grid.computed)
    assert grid.computed.mean() < 0.05


def test_islands_are_found_beside_suspects_only():
    resolution = 257

    def island(x, y):
        return (np.abs(x - 0.51) < 0.004) & (np.abs(y - 0.51) < 0.004)

    def evaluate(rows, columns, *, warned):
        x, y = rows / (resolution - 1), columns / (resolution - 1)
        near = (np.abs(x - 0.51) < 0.05) & (np.abs(y - 0.51) < 0.05)
        return island(x, y), near & warned, np.full(x.shape, np.nan)

    blind = refine_grid(lambda r, c: evaluate(r, c, warned=False), resolution, 17)
    seeing = refine_grid(lambda r, c: evaluate(r, c, warned=True), resolution, 17)
    rows, columns = np.indices((resolution, resolution)) / (resolution - 1)
    assert not blind.labels.any()
    np.testing.assert_array_equal(seeing.labels, island(rows, columns))


@pytest.mark.parametrize(("resolution", "coarse"), [(1441, 90), (100, 10), (5, 1), (9, 9 * 2)])
def test_grids_that_do_not_nest_are_refused(resolution, coarse):
    with pytest.raises(ValueError, match="power of two"):
        refine_grid(lambda r, c: (r > 0, c > 0, 1.0 * r), resolution, coarse)


def test_one_grid_is_a_uniform_map():
    grid = refine_grid(lambda r, c: (r > c, r < 0, 1.0 * r), 9, 9)
    assert grid.computed.all()
    np.testing.assert_array_equal(grid.labels, np.greater.outer(np.arange(9), np.arange(9)))


def test_a_valley_of_the_reserve_shows_a_thin_island():
    """A lost strip thinner than the coarse grid, in the floor of a wide valley of the reserve."""
    resolution, centre = 257, 0.512

    def evaluate(rows, columns, *, told):
        x, y = rows / (resolution - 1), columns / (resolution - 1)
        depth = np.abs(x - centre) + 0.5 * np.abs(y - 0.43) - 0.01
        lost = depth < 0.0
        reserve = np.where(lost, np.nan, depth) if told else np.full(x.shape, np.nan)
        return lost, np.zeros(x.shape, bool), reserve

    rows, columns = np.indices((resolution, resolution))
    truth = evaluate(rows, columns, told=False)[0]
    blind = refine_grid(lambda r, c: evaluate(r, c, told=False), resolution, 17)
    seeing = refine_grid(lambda r, c: evaluate(r, c, told=True), resolution, 17)
    assert truth.any()
    assert not blind.labels.any()
    np.testing.assert_array_equal(seeing.labels, truth)
    assert seeing.computed.mean() < 0.1
