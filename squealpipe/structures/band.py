"""All eigenvalues of a large sparse pencil in a band of frequencies, and how that is known.

Shift-and-invert Arnoldi about points of the imaginary axis finds the eigenvalues next to each, so
discs about several points cover the band. It is covered twice: by right eigenvectors, and about
other points, from other random starts, by left ones. An eigenvalue that one search missed would
stand alone in the other: then the band is searched again, with more eigenvalues to a disc.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from squealpipe.structures.dense import told_apart
from squealpipe.structures.pencil import Factors, Pencil
from squealpipe.structures.refinement import Eigenpair, Estimate, refined
from squealpipe.systems.progress import with_progress

FIRST_AT = {"right": 0.5, "left": 0.2}
"""Places of the first disc of each search in the band."""
SAME = 1e-6
"""Relative distance up to which values of both searches are one eigenvalue."""


class IncompleteError(RuntimeError):
    """The searches by right and by left eigenvectors do not agree."""


class Region(NamedTuple):
    """|Re s| ≤ half_width and 0 ≤ Im s ≤ height, rad/s."""

    half_width: float
    height: float

    def holds(self, value: complex, margin: float = 0.0) -> bool:
        """Return whether a value is within, or outside by no more than a relative margin."""
        outside = max(
            abs(value.real) / self.half_width,
            value.imag / self.height,
            -value.imag / (margin or 1.0) / self.height + 1.0,
        )
        return outside <= 1.0 + margin


class Near(NamedTuple):
    """An eigenvector next to a point.

    Attributes:
        center: the point.
        factors: there; None of left eigenvectors, whose factors nobody needs again.
    """

    value: complex
    vector: np.ndarray
    center: complex
    factors: Factors | None


def modes_in_band(pencil: Pencil, omega_max: float) -> list[Eigenpair]:
    """Eigenpairs with 0 ≤ Im s ≤ ω and |Re s| ≤ ω/4, by frequency.

    Args:
        omega_max: ω, rad/s.

    Raises:
        IncompleteError: the two searches still differ after three rounds.
    """
    # Largest |growth| of the eigenvalues looked for, over the largest angular frequency: modes
    # that grow or decay faster do not oscillate
    largest_growth = 0.25
    region = Region(largest_growth * omega_max, omega_max)
    most_searches = 3
    for search in range(most_searches):
        # eigenvalues about one point at first; twice as many in each further search
        number = 40 * 2**search
        sides = [
            list(_distinct(_covering(pencil, region, side, number, seed=search)))
            for side in with_progress(list(FIRST_AT))
        ]
        pairs, single = _matched(sides[0], sides[1], region)
        if not single:
            told = list(refined(pencil, pairs))
            if pencil.is_undamped:
                told = told_apart(pencil, told)
            return [pair for pair in told if region.holds(pair.value)]
    values = ", ".join(f"{value:.6g}" for value in single)
    raise IncompleteError(
        f"the searches by right and by left eigenvectors differ at {values} rad/s; change "
        "frequency_max a little, so that its border does not touch an eigenvalue"
    )


def _covering(
    pencil: Pencil, region: Region, side: str, number: int, seed: int
) -> Iterator[Near]:
    """Eigenvalues in discs that cover the region."""
    waiting = [(0.0, region.height, FIRST_AT[side])]
    while waiting:
        low, high, share = waiting.pop()
        center = 1j * (low + share * (high - low))
        factors = pencil.factorized(center)
        most = min(number, 2 * pencil.size - 2)
        while True:
            values, vectors = _nearest(pencil, factors, center, side, most, seed)
            radius = float(np.abs(values - center).max(initial=0.0))
            reach = np.sqrt(max(radius**2 - region.half_width**2, 0.0))
            if reach > 0.02 * region.height or most == 2 * pencil.size - 2:
                break
            most = min(2 * most, 2 * pencil.size - 2)
        for value, vector in zip(values, vectors.T, strict=True):
            # an eigenvalue next to the border, relative to itself, may be in one search only
            if region.holds(value, 1e-3):
                kept = factors if side == "right" else None
                yield Near(complex(value), vector, center, kept)
        rests = ((low, center.imag - reach), (center.imag + reach, high))
        if most < 2 * pencil.size - 2:
            waiting += [(*rest, 0.5) for rest in rests if rest[0] < rest[1]]


def _nearest(
    pencil: Pencil, factors: Factors, center: complex, side: str, number: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues next to a point and their vectors, as many as converge."""
    apply = (_right if side == "right" else _left)(pencil, factors, center)
    size = pencil.size
    start = np.random.default_rng([seed, side == "left"]).standard_normal(2 * size)
    operator = LinearOperator((2 * size, 2 * size), apply, dtype=complex)
    try:
        inverse, vectors = eigs(operator, k=number, v0=start.astype(complex), tol=1e-12)
    except ArpackNoConvergence as partly:
        inverse, vectors = partly.eigenvalues, partly.eigenvectors
    if side == "right":
        return center + 1.0 / inverse, vectors[:size]
    return center + 1.0 / inverse.conj(), vectors[size:]


def _right(
    pencil: Pencil, factors: Factors, center: complex
) -> Callable[[np.ndarray], np.ndarray]:
    """(A − cB)⁻¹ B of A = [[0, 1], [−K, −C]], B = diag(1, M), for x = (v, s v/|c|)."""
    size, unit = pencil.size, abs(center)

    def apply(x: np.ndarray) -> np.ndarray:
        upper, lower = x.ravel()[:size], unit * x.ravel()[size:]
        known = pencil.mass @ (lower - center * upper) + pencil.rate(center, upper)
        solution = -factors.solve(known)
        return np.concatenate([solution, (upper + center * solution) / unit])

    return apply


def _left(
    pencil: Pencil, factors: Factors, center: complex
) -> Callable[[np.ndarray], np.ndarray]:
    """(A − cB)⁻ᴴ Bᴴ of the same: its eigenvectors are y = (…, w), with wᴴ Q(s) = 0.

    From yᴴA = s yᴴB: y₁ = −Kᵀw/s̄, and w solves Q(s)ᴴ w = 0.
    """
    size, unit = pencil.size, abs(center)
    conjugate = np.conj(center)

    def apply(y: np.ndarray) -> np.ndarray:
        upper, lower = unit * y.ravel()[:size], y.ravel()[size:]
        # −Kᵀ z₂ − c̄ z₁ = y₁ and z₁ − (Cᵀ + c̄ Mᵀ) z₂ = Mᵀ y₂
        inertia = pencil.mass.T @ lower
        solution = -factors.solve_adjoint(upper + conjugate * inertia)
        first = (
            inertia + pencil.damped(solution) + conjugate * (pencil.mass.T @ solution)
        )
        return np.concatenate([first / unit, solution])

    return apply


def _distinct(estimates: Iterator[Near]) -> Iterator[Near]:
    """Those that overlapping discs have in common once."""
    kept: list[Near] = []
    for new in estimates:
        same = (
            abs(new.value - old.value) <= SAME * abs(new.value)
            and new.center != old.center
            and _parallel(new.vector, old.vector)
            for old in kept
        )
        if not any(same):
            kept.append(new)
            yield new


def _matched(
    right: list[Near], left: list[Near], region: Region
) -> tuple[list[Estimate], list[complex]]:
    """Pairs of one eigenvalue, and the values that only one of the searches has."""
    at_right = np.array([each.value for each in right])
    at_left = np.array([each.value for each in left])
    distance = np.abs(at_right[:, None] - at_left[None, :])
    pairs, single = [], [*right, *left]
    for i, j in zip(*linear_sum_assignment(distance), strict=True):
        if distance[i, j] <= SAME * abs(at_right[i]):
            partner = right[i]
            assert partner.factors is not None  # noqa: S101 (of right eigenvectors)
            pairs.append(
                Estimate(partner.value, partner.vector, partner.factors, left[j].vector)
            )
            single = [
                each for each in single if each is not right[i] and each is not left[j]
            ]
    return pairs, [each.value for each in single if region.holds(each.value)]


def _parallel(first: np.ndarray, second: np.ndarray) -> bool:
    product = abs(np.vdot(first, second))
    return bool(product > (1 - 1e-6) * np.linalg.norm(first) * np.linalg.norm(second))
