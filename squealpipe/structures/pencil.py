"""A quadratic pencil Q(s) = M s² + C s + K of real matrices: products and factors.

Up to ``DENSE`` degrees of freedom the work is done by LAPACK, beyond by sparse factors. Damping of
single modes, M Φ diag(2 ζ ω) Φᵀ M, is no sparse matrix; it is carried as a factor of low rank.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from scipy.sparse.linalg import splu

DENSE = 1000
"""Degrees of freedom up to which all eigenvalues are computed by dense algebra."""
LONG_COMPLEX = np.clongdouble
FEW_ENTRIES: dict[str, Any] = {
    "permc_spec": "MMD_AT_PLUS_A",
    "diag_pivot_thresh": 0.01,
    "options": {"SymmetricMode": True},
}
"""Sparse factors of a symmetric pattern off its eigenvalues: pivots on the diagonal will do."""


@dataclass(frozen=True)
class LowRank:
    """U diag(d) Uᵀ.

    Attributes:
        columns: U, (n, k).
        weights: d, (k,).
    """

    columns: np.ndarray
    weights: np.ndarray

    def product(self, vectors: Any) -> Any:
        """U diag(d) Uᵀ x of vectors (n,) or (n, k)."""
        inner = self.columns.T @ vectors
        weights = self.weights if inner.ndim == 1 else self.weights[:, None]
        return self.columns @ (weights * inner)


@dataclass(frozen=True)
class Uncertain:
    """Σ (a s + b) x yᵀ: parts of Q(s) that contact forces and friction, being rounded, leave open.

    Unlike entries that are rounded one by one, all entries of such a part are wrong together.

    Attributes:
        left, right: x and y, (n, k), sparse where the structure is large.
        damping, stiffness: a and b, (k,), each no smaller than 0.
    """

    left: Any
    right: Any
    damping: np.ndarray
    stiffness: np.ndarray


@dataclass(frozen=True)
class Pencil:
    """M s² + (C + U diag(d) Uᵀ) s + K.

    Attributes:
        mass, damping, stiffness: (n, n), real and sparse by rows.
        modal: the part of damping that belongs to single modes.
        uncertain: what the matrices may be wrong by.
    """

    mass: Any
    damping: Any
    stiffness: Any
    modal: LowRank | None = None
    uncertain: Uncertain | None = None

    @property
    def size(self) -> int:
        """Degrees of freedom."""
        return int(self.mass.shape[0])

    @property
    def is_dense(self) -> bool:
        """True if dense algebra is used."""
        return self.size <= DENSE

    @property
    def is_undamped(self) -> bool:
        """True if s enters by its square alone."""
        return not self.damping.nnz and self.modal is None

    @cached_property
    def unit(self) -> float:
        """Lowest frequency of the matrices' rows, rad/s: what is round-off beside it counts as 0.

        The highest would be that of a penalty, which may be as large as it likes.
        """
        mass, damping, stiffness = (
            np.abs(each.diagonal())
            for each in (self.mass, self.damping, self.stiffness)
        )
        for rows in (np.sqrt(stiffness / mass), damping / mass):
            if rows.any():
                return float(rows[rows > 0].min())
        return 1.0

    @cached_property
    def dense(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """M, C and K as arrays, damping of modes included."""
        mass, damping, stiffness = (
            each.toarray() for each in (self.mass, self.damping, self.stiffness)
        )
        if self.modal is not None:
            damping = damping + self.modal.product(np.eye(self.size))
        return mass, damping, stiffness

    @cached_property
    def _extended(self) -> list[Any]:
        return [Extended(each) for each in (self.mass, self.damping, self.stiffness)]

    @cached_property
    def _squares(self) -> list[Any]:
        return [each.power(2) for each in (self.mass, self.damping, self.stiffness)]

    def products(self, vector: np.ndarray) -> tuple[Any, Any, Any]:
        """M x, C x and K x of one vector, summed in extended precision."""
        mass, damping, stiffness = (each.product(vector) for each in self._extended)
        if self.modal is not None:
            damping = damping + self.modal.product(vector.astype(LONG_COMPLEX))
        return mass, damping, stiffness

    def terms(self, s: complex, vector: np.ndarray) -> tuple[Any, Any, Any]:
        """M s² x, C s x and K x, in extended precision."""
        mass, damping, stiffness = self.products(vector)
        number = LONG_COMPLEX(s)
        return mass * number**2, damping * number, stiffness

    def matrix(self, s: complex) -> Any:
        """Q(s) without damping of single modes, sparse."""
        return s * (s * self.mass + self.damping) + self.stiffness

    def from_left(self, s: complex, vector: np.ndarray) -> Any:
        """wᴴ Q(s)."""
        adjoint = vector.conj()
        modal = 0.0 if self.modal is None else s * self.modal.product(adjoint)
        return adjoint @ self.matrix(s) + modal

    def damped(self, vector: np.ndarray) -> Any:
        """Cᵀ x."""
        modal = 0.0 if self.modal is None else self.modal.product(vector)
        return self.damping.T @ vector + modal

    def rate(self, s: Any, vector: np.ndarray) -> Any:
        """Q'(s) x = (2 s M + C) x, of a number and (n,), or of (pairs,) and (n, pairs)."""
        modal = 0.0 if self.modal is None else self.modal.product(vector)
        return 2.0 * s * (self.mass @ vector) + self.damping @ vector + modal

    def rounded(self, s: complex, left: np.ndarray, right: np.ndarray) -> float:
        """Size of wᴴ δQ v where each entry of M, C, K is rounded to double precision."""
        weights, amounts = np.abs(left) ** 2, np.abs(right) ** 2
        size = abs(s)
        total = sum(
            size ** (2 * power) * float(weights @ (squares @ amounts))
            for power, squares in zip((2, 1, 0), self._squares, strict=True)
        )
        return float(np.finfo(float).eps / 2 * np.sqrt(total))

    def left_open(self, s: np.ndarray, left: np.ndarray, right: np.ndarray) -> Any:
        """Largest |wᴴ δQ v| of what is uncertain, of each of some pairs.

        Args:
            s: (pairs,).
            left, right: (n, pairs).
        """
        part = self.uncertain
        if part is None:
            return np.zeros(len(s))
        sizes = np.abs(part.left.T @ left) * np.abs(part.right.T @ right)
        return part.damping @ sizes * np.abs(s) + part.stiffness @ sizes

    def factorized(self, s: complex) -> Factors:
        """Factors of Q(s)."""
        return Factors(self, s)


def sparse_rows(matrix: Any) -> sp.csr_array:
    """Return the sparse rows of a matrix; of an array in a third of the time that SciPy takes."""
    if sp.issparse(matrix):
        return sp.csr_array(matrix)
    places, indices = matrix.nonzero()
    starts = np.searchsorted(places, np.arange(len(matrix) + 1)).astype(np.int32)
    entries = matrix[places, indices], indices.astype(np.int32), starts
    return sp.csr_array(entries, shape=matrix.shape)


class Extended:
    """A matrix of few entries, sparse or not, whose products are summed in extended precision."""

    def __init__(self, matrix: Any) -> None:
        if isinstance(matrix, np.ndarray):
            # in a fifth of the time that it takes to make sparse rows of it
            places, self.indices = matrix.nonzero()
            self.starts = np.flatnonzero(np.diff(places, prepend=-1))
            self.filled = places[self.starts]
            data = matrix[places, self.indices]
        else:
            rows = sp.csr_array(matrix)
            self.filled = np.flatnonzero(np.diff(rows.indptr))
            self.starts = rows.indptr[self.filled]
            self.indices, data = rows.indices, rows.data
        self.data, self.size = data, matrix.shape[0]

    def product(self, vector: np.ndarray) -> np.ndarray:
        """A x."""
        total = np.zeros(self.size, np.result_type(vector, np.longdouble))
        if self.filled.size:
            wide = LONG_COMPLEX if vector.dtype.kind == "c" else np.longdouble
            terms = self.data * vector.astype(wide)[self.indices]
            total[self.filled] = np.add.reduceat(terms, self.starts)
        return total


class Factors:
    """LU factors of Q(s), for solutions of Q x = b and Qᴴ x = b."""

    def __init__(self, pencil: Pencil, s: complex) -> None:
        self.at = s
        self.modal: LowRank | None = None
        if pencil.is_dense:
            mass, damping, stiffness = pencil.dense
            with warnings.catch_warnings():
                # a singular matrix shows in its solutions
                warnings.simplefilter("ignore", la.LinAlgWarning)
                self._dense = la.lu_factor(s * (s * mass + damping) + stiffness)
            self._sparse = None
            return
        # without a damping matrix Q is real on the imaginary axis, and so are its factors: half the
        # memory, and less than half the time
        self._is_real = not pencil.damping.nnz and s.real == 0
        matrix = pencil.matrix(s)
        matrix = sp.csc_array(
            matrix.real if self._is_real else matrix,
            dtype=float if self._is_real else complex,
        )
        # the pattern is symmetric and pivots on the diagonal are good enough for shifts off the
        # eigenvalues; each solution is held against its residual by who uses it
        self._sparse = splu(matrix, **FEW_ENTRIES)
        if pencil.modal is not None:
            # Woodbury's formula: (Q + s U d Uᵀ)⁻¹ by solutions with Q and a small matrix
            self.modal = pencil.modal
            self._solved = self._solutions(pencil.modal.columns.astype(complex))
            self._small = np.eye(len(pencil.modal.weights)) + s * (
                pencil.modal.weights[:, None] * (pencil.modal.columns.T @ self._solved)
            )
            self._weights = s * pencil.modal.weights

    def solve(self, right: np.ndarray) -> Any:
        """Q⁻¹ b."""
        if self._sparse is None:
            return self._regular(la.lu_solve(self._dense, right))
        solution = self._solutions(right)
        if self.modal is None:
            return solution
        inner = self._weights * (self.modal.columns.T @ solution)
        return solution - self._solved @ la.solve(self._small, inner)

    def solve_adjoint(self, right: np.ndarray) -> Any:
        """Q⁻ᴴ b."""
        if self._sparse is None:
            return self._regular(la.lu_solve(self._dense, right, trans=2))
        solution = self._solutions(right, adjoint=True)
        if self.modal is None:
            return solution
        inner = la.solve(self._small.conj().T, self._solved.conj().T @ right)
        correction = self.modal.columns @ (self._weights.conj() * inner)
        return solution - self._solutions(correction, adjoint=True)

    def _regular(self, solution: Any) -> Any:
        """Return the solution, if there is one.

        Raises:
            RuntimeError: the pencil is singular here.
        """
        if not np.isfinite(solution).all():
            raise RuntimeError(f"the pencil is singular at s = {self.at:g}")
        return solution

    def _solutions(self, right: np.ndarray, *, adjoint: bool = False) -> Any:
        """Solve by the sparse factors alone, without damping of single modes."""
        trans = "H" if adjoint else "N"
        factors: Any = self._sparse
        if not self._is_real:
            return factors.solve(right.astype(complex), trans=trans)
        columns = np.column_stack([right.real, right.imag])
        parts = factors.solve(columns, trans=trans)
        half = parts.shape[1] // 2
        return (parts[:, :half] + 1j * parts[:, half:]).reshape(right.shape)
