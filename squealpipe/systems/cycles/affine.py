"""Exact derivatives along legs of motion that is linear about a point: one exponential each.

With ẋ = A x + c and ∂f/∂p = B x + d for each parameter p, the state x, its derivatives y by
parameters and 1 obey one linear equation with constant coefficients: ẏ = A y + B x + d.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from squealpipe.systems.taylor.symbols import Symbol, degree

Vector = NDArray[np.float64]


class Affine(NamedTuple):
    """Rates A x + c and their derivatives by parameters, B x + d.

    Attributes:
        matrix, constant: A, (n, n), and c, (n,).
        by_matrix, by_constant: B, (p, n, n), and d, (p, n).
    """

    matrix: Vector
    constant: Vector
    by_matrix: Vector
    by_constant: Vector


def is_affine(rates: Sequence[Symbol]) -> bool:
    """Return whether rates are sums of constants and multiples of the states, in every regime."""
    return all(degree(rate) <= 1.0 for rate in rates)


def derivatives(
    rates: Affine, sizes: Vector, units: Vector, start: Vector, length: float
) -> Vector:
    """Return the derivatives of the state after a leg by its start and parameters, (n, n + p).

    Args:
        sizes: units of the states, (n,).
        units: of the parameters, (p,).
        start: state at the start, (n,).
        length: of the leg, s.
    """
    n, p = len(sizes), len(units)
    matrix = rates.matrix * (sizes / sizes[:, None])
    if p == 0:
        moved = scipy.linalg.expm(matrix * length)
        return np.asarray(moved * (sizes[:, None] / sizes))
    size = n * (1 + p)
    whole = np.zeros((size + 1, size + 1))
    whole[:n, :n], whole[:n, size] = matrix, rates.constant / sizes
    for number, (by_matrix, by_constant) in enumerate(
        zip(rates.by_matrix, rates.by_constant, strict=True)
    ):
        rows = slice((number + 1) * n, (number + 2) * n)
        whole[rows, :n] = by_matrix * (sizes / sizes[:, None]) * units[number]
        whole[rows, size] = by_constant * (units[number] / sizes)
        whole[rows, rows] = matrix
    moved = scipy.linalg.expm(whole * length)
    found = np.empty((n, n + p))
    found[:, :n] = moved[:n, :n] * (sizes[:, None] / sizes)
    first = np.concatenate([start / sizes, np.zeros(n * p), [1.0]])
    ends = (moved @ first)[n:size].reshape(p, n)
    found[:, n:] = ends.T * (sizes[:, None] / units)
    return found
