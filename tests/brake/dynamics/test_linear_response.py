"""Linear motions by recurrence against matrix exponentials, and their bounds against both."""

import numpy as np
from scipy.linalg import expm

from squealpipe.brake.dynamics.linear_response import response_from_rest
from squealpipe.brake.ladder.modal_bounds import modal_motion

MATRICES = {
    "symmetric": [[2.0, 0.3], [0.3, 1.0]],
    "not symmetric": [[1.0, 0.9], [0.2, 1.7]],
    "defective": [[1.0, 1.0], [0.0, 1.0]],
    "flutter": [[1.0, 0.5], [-0.5, 1.0]],
    "divergence": [[-0.1, 0.2], [0.2, 1.0]],
    "singular": [[1.0, 1.0], [1.0, 1.0]],
    "zero": [[0.0, 0.0], [0.0, 0.0]],
}
LOAD = np.array([0.3, 0.75])
STEP, STEPS = 0.05, 200


def by_exponential(matrix):
    """The same motion as a first-order system (r, ṙ, 1), stepped by its matrix exponential."""
    whole = np.zeros((5, 5))
    whole[:2, 2:4] = np.eye(2)
    whole[2:4, :2] = -matrix
    whole[2:4, 4] = LOAD
    step = expm(STEP * whole)
    state = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
    states = [state]
    for _ in range(STEPS):
        states.append(step @ states[-1])
    return np.array(states)[:, :2]


def test_agrees_with_the_matrix_exponential():
    """Many systems at once."""
    stack = np.array(list(MATRICES.values()))
    found = np.array(
        list(response_from_rest(stack, np.tile(LOAD, (len(stack), 1)), STEP, STEPS))
    )
    for motion, matrix in zip(found.transpose(1, 0, 2), stack, strict=True):
        expected = by_exponential(matrix)
        np.testing.assert_allclose(
            motion, expected, rtol=0, atol=1e-11 * np.abs(expected).max()
        )


def test_bounds_of_a_motion_hold_and_are_nearly_reached():
    matrix, columns = (
        np.array([[1.3, 0.7], [0.25, 2.1]]),
        lambda values: tuple(np.array(values)[:, None]),
    )
    squared = np.sort_complex(np.linalg.eigvals(matrix).astype(complex))
    rest = columns(np.linalg.solve(matrix, LOAD))
    found = modal_motion(columns(matrix.ravel()), columns(squared), rest)
    times = np.linspace(0.0, 5000.0, 200_001)
    x, y = (values[0] for values in found.positions(times))
    exact = list(response_from_rest(matrix, LOAD, times[1], 2000))
    np.testing.assert_allclose(
        np.stack([x[:2001], y[:2001]], axis=-1), exact, atol=1e-9
    )
    assert y.max() <= found.highest()[0] <= y.max() + 1e-3
    assert np.hypot(x, y).max() <= found.farthest()[0] <= np.hypot(x, y).max() + 1e-3
    assert np.abs(np.gradient(x, times)).max() <= found.fastest()[0] + 1e-6
    for growing in ((1 - 0.1j, 1 + 0.1j), (-0.2 + 0j, 1 + 0j)):
        assert not modal_motion(
            columns(matrix.ravel()), columns(growing), rest
        ).oscillates[0]
