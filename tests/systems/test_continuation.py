"""General continuation on curves known in closed form."""

import math

import numpy as np
import pytest

from squealpipe.systems.continuation import Continuation, ContinuationSettings


class Circle:
    """x² + y² = 1: two folds, and back to the start."""

    def evaluate(self, z):
        return np.array([z @ z - 1.0]), 2.0 * z[None, :]


class Ended:
    """A parabola whose equation has no value beyond x = 1."""

    def evaluate(self, z):
        value = z[1] - math.sqrt(1.0 - z[0]) if z[0] <= 1.0 else math.nan
        return np.array([value]), np.array(
            [[0.5 / math.sqrt(max(1.0 - z[0], 1e-12)), 1.0]]
        )


def test_a_circle_is_followed_through_its_folds():
    branch = Continuation(Circle(), np.array([1.0, 0.0]), np.array([0.0, 1.0]))
    states = branch.run(lambda state: state.point[0] > 0.0 > state.point[1])
    points = np.array([state.point for state in states])
    np.testing.assert_allclose(np.hypot(*points.T), 1.0, atol=1e-11)
    assert points[-1, 0] > 0.0 > points[-1, 1]
    for state in states[1:]:  # whose tangents are those of the last Newton step but one
        assert np.linalg.norm(state.tangent) == pytest.approx(1.0, abs=1e-14)
        assert abs(state.tangent @ state.point) < 1e-3
    assert points[:, 0].min() < -0.99
    assert np.all(np.diff(np.unwrap(np.arctan2(points[:, 1], points[:, 0]))) > 0)


def test_a_branch_ends_with_its_curve_or_the_number_of_points():
    ended = Continuation(Ended(), np.array([0.0, 1.0]), np.array([1.0, -0.5]))
    states = ended.run(lambda _: False)
    assert 0 < len(states) < ended.settings.max_points
    assert 0.99 < states[-1].point[0] <= 1.0
    settings = ContinuationSettings(max_points=7)
    circle = Continuation(
        Circle(), np.array([1.0, 0.0]), np.array([0.0, 1.0]), settings
    )
    assert len(circle.run(lambda _: False)) == 7
