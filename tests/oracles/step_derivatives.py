"""Derivative of a motion between events, by its initial state and by one parameter.

The variational equations δẍ = A δx + B δẋ + b are collocated in Gauss's points of each Taylor step
of the motion, all steps at once. A step is a small part of the distance to the next singularity,
so that the order of twice seven leaves no more than round-off.
"""

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


def _gauss(points):
    """Nodes in (0, 1), weights, and the integrals of Lagrange's polynomials up to each node."""
    places, weights = np.polynomial.legendre.leggauss(points)
    nodes = 0.5 * (places + 1.0)
    powers = nodes[:, None] ** np.arange(points)
    integrals = powers * nodes[:, None] / np.arange(1, points + 1)
    up_to = np.asarray(np.linalg.solve(powers.T, integrals.T).T, dtype=np.float64)
    return nodes, 0.5 * weights, up_to


_NODES, _WEIGHTS, _ONCE = _gauss(7)
_TWICE, _LAST = _ONCE @ _ONCE, _WEIGHTS @ _ONCE


def step_derivatives(slopes, durations, coefficients):
    """The derivative of the state after each step by the state before it and the parameter.

    Args:
        slopes: states at the nodes, (states, steps x nodes) → derivatives of the accelerations by
            state and parameter, (accelerations, states + 1, steps x nodes).
        durations: of the steps, (steps,).
        coefficients: Taylor's of the state, (steps, states, order + 1); positions come before
            velocities.

    Returns:
        (steps, states + 1, states + 1); the last row keeps the parameter.
    """
    steps, size, terms = coefficients.shape
    half, count = size // 2, len(_NODES)
    h = durations[:, None, None]
    states = (coefficients * h ** np.arange(terms)) @ _NODES ** np.arange(terms)[:, None]
    rates = slopes(np.ascontiguousarray(states.transpose(1, 0, 2)).reshape(size, -1))
    rates = rates.reshape(half, size + 1, steps, count).transpose(2, 3, 0, 1)
    h = durations[:, None, None, None]
    by_place, by_speed = h * h * rates[..., :half], h * rates[..., half:size]
    system = (
        -by_place[..., None, :] * _TWICE[:, None, :, None]
        - by_speed[..., None, :] * _ONCE[:, None, :, None]
    ).reshape(steps, count * half, count * half)
    system += np.eye(count * half)
    right = h * rates
    right[..., half:size] += by_place * _NODES[:, None, None]
    right = right.reshape(steps, count * half, size + 1)
    change = np.linalg.solve(system, right).reshape(steps, count, half, size + 1)
    h = durations[:, None, None]
    result = np.tile(np.eye(size + 1), (steps, 1, 1))
    result[:, :half, half:size] += h * np.eye(half)
    result[:, :half] += h * np.einsum("j,sjab->sab", _LAST, change)
    result[:, half:size] += np.einsum("j,sjab->sab", _WEIGHTS, change)
    return result
