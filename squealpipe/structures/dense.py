"""All eigenvalues of a small pencil, by dense algebra, each accurate by itself.

LAPACK's eigenvalues are wrong by round-off of the largest one. Where that is too much for a growth
rate the pair is polished (:mod:`.refinement`). Without damping s² is computed, so that frequencies
of modes that do not grow have no growth at all.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from squealpipe.structures.onset import Block, turned
from squealpipe.structures.pencil import LowRank, Pencil
from squealpipe.structures.refinement import (
    Eigenpair,
    Refinement,
    error_of_rounding,
    error_of_rounding_of_square,
    polished,
    quotient,
    unit_vector,
)
from squealpipe.structures.stiff import Gap, condensation, stiff_degrees

BACKWARD = 8.0
"""Backward error of LAPACK's eigenvalues, in units of round-off of the norm of the matrix."""


def all_modes(pencil: Pencil) -> list[Eigenpair]:
    """An eigenpair for each complex pair and each real eigenvalue, by frequency.

    Degrees of freedom that a penalty fixes, or with next to no mass, add none (:mod:`.stiff`).
    """
    find = _undamped if pencil.is_undamped else _damped_slowly
    pairs = [_accurate(pencil, pair) for pair in _without_stiff(pencil, find)]
    if pencil.is_undamped:
        pairs = told_apart(pencil, pairs)
    return sorted(pairs, key=lambda each: (each.value.imag, each.value.real))


def _without_stiff(
    pencil: Pencil, find: Callable[[Pencil], list[Eigenpair]]
) -> list[Eigenpair]:
    """Find the eigenpairs with stiff degrees of freedom condensed, and expand them to all."""
    mass, whole, stiffness = pencil.dense
    stiff = stiff_degrees(mass, stiffness, whole)
    if not stiff.any():
        return find(pencil)
    right = condensation(stiffness, stiff)
    left = condensation(stiffness.T, stiff)
    modal = pencil.modal
    inertia, damping, springs = (
        sp.csr_array(right.T @ (each @ right))
        for each in (pencil.mass, pencil.damping, pencil.stiffness)
    )
    condensed = Pencil(
        inertia,
        damping,
        springs,
        modal and LowRank(right.T @ modal.columns, modal.weights),
    )
    lowest = np.abs(stiffness.diagonal()[stiff] / mass.diagonal()[stiff]).min()
    # inertia of the condensed rows that move along with the kept ones
    moved = np.linalg.norm(right[stiff], 2) if right.size else 0.0
    return [
        Eigenpair(
            pair.value,
            unit_vector(right @ pair.right),
            unit_vector(left @ pair.left),
            pair.error + abs(pair.value) ** 3 / lowest * min(moved, 1.0),
        )
        for pair in find(condensed)
    ]


def _accurate(pencil: Pencil, pair: Eigenpair) -> Eigenpair:
    """The pair itself if it is accurate enough, or polished."""
    value, right, left, error = pair
    on_axis = pencil.is_undamped and value.real == 0  # its growth is exact
    if on_axis or error <= Refinement.enough * max(abs(value.real), 1.0):
        return pair
    try:
        better = polished(pencil, value, right, left)
    except (ValueError, RuntimeError):
        # the pencil is singular next to a double eigenvalue, too (critical damping)
        return pair
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
        matrix = _solved(lower, _solved(lower, stiffness).T).T
        squares, left, right = la.eig(matrix, left=True, right=True)
        right = _solved(lower, right, transposed=True)
        left = _solved(lower, left, transposed=True)
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


def told_apart(pencil: Pencil, pairs: list[Eigenpair]) -> list[Eigenpair]:
    """Replace undamped pairs next to a double eigenvalue by those of their common subspace.

    Where two modes merge their vectors become one, and the error of each alone has no bound. The
    2 × 2 matrix of their common subspace stays accurate, and half the distance of both eigenvalues
    is the square root of a number that its entries give.
    """
    squares = np.array([-(pair.value**2) for pair in pairs])
    told = list(pairs)
    # two that are told apart by so little may be one double eigenvalue, which round-off of the
    # matrices splits by its square root: more than the errors of both by themselves. Growth within
    # its error claims nothing, and is left alone: each block takes several factorizations
    split = {
        index
        for index, pair in enumerate(pairs)
        if pair.error < abs(pair.value.real) <= 1e-6 * abs(pair.value.imag)
    }
    waiting = split | {
        index
        for index, pair in enumerate(pairs)
        # less of an error comes from round-off alone, not from a near neighbour
        if pair.error > 1e-9 * abs(pair.value) and pair.value.imag
    }
    while waiting:
        place = waiting.pop()
        distance = np.abs(squares - squares[place])
        distance[place] = np.inf
        other = int(distance.argmin()) if len(pairs) > 1 else place
        if not distance[other] <= 1e-2 * abs(squares[place]):
            continue
        waiting.discard(other)
        both = _of_block(pencil, pairs[place], pairs[other])
        if both is not None and (place in split or both[0].error < pairs[place].error):
            told[place], told[other] = both
    return told


def _of_block(
    pencil: Pencil, first: Eigenpair, second: Eigenpair
) -> tuple[Eigenpair, Eigenpair] | None:
    """Return both modes from their common subspace; None where they span none."""
    right, left = (
        # where both are all but parallel, their difference spans the second direction
        np.linalg.qr(np.column_stack([_real(one), _real(one) - _real(other)]))[0]
        for one, other in ((first.right, second.right), (first.left, second.left))
    )
    if first.value.real:
        right, left = (
            np.linalg.qr(np.column_stack([each.real, each.imag]))[0]
            for each in (first.right, first.left)
        )
    roots = [complex(-(each.value**2)) for each in (first, second)]
    roots = roots if roots[0].imag else [complex(root.real) for root in roots]
    block = Block(right, left, roots, 0.0)
    try:
        for _ in range(3):
            block = turned(pencil, block)
    except RuntimeError:  # a factor is singular
        return None
    matrix = np.asarray(block.matrix, float)
    mean = 0.5 * float(np.trace(matrix))
    carried = la.svdvals(block.left.T @ (pencil.mass @ block.right))[-1]
    moved = Refinement.sure * max(
        pencil.rounded(1j * np.sqrt(abs(mean)), left, right)
        for left in block.left.T
        for right in block.right.T
    )
    entry = 2.0 * moved / max(carried, 1e-300)
    half = 0.5 * (matrix[0, 0] - matrix[1, 1])
    # the products that made the matrices have rounded their entries more than once
    entry *= 4.0
    doubt = 2.0 * (abs(half) + abs(matrix[0, 1]) + abs(matrix[1, 0])) * entry + entry**2
    split = 0.0 if abs(block.split) <= doubt else block.split
    distance = np.sqrt(complex(split))
    error = np.sqrt(abs(split) + doubt) - np.sqrt(abs(split)) + entry
    roots = [1j * np.sqrt(complex(mean + sign * distance)) for sign in (1, -1)]
    if mean <= 0 or not np.isfinite(error):
        return None
    roots = [-root if root.imag < 0 else root for root in roots]
    pairs = []
    for root in roots:
        y = _null(matrix + root**2 * np.eye(2))
        z = _null((matrix + root**2 * np.eye(2)).conj().T)
        weighted = block.left @ la.solve(
            (block.left.T @ (pencil.mass @ block.right)).T, z
        )
        pairs.append(
            Eigenpair(
                complex(root),
                unit_vector((block.right @ y).astype(complex)),
                unit_vector(weighted.astype(complex)),
                float(error / (2 * abs(root))),
            )
        )
    return pairs[0], pairs[1]


def _null(matrix: np.ndarray) -> Any:
    """Return the vector of the smallest singular value."""
    return la.svd(matrix)[2][-1].conj()


def _real(vector: np.ndarray) -> Any:
    """Return the real vector that a complex one is a multiple of."""
    largest = vector[np.abs(vector).argmax()]
    return unit_vector((vector * (largest.conjugate() / abs(largest))).real)


def _of_real_square(
    pencil: Pencil, square: float, right: np.ndarray, left: np.ndarray, scale: float
) -> list[Eigenpair]:
    """A pair on the imaginary axis, or two real values, of a real λ."""
    v, w = unit_vector(right), unit_vector(left)
    error = _error_of_square(pencil, v, w, scale)
    if abs(square) > error:
        mass, _, stiffness = (w @ product for product in pencil.products(v))
        refined = float((stiffness / mass).real) if mass else np.inf
        bound = error**2 / scale + error_of_rounding_of_square(pencil, refined, v, w)
        # where two modes merge wᴴMv is 0, and the quotient is all round-off
        if bound < error and abs(refined - square) <= 2.0 * error:
            square, error = refined, bound
    root = np.sqrt(abs(square))
    if abs(square) <= error:  # a rigid body
        return [Eigenpair(0j, v.astype(complex), w.astype(complex), np.sqrt(error))]
    values = [1j * root] if square > 0 else [-root, root]
    spread = error / (2.0 * root)
    return [
        Eigenpair(complex(value), v.astype(complex), w.astype(complex), spread)
        for value in values
    ]


def _error_of_square(
    pencil: Pencil, right: np.ndarray, left: np.ndarray, scale: float
) -> float:
    """Return the error of λ by LAPACK: round-off of the largest one, over the angle of both
    vectors.
    """
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


def _damped_slowly(pencil: Pencil) -> list[Eigenpair]:
    """Find the eigenpairs of a damped pencil but for those of nearly massless rows on dashpots.

    Their decay rate, damping over mass, would set the norm to which round-off is relative. So such
    rows get more mass, which changes the other eigenvalues a little; polishing mends that.
    """
    mass, damping, _ = pencil.dense
    rates = np.abs(damping.diagonal()) / mass.diagonal()
    ascending = np.sort(np.maximum(rates, pencil.unit))
    gaps = np.flatnonzero(ascending[1:] > 1e8 * ascending[:-1])
    if not gaps.size:
        return _damped(pencil)
    # far from all that is kept, and near enough for round-off not to count
    cap = 1e5 * max(ascending[gaps[0]], np.sqrt(Gap.least) * pencil.unit)
    fast = rates > cap
    added = np.where(fast, mass.diagonal() * (rates / cap), 0.0)
    lifted = replace(pencil, mass=sp.csr_array(pencil.mass + sp.diags_array(added)))
    return [
        pair._replace(error=max(pair.error, abs(pair.value) ** 2 / cap))
        for pair in _damped(lifted)
        if abs(pair.value) < 1e-2 * cap
    ]


def _solved(lower: np.ndarray, columns: Any, *, transposed: bool = False) -> Any:
    """Return L⁻¹ B or L⁻ᵀ B.

    By BLAS itself: LAPACK's solver, which scipy calls, wakes all threads for two unknowns and takes
    thousands of times as long as the sums.
    """
    (solve,) = la.get_blas_funcs(("trsm",), (lower, columns))
    return solve(1.0, lower, columns, lower=1, trans_a=int(transposed))


def _damped(pencil: Pencil) -> list[Eigenpair]:
    """Return the linearization in coordinates x = Lᵀv, M = LLᵀ, with (ω x, s x) as its vector."""
    mass, damping, stiffness = pencil.dense
    size = pencil.size
    lower = la.cholesky(mass, lower=True)

    def scaled(matrix: np.ndarray) -> Any:
        return _solved(lower, _solved(lower, matrix).T).T

    stiffness, damping = scaled(stiffness), scaled(damping)
    unit = np.sqrt(np.linalg.norm(stiffness, 2)) or np.linalg.norm(damping, 2)
    matrix = np.zeros((2 * size, 2 * size))
    matrix[:size, size:] = unit * np.eye(size)
    matrix[size:, :size] = -stiffness / unit
    matrix[size:, size:] = -damping
    values, left, right = la.eig(matrix, left=True, right=True)
    # a bound: the norm of the blocks off the diagonal is the unit; that of the whole matrix, by
    # singular values, took a fifth of the time
    norm = unit + np.sqrt(np.linalg.norm(damping, 1) * np.linalg.norm(damping, np.inf))
    pairs = []
    shapes = _solved(lower, right[:size], transposed=True).T
    shapes_left = _solved(lower, left[size:], transposed=True).T
    for index, (value, x, y) in enumerate(zip(values, right.T, left.T, strict=True)):
        if value.imag < 0:
            continue
        condition = (
            np.linalg.norm(x) * np.linalg.norm(y) / max(abs(np.vdot(y, x)), 1e-300)
        )
        bound = BACKWARD * np.finfo(float).eps * norm
        error = min(bound * condition, np.sqrt(bound * norm))
        v = unit_vector(shapes[index].astype(complex))
        w = unit_vector(shapes_left[index].astype(complex))
        if error > Refinement.enough * max(abs(value.real), 1.0):
            root, rate = quotient(pencil, value, v, w)
            gap = np.abs(np.delete(values, index) - value).min(initial=np.inf)
            second = error**2 / gap if gap else np.inf
            better = error_of_rounding(pencil, value, v, w, rate) + second
            if better < error and abs(root - value) <= error:
                value = complex(root.real, root.imag if value.imag else 0.0)
                error = better
        pairs.append(Eigenpair(complex(value), v, w, float(error)))
    return pairs
