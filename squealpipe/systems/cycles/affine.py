"""Exact derivatives along legs of motion that is linear about a point: one exponential each.

With ẋ = A x + c and ∂f/∂p = B x + d for each parameter p, the state x, its derivatives y by
parameters and 1 obey one linear equation with constant coefficients: ẏ = A y + B x + d.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from squealpipe.systems.taylor.symbols import Symbol, degree

Vector = NDArray[np.float64]
Rates = Callable[[Vector], Vector]
"""Rates of many states at once: (n, many) → (rates, many)."""


def is_affine(rates: Sequence[Symbol]) -> bool:
    """Return whether rates are sums of constants and multiples of the states, in every regime."""
    return all(degree(rate) <= 1.0 for rate in rates)


def derivatives(
    field: Rates, by: Rates, sizes: Vector, units: Vector, start: Vector, length: float
) -> Vector:
    """Return the derivatives of the state after a leg by its start and parameters, (n, n + p).

    Args:
        field: rates of the states, (n, many).
        by: their derivatives by the parameters, (n p, many), those of a state side by side.
        sizes: units of the states, (n,).
        units: of the parameters, (p,).
        start: state at the start, (n,).
        length: of the leg, s.
    """
    n, p = len(sizes), len(units)
    # at the origin and at one unit of each state: what is affine is known by these
    places = np.column_stack([np.zeros(n), np.diag(sizes)])
    rates = field(places) / sizes[:, None]
    slopes = by(places).reshape(n, p, n + 1) * (units[:, None] / sizes[:, None, None])
    if p == 0:
        moved = scipy.linalg.expm((rates[:, 1:] - rates[:, :1]) * length)
        return np.asarray(moved * (sizes[:, None] / sizes))
    size = n * (1 + p)
    whole = np.zeros((size + 1, size + 1))
    for block, values in enumerate((rates, *slopes.transpose(1, 0, 2))):
        rows = slice(block * n, block * n + n)
        whole[rows, :n] = values[:, 1:] - values[:, :1]
        whole[rows, size] = values[:, 0]
        whole[rows, rows] = rates[:, 1:] - rates[:, :1]
    moved = scipy.linalg.expm(whole * length)
    found = np.empty((n, n + p))
    found[:, :n] = moved[:n, :n] * (sizes[:, None] / sizes)
    first = np.concatenate([start / sizes, np.zeros(n * p), [1.0]])
    ends = (moved @ first)[n:size].reshape(p, n)
    found[:, n:] = ends.T * (sizes[:, None] / units)
    return found
