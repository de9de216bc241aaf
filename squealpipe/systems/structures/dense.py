"""All eigenvalues of a small pencil, by dense algebra, each accurate by itself.

LAPACK's eigenvalues are wrong by round-off of the largest one. Where that is too much for a growth
rate the pair is polished (:mod:`.refinement`). Without damping s² is computed, so that frequencies
of modes that do not grow have no growth at all.
"""

from typing import Any

import numpy as np
import scipy.linalg as la

from squealpipe.systems.structures.pencil import Pencil
from squealpipe.systems.structures.refinement import (
    ENOUGH,
    Eigenpair,
    error_of_rounding,
    error_of_rounding_of_square,
    polished,
    quotient,
    unit_vector,
)

BACKWARD = 8.0
"""Backward error of LAPACK's eigenvalues, in units of round-off of the norm of the matrix."""


def all_modes(pencil: Pencil) -> list[Eigenpair]:
    """An eigenpair for each complex pair and each real eigenvalue, by frequency."""
    find = _undamped if pencil.is_undamped else _damped
    pairs = [_accurate(pencil, pair) for pair in find(pencil)]
    return sorted(pairs, key=lambda each: (each.value.imag, each.value.real))


def _accurate(pencil: Pencil, pair: Eigenpair) -> Eigenpair:
    """The pair itself if it is accurate enough, or polished."""
    value, right, left, error = pair
    on_axis = pencil.is_undamped and value.real == 0  # its growth is exact
    if on_axis or error <= ENOUGH * max(abs(value.real), 1.0):
        return pair
    better = polished(pencil, value, right, left)
    # inverse iteration next to a double eigenvalue may leave for the other one
    if not better.error < error or abs(better.value - value) > max(
        10.0 * error, 1e-9 * abs(value)
    ):
        return pair
    return better


def _undamped(pencil: Pencil) -> list[Eigenpair]:
    """s = ±√−λ of K v = λ M v, those with Im s > 0 or on the real axis."""
    mass, _, stiffness = pencil.dense
    if np.array_equal(stiffness, stiffness.T):
        squares, right = la.eigh(stiffness, mass)
        squares, left = squares.astype(complex), right
    else:
        lower = la.cholesky(mass, lower=True)
        half = la.solve_triangular(lower, stiffness, lower=True)
        matrix = la.solve_triangular(lower, half.T, lower=True).T
        squares, left, right = la.eig(matrix, left=True, right=True)
        right = la.solve_triangular(lower.T, right)
        left = la.solve_triangular(lower.T, left)
    scale = np.abs(squares).max(initial=0.0)
    pairs = []
    for square, v, w in zip(squares, right.T, left.T, strict=True):
        if square.imag == 0:
            pairs += _of_real_square(pencil, square.real, v, w, scale)
        elif square.imag < 0:
            # λ = −s²: of a complex pair λ, λ̄ both roots with Im s > 0 are modes
            root = 1j * np.sqrt(square)
            pairs += [
                _checked(pencil, root, v, w, scale),
                _checked(pencil, -root.conjugate(), v.conj(), w.conj(), scale),
            ]
    return pairs


def _of_real_square(
    pencil: Pencil, square: float, right: np.ndarray, left: np.ndarray, scale: float
) -> list[Eigenpair]:
    """A pair on the imaginary axis, or two real values, of a real λ."""
    v, w = unit_vector(right), unit_vector(left)
    error = _error_of_square(pencil, v, w, scale)
    if abs(square) > error:
        mass, _, stiffness = (w @ each for each in pencil.products(v))
        square = float((stiffness / mass).real)
        error = error**2 / scale + error_of_rounding_of_square(pencil, square, v, w)
    root = np.sqrt(abs(square))
    if abs(square) <= error:  # a rigid body
        return [Eigenpair(0j, v.astype(complex), w.astype(complex), np.sqrt(error))]
    values = [1j * root] if square > 0 else [-root, root]
    spread = error / (2.0 * root)
    return [
        Eigenpair(complex(each), v.astype(complex), w.astype(complex), spread)
        for each in values
    ]


def _error_of_square(
    pencil: Pencil, right: np.ndarray, left: np.ndarray, scale: float
) -> float:
    """Of λ by LAPACK: round-off of the largest one, over the angle of both vectors."""
    carried = pencil.mass @ right
    angle = abs(np.vdot(left, carried)) / np.linalg.norm(carried)
    backward = BACKWARD * np.finfo(float).eps
    # a double eigenvalue moves by the root of what the matrix does
    return float(scale * min(backward / max(angle, 1e-300), np.sqrt(backward)))


def _checked(
    pencil: Pencil, value: complex, right: np.ndarray, left: np.ndarray, scale: float
) -> Eigenpair:
    """A complex root of λ with its error."""
    v, w = unit_vector(right), unit_vector(left)
    error = _error_of_square(pencil, v, w, scale)
    spread = min(error / (2 * abs(value)), np.sqrt(error))
    return Eigenpair(complex(value), v, w, float(spread))


def _damped(pencil: Pencil) -> list[Eigenpair]:
    """Of the linearization in coordinates x = Lᵀv, M = LLᵀ, with (ω x, s x) as its vector."""
    mass, damping, stiffness = pencil.dense
    size = pencil.size
    lower = la.cholesky(mass, lower=True)

    def scaled(matrix: np.ndarray) -> Any:
        half = la.solve_triangular(lower, matrix, lower=True)
        return la.solve_triangular(lower, half.T, lower=True).T

    stiffness, damping = scaled(stiffness), scaled(damping)
    unit = np.sqrt(np.linalg.norm(stiffness, 2)) or np.linalg.norm(damping, 2)
    matrix = np.zeros((2 * size, 2 * size))
    matrix[:size, size:] = unit * np.eye(size)
    matrix[size:, :size] = -stiffness / unit
    matrix[size:, size:] = -damping
    values, left, right = la.eig(matrix, left=True, right=True)
    norm = np.linalg.norm(matrix, 2)
    pairs = []
    for place, (value, x, y) in enumerate(zip(values, right.T, left.T, strict=True)):
        if value.imag < 0:
            continue
        condition = (
            np.linalg.norm(x) * np.linalg.norm(y) / max(abs(np.vdot(y, x)), 1e-300)
        )
        bound = BACKWARD * np.finfo(float).eps * norm
        error = min(bound * condition, np.sqrt(bound * norm))
        v = unit_vector(la.solve_triangular(lower.T, x[:size]).astype(complex))
        w = unit_vector(la.solve_triangular(lower.T, y[size:]).astype(complex))
        if error > ENOUGH * max(abs(value.real), 1.0):
            root, rate = quotient(pencil, value, v, w)
            gap = np.abs(np.delete(values, place) - value).min(initial=np.inf)
            second = error**2 / gap if gap else np.inf
            better = error_of_rounding(pencil, value, v, w, rate) + second
            if better < error and abs(root - value) <= error:
                value = complex(root.real, root.imag if value.imag else 0.0)
                error = better
        pairs.append(Eigenpair(complex(value), v, w, float(error)))
    return pairs
