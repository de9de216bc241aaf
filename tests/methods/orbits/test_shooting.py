"""Derivatives, reversibility and monodromy of the shots."""

import math

import numpy as np
import pytest

from squealpipe.methods.orbits.orbits import solve_orbit
from squealpipe.methods.orbits.shooting import MAX_SEGMENTS, rest_conditions, shoot, stability_index
from squealpipe.solvers.a4.system import scaled_system
from tests.former import FORMER

SCENES = [(0.3, 0.9, -0.9, 2.7, 4.9), (0.2, 0.7, -0.5, 3.2, 9.0), (0.5, 1.0, 0.1, 2.2, 2.6)]


def _conditions(rows, point):
    values, jacobian, final = np.empty(2), np.empty((2, 3)), np.empty(4)
    segments, switches = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS)
    count = rest_conditions(rows, point, segments, switches, values, jacobian, final)
    return values, jacobian, segments, count


@pytest.mark.parametrize("scene", SCENES)
def test_derivatives_agree_with_differences(scene):
    rows = scaled_system(FORMER, scene[0] * math.pi, scene[1] * math.pi).system.rows
    point = np.array(scene[2:])
    _, jacobian, _, _ = _conditions(rows, point)
    step = 1e-6
    for column in range(3):
        shift = step * np.eye(3)[column]
        ahead, behind = (_conditions(rows, point + sign * shift)[0] for sign in (1, -1))
        np.testing.assert_allclose(
            jacobian[:, column], (ahead - behind) / (2 * step), rtol=1e-6, atol=1e-7
        )


@pytest.mark.parametrize("scene", SCENES)
def test_flow_runs_backwards_by_turning_velocities(scene):
    """From the state after half a period, velocities turned, the start comes back."""
    rows = scaled_system(FORMER, scene[0] * math.pi, scene[1] * math.pi).system.rows
    found = solve_orbit(
        scaled_system(FORMER, scene[0] * math.pi, scene[1] * math.pi).system, np.array(scene[2:])
    )
    assert found is not None
    final, again = np.empty(4), np.empty(4)
    work = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS)
    shoot(rows, *found.point, *work, final)
    shoot(rows, final[0], final[1], found.point[2], *work, again)
    np.testing.assert_allclose(again[:2], found.point[:2], atol=1e-13)
    np.testing.assert_allclose(again[2:], 0.0, atol=1e-13)


def test_monodromy_has_two_unit_multipliers_and_a_reciprocal_pair():
    """Its trace − 2 equals λ + 1/λ from a monodromy built by differences of the flow."""
    scene = scaled_system(FORMER, 0.3 * math.pi, 0.9 * math.pi)
    found = solve_orbit(scene.system, np.array([-0.9, 2.7, 4.9]))
    assert found is not None
    monodromy = _monodromy_by_differences(scene.system.rows, found.point)
    multipliers = np.linalg.eigvals(monodromy)
    order = np.argsort(abs(multipliers - 1.0))
    # the double multiplier is defective: differences leave it the square root of their error
    np.testing.assert_allclose(multipliers[order[:2]], 1.0, atol=2e-2)
    assert multipliers[order[2:]].prod() == pytest.approx(1.0, abs=1e-3)
    assert np.trace(monodromy) - 2.0 == pytest.approx(found.stability_index, abs=1e-3)


def _monodromy_by_differences(rows, point, step=1e-6):
    columns = []
    for index in range(4):
        ends = []
        for sign in (1, -1):
            start = np.array([point[0], point[1], 0.0, 0.0])
            start[index] += sign * step
            ends.append(_integrate(rows, start, 2 * point[2]))
        columns.append((ends[0] - ends[1]) / (2 * step))
    return np.column_stack(columns)


def _integrate(rows, start, time):
    """A4 by an independent integrator with dense steps (the field is continuous)."""
    from scipy.integrate import solve_ivp

    def field(_, u):
        row = rows[1 if u[1] > rows[0, 11] else 0]
        ax = row[9] - (row[0] + row[1]) * u[0] - row[2] * u[1]
        ay = row[10] - row[3] * u[0] - (row[0] - row[1]) * u[1]
        return [u[2], u[3], ax, ay]

    return solve_ivp(
        field, (0.0, time), start, method="DOP853", rtol=1e-12, atol=1e-13, max_step=0.01
    ).y[:, -1]


def test_the_index_is_independent_of_where_the_period_starts():
    scene = scaled_system(FORMER, 0.3 * math.pi, 0.9 * math.pi)
    found = solve_orbit(scene.system, np.array([-0.9, 2.7, 4.9]))
    segments, switches, final = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS), np.empty(4)
    count = shoot(scene.system.rows, *found.point, segments, switches, final)
    count = shoot(scene.system.rows, final[0], final[1], found.point[2], segments, switches, final)
    assert stability_index(scene.system.rows, segments, count) == pytest.approx(
        found.stability_index, abs=1e-11
    )
