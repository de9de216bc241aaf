"""Bounds of linear motions against the exact recurrence of the same motion."""

import numpy as np
import pytest

from squealpipe.methods.linear_response import response_from_rest
from squealpipe.methods.modal_bounds import modal_motion

MATRIX = (1.3, 0.7, 0.25, 2.1)
LOAD = np.array([0.2, 0.8])


def motion():
    a = np.array([[MATRIX[0], MATRIX[1]], [MATRIX[2], MATRIX[3]]])
    squared = np.sort_complex(np.linalg.eigvals(a).astype(complex))
    rest = np.linalg.solve(a, LOAD)
    return a, modal_motion(
        tuple(np.array([value]) for value in MATRIX),
        tuple(np.array([value]) for value in squared),
        tuple(np.array([value]) for value in rest),
    )


def test_positions_are_the_exact_response():
    a, found = motion()
    step, count = 0.2, 2000
    exact = np.array(list(response_from_rest(a, LOAD, step, count)))
    x, y = found.positions(step * np.arange(count + 1))
    np.testing.assert_allclose(np.stack([x[0], y[0]], axis=-1), exact, atol=1e-9)


def test_bounds_hold_and_are_nearly_reached():
    _, found = motion()
    times = np.linspace(0.0, 5000.0, 200_001)
    x, y = found.positions(times)
    assert y.max() <= found.highest()[0] <= y.max() + 1e-3
    assert np.hypot(x, y).max() <= found.farthest()[0] <= np.hypot(x, y).max() + 1e-3
    assert np.abs(np.gradient(x[0], times)).max() <= found.fastest()[0] + 1e-6


@pytest.mark.parametrize("squared", [(1 - 0.1j, 1 + 0.1j), (-0.2 + 0j, 1 + 0j)])
def test_flutter_and_divergence_have_no_bound(squared):
    found = modal_motion(
        tuple(np.array([value]) for value in MATRIX),
        tuple(np.array([value]) for value in squared),
        (np.array([0.1]), np.array([0.2])),
    )
    assert not found.oscillates[0]
