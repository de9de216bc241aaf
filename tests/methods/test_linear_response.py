"""The recurrence against matrix exponentials and closed forms, also for awkward matrices."""

import numpy as np
import pytest
from scipy.linalg import expm

from squealpipe.methods.linear_response import response_from_rest

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


@pytest.mark.parametrize("name", MATRICES)
def test_agrees_with_the_matrix_exponential(name):
    matrix = np.array(MATRICES[name])
    found = np.array(list(response_from_rest(matrix, LOAD, STEP, STEPS)))
    expected = by_exponential(matrix)
    assert found.shape == expected.shape
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_many_systems_at_once_are_the_same_as_one_by_one():
    stack = np.array(list(MATRICES.values()))
    loads = np.broadcast_to(LOAD, (len(stack), 2))
    together = np.array(list(response_from_rest(stack, loads, STEP, STEPS)))
    for index, matrix in enumerate(stack):
        alone = np.array(list(response_from_rest(matrix, LOAD, STEP, STEPS)))
        np.testing.assert_allclose(together[:, index], alone, rtol=1e-12, atol=1e-12)
