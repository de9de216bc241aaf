"""The search for the smallest vector against sets whose distance is known."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from squealpipe.brake.basins.smallest_vector import search, smallest_linear

RNG = np.random.default_rng(7)


@pytest.mark.parametrize("size", [2, 4])
def test_half_space_and_two_balls(size):
    """Distances of a plane, and of the nearer of two balls, which no ray from 0 need hit."""
    normal = RNG.standard_normal(size)
    normal /= np.linalg.norm(normal)
    found = search(lambda z: z @ normal > 0.37, size, 2.0, 64, np.random.default_rng(1))
    assert math.isclose(np.linalg.norm(found.vector), 0.37, rel_tol=1e-3)
    assert np.linalg.norm(found.vector) >= 0.37
    np.testing.assert_allclose(found.vector, 0.37 * normal, atol=0.03)

    near, far = 1.0 * normal, -1.5 * normal

    def in_a_ball(z):
        return (np.linalg.norm(z - near, axis=1) < 0.4) | (
            np.linalg.norm(z - far, axis=1) < 0.8
        )

    found = search(in_a_ball, size, 3.0, 256, np.random.default_rng(2))
    assert 0.6 <= np.linalg.norm(found.vector) < 0.6 * 1.002


def test_nothing_within_the_bound_is_said_so():
    found = search(lambda z: z[:, 0] > 2.0, 3, 1.5, 16, np.random.default_rng(3))
    assert np.isinf([*found.radius, *found.improved]).all()
    assert np.isnan(found.vector).all()


def test_radii_are_those_of_the_plane_along_each_direction():
    """∞ where the ray leaves the bound first; the share within it is that of a spherical cap."""
    found = search(lambda z: z[:, 0] > 0.5, 3, 1.0, 4000, np.random.default_rng(4))
    reached = np.isfinite(found.radius)
    assert abs(reached.mean() - 0.25) < 4 * math.sqrt(0.25 * 0.75 / 4000)
    assert found.radius[reached].min() >= 0.5


def test_smallest_linear_vector_is_that_of_the_matrix_exponential():
    """Damped, coupled and not symmetric: the level over the longest row that y's motion has."""
    matrix = np.zeros((4, 4))
    matrix[:2, 2:] = np.eye(2)
    matrix[2:, :2] = -np.array([[1.2, 0.5], [-0.3, 2.3]])
    matrix[2:, 2:] = -np.diag([0.05, 0.2])
    row, level, t_end = np.array([0.3, 1.0, 0.0, 0.1]), 0.7, 9.0
    longest = max(
        np.linalg.norm(row @ expm(matrix * t)) for t in np.linspace(0.0, t_end, 1001)
    )
    assert smallest_linear(matrix, row, level, t_end) == pytest.approx(
        level / longest, rel=1e-5
    )
