"""General continuation on curves known in closed form, and against the compiled trace."""

import math

import numpy as np
import pytest

from squealpipe.methods.continuation import Continuation, ContinuationEnd, ContinuationSettings
from squealpipe.methods.orbits.orbits import trace_branch
from squealpipe.methods.orbits.shooting import MAX_SEGMENTS, rest_conditions
from squealpipe.solvers.a4.orbits import grazing_start
from squealpipe.solvers.a4.system import scaled_system
from tests.former import FORMER


class Circle:
    """x² + y² = 1: two folds, and back to the start."""

    def evaluate(self, z):
        return np.array([z @ z - 1.0]), 2.0 * z[None, :]


class Ended:
    """A parabola whose equation has no value beyond x = 1."""

    def evaluate(self, z):
        value = z[1] - math.sqrt(1.0 - z[0]) if z[0] <= 1.0 else math.nan
        return np.array([value]), np.array([[0.5 / math.sqrt(max(1.0 - z[0], 1e-12)), 1.0]])


class Shooting:
    """Symmetric orbits as a general problem, for the comparison with the compiled trace."""

    def __init__(self, system):
        self.rows = system.rows

    def evaluate(self, z):
        values, jacobian = np.empty(2), np.empty((2, 3))
        work = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS)
        rest_conditions(self.rows, z.copy(), *work, values, jacobian, np.empty(4))
        return values, jacobian


def test_a_circle_is_followed_through_its_folds():
    branch = Continuation(Circle(), np.array([1.0, 0.0]), np.array([0.0, 1.0]))
    result = branch.run(lambda state: state.point[0] > 0.0 > state.point[1])
    points = np.array([state.point for state in result.states])
    np.testing.assert_allclose(np.hypot(*points.T), 1.0, atol=1e-11)
    assert result.end == ContinuationEnd.stopped
    for state in result.states[1:]:  # whose tangents are those of the last Newton step but one
        assert np.linalg.norm(state.tangent) == pytest.approx(1.0, abs=1e-14)
        assert abs(state.tangent @ state.point) < 1e-3
    assert points[:, 0].min() < -0.99
    assert np.all(np.diff(np.unwrap(np.arctan2(points[:, 1], points[:, 0]))) > 0)


def test_the_end_of_a_curve_and_the_number_of_points_are_reported():
    result = Continuation(Ended(), np.array([0.0, 1.0]), np.array([1.0, -0.5])).run(lambda _: False)
    assert result.end == ContinuationEnd.branch_lost
    settings, start = (
        ContinuationSettings(max_points=7),
        (np.array([1.0, 0.0]), np.array([0.0, 1.0])),
    )
    result = Continuation(Circle(), *start, settings).run(lambda _: False)
    assert (result.end, len(result.states)) == (ContinuationEnd.point_limit, 7)


def test_the_compiled_trace_follows_the_same_branch():
    scene = scaled_system(FORMER, 0.2 * math.pi, 0.7 * math.pi)
    seed = grazing_start(scene, 1)
    control = seed.settings()
    orbits, _ = trace_branch(scene.system, seed.point, seed.direction, 3.0, control, 0.05)
    traced = np.array([orbit.point for orbit in orbits])
    settings = ContinuationSettings(first_step=control.first_step, longest_step=0.05)
    general = Continuation(Shooting(scene.system), seed.point, seed.direction, settings)
    result = general.run(lambda state: bool(state.point[1] > 3.0))
    points = np.array([state.point for state in result.states])
    inside = (points[:, 1] > traced[0, 1]) & (points[:, 1] < traced[-1, 1])
    # linear interpolation between traced points bounds the agreement, not either method
    between = np.interp(points[inside, 1], traced[:, 1], traced[:, 2])
    np.testing.assert_allclose(points[inside, 2], between, rtol=2e-3)
    assert inside.sum() > 10
