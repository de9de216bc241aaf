"""Matrices of a structure as they are kept: square, real, finite, sparse by rows."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from squealpipe.structures.pencil import DENSE, sparse_rows
from squealpipe.systems.inputs.values import brief


def real_square(name: str, given: Any, size: int | None = None) -> sp.csr_array:
    """A matrix, dense or sparse, as a sparse one.

    Raises:
        ValueError: it is no matrix, not square, of another size, complex or not finite.
    """
    if sp.issparse(given):
        array = given
    else:
        if np.ma.is_masked(given):
            raise ValueError(f"{name}: masked entries: fill them or leave them out")
        try:
            array = np.asarray(given)
        except ValueError:
            raise ValueError(f"{name}: rows of one length are needed") from None
        if array.ndim != 2 or array.dtype.kind not in "biufc":
            raise ValueError(
                f"{name} = {brief(given)}: a matrix is needed, dense or of scipy.sparse"
            )
    # entries at one place are added up as floats: of bytes 100 + 100 would be -56; and scipy has no
    # sparse matrices of another byte order, as in files of other machines, or of half precision
    wide = complex if array.dtype.kind == "c" else float
    matrix = sparse_rows(array.astype(wide))
    rows, columns = matrix.shape
    if rows != columns or not rows:
        raise ValueError(f"{name} is {rows} × {columns}: a square matrix is needed")
    if size is not None and rows != size:
        raise ValueError(
            f"{name} is {rows} × {rows}, but mass is {size} × {size}: one size is needed"
        )
    if matrix.dtype.kind == "c":
        if np.any(matrix.data.imag):
            raise ValueError(
                f"{name} has complex entries: structural damping has no equation of motion in "
                "time; use modal_damping or a damping matrix"
            )
        matrix = matrix.real
    if not np.isfinite(matrix.data).all():
        place = np.flatnonzero(~np.isfinite(matrix.data))[0]
        row = int(np.searchsorted(matrix.indptr, place, side="right")) - 1
        raise ValueError(
            f"{name}[{row}, {matrix.indices[place]}] = {matrix.data[place]}: finite numbers are "
            "needed"
        )
    matrix.sum_duplicates()
    matrix.eliminate_zeros()
    matrix.sort_indices()
    return matrix


def sum_of_products(left: np.ndarray, right: np.ndarray) -> Any:
    """Return Σ aᵢ bᵢᵀ of the columns of two arrays, (n, k) each, sparse if it is large."""
    # rows of which an array is made in a tenth of the time of a sparse product
    few = 100
    if len(left) <= few:
        # not by BLAS, whose round-off depends on the processor, and with it which of the modes
        # that have met is which (test_onset, seed 77)
        return np.einsum("ik,jk->ij", left, right)
    return sp.csr_array(sp.csr_array(left) @ sp.csr_array(right).T)


def checked_mass(
    mass: sp.csr_array, names: Sequence[str] | None = None
) -> sp.csr_array:
    """A mass that is symmetric and positive definite.

    Args:
        names: of its rows, for messages; None: they are counted from 0.

    Raises:
        ValueError: it is not; names degrees of freedom without mass.
    """
    difference = mass - mass.T
    if difference.nnz:
        difference = sp.coo_array(difference)
        root = np.sqrt(np.abs(mass.diagonal()))
        # a mass this asymmetric, over the geometric mean of both diagonals, is so by round-off
        allowed = 1e-10 * root[difference.row] * root[difference.col]
        if (np.abs(difference.data) > allowed).any():
            half = sp.triu(mass, 1).nnz == 0 or sp.tril(mass, -1).nnz == 0
            raise ValueError(
                "mass is not symmetric"
                + (
                    ": only one triangle is there; mirror the other, A + A.T − diag(A)"
                    if half
                    else "; a symmetric one is needed"
                )
            )
        mass = sp.csr_array(0.5 * (mass + mass.T))
    if names is None or len(names) != mass.shape[0]:
        names, counted = list(map(str, range(mass.shape[0]))), ", counted from 0"
    else:
        counted = ""
    negative = np.flatnonzero(mass.diagonal() < 0)
    if negative.size:
        raise ValueError(
            f"mass is negative at degree of freedom {names[negative[0]]}{counted}: change its sign"
        )
    bare = np.flatnonzero(mass.diagonal() == 0)
    if bare.size == mass.shape[0]:
        raise ValueError(
            f"mass is 0 at all {bare.size} degrees of freedom; give another file, or write it with "
            "its decimals if these were cut off, as in whole numbers"
        )
    if bare.size:
        few = ", ".join(names[place] for place in bare[:5])
        few += ", …" if bare.size > 5 else ""
        raise ValueError(
            f"mass is singular: {bare.size} degrees of freedom have none ({few}{counted}); "
            "condense them in your finite-element program, or give them a small mass"
        )
    if not _is_positive(mass):
        raise ValueError(
            "mass is singular or not positive definite: some motion has no kinetic energy; "
            "condense it, or give it a small mass"
        )
    return mass


def _is_positive(mass: sp.csr_array) -> bool:
    # unit diagonal: degrees of freedom in other units do not look singular
    scale = mass.diagonal() ** -0.5
    limit = mass.shape[0] * np.finfo(float).eps
    if mass.shape[0] <= DENSE:
        # Cholesky factors of what is left above the limit; eigenvalues take ten times as long
        scaled = scale[:, None] * mass.toarray() * scale
        _, failed = la.lapack.dpotrf(scaled - limit * np.eye(mass.shape[0]))
        return bool(failed == 0)
    scaled = sp.diags_array(scale) @ mass @ sp.diags_array(scale)
    try:
        factors = splu(
            sp.csc_array(scaled),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:  # exactly singular
        return False
    kept_order = np.array_equal(factors.perm_r, factors.perm_c)
    return bool(kept_order and (factors.U.diagonal() > limit).all())
