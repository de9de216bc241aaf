"""Eigenpairs polished by inverse iteration from both sides and Rayleigh's quotient.

The quotient with right and left vectors, a root of (wᴴMv) s² + (wᴴCv) s + wᴴKv, is wrong by the
product of the errors of both (P. Lancaster, Lambda-matrices and Vibrating Systems, 1966). Its
three numbers are summed in extended precision: in double, rounding hides growth rates below about
1e-13 of the largest frequency of the matrices, which in finite elements is a thousand times that
of squeal.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from squealpipe.structures.pencil import Factors, Pencil
from squealpipe.systems.progress import with_progress


@dataclass(frozen=True)
class Refinement:
    """Thresholds of the refinement of eigenpairs."""

    slow: float = 1e-4
    """Values below this share of the entries' frequency count as so much where shifts are
    chosen."""
    enough: float = 1e-8
    """Error that needs no polishing, relative to the growth rate, below 1/s absolutely."""
    sure: float = 4.0
    """Standard deviations of rounded entries that an error bound covers."""


class Estimate(NamedTuple):
    """An eigenvalue with its vectors, as of a search about a point.

    Attributes:
        factors: of the pencil at a point nearby.
    """

    value: complex
    right: np.ndarray
    factors: Factors
    left: np.ndarray


class Eigenpair(NamedTuple):
    """One eigenvalue with its vectors.

    Attributes:
        value: s, rad/s.
        right, left: (n,) of Q v = 0 and wᴴ Q = 0, length 1.
        error: of the value, rad/s: of the iteration and of entries rounded to double precision.
    """

    value: complex
    right: np.ndarray
    left: np.ndarray
    error: float


def quotient(
    pencil: Pencil, value: complex, right: np.ndarray, left: np.ndarray
) -> tuple[complex, complex]:
    """The root s next to ``value`` of wᴴ Q(s) v, and wᴴ Q'(s) v there."""
    adjoint = left.conj().astype(np.clongdouble)
    mass, damping, stiffness = (adjoint @ product for product in pencil.products(right))
    root = np.clongdouble(value)
    rate = 2 * mass * root + damping
    for _ in range(3):
        if rate == 0:
            break
        root = root - ((mass * root + damping) * root + stiffness) / rate
        rate = 2 * mass * root + damping
    return complex(root), complex(rate)


def error_of_rounding(
    pencil: Pencil, value: complex, right: np.ndarray, left: np.ndarray, rate: complex
) -> float:
    """Return how far rounded entries of the matrices can have moved an eigenvalue, rad/s."""
    moved = Refinement.sure * pencil.rounded(value, left, right)
    return float(_shift(pencil, moved, right, left, rate))


def with_errors_of_forces(
    pencil: Pencil, pairs: Sequence[Eigenpair]
) -> list[Eigenpair]:
    """Add to the errors of pairs how far rounded contact forces and friction can have moved them.

    One product for all pairs: of a few hundred modes each product alone takes longer to start than
    to compute.
    """
    if not pairs or pencil.uncertain is None:
        return list(pairs)
    values = np.array([pair.value for pair in pairs])
    right = np.array([pair.right for pair in pairs]).T
    left = np.array([pair.left for pair in pairs]).T
    moved = pencil.left_open(values, left, right)
    rates = (left.conj() * pencil.rate(values, right)).sum(axis=0)
    shifts = _shift(pencil, moved, right, left, rates)
    return [
        pair._replace(error=pair.error + float(shift))
        for pair, shift in zip(pairs, shifts, strict=True)
    ]


def _shift(pencil: Pencil, moved: Any, right: Any, left: Any, rate: Any) -> Any:
    """Return the shifts of eigenvalues where wᴴ Q v changes by so much.

    Args:
        moved, rate: changes and wᴴ Q' v, numbers or (pairs,).
        right, left: (n,) or (n, pairs).
    """
    # next to a double eigenvalue the shift is a square root instead; without damping wᴴMv vanishes
    # there as well, and the sizes of its terms stand in for it
    mass = (np.abs(left) * (abs(pencil.mass) @ np.abs(right))).sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        curved = np.where(mass > 0.0, np.sqrt(moved / mass), 0.0)
        straight = np.where(rate == 0.0, np.inf, moved / np.abs(rate))
    return np.minimum(straight, curved)


def error_of_rounding_of_square(
    pencil: Pencil, square: float, right: np.ndarray, left: np.ndarray
) -> float:
    """Return how far rounded entries can have moved λ of K v = λ M v."""
    moved = Refinement.sure * pencil.rounded(np.sqrt(abs(square)), left, right)
    return float(moved / max(abs(np.vdot(left, pencil.mass @ right)), 1e-300))


def polished(
    pencil: Pencil, value: complex, right: np.ndarray, left: np.ndarray
) -> Eigenpair:
    """The eigenpair next to an estimate."""
    right, left = right.astype(complex), left.astype(complex)
    change, rate = np.inf, 0j
    for _ in range(4):
        # relative: at the eigenvalue itself the matrix is singular
        offset = 1e-9 * max(abs(value), Refinement.slow * pencil.unit) * (1.0 + 0.5j)
        factors = pencil.factorized(value + offset)
        before = value
        for _ in range(2):
            known = pencil.rate(value, right), pencil.rate(value, left)
            if not all(each.any() for each in known):
                raise RuntimeError(
                    "the derivative of the pencil vanishes: a double eigenvalue"
                )
            right = unit_vector(factors.solve(known[0]))
            left = unit_vector(factors.solve_adjoint(known[1]))
            last, (value, rate) = value, quotient(pencil, value, right, left)
            change = abs(value - last)
        if abs(value - before) <= 1e-6 * abs(value):
            break
    error = change + error_of_rounding(pencil, value, right, left, rate)
    return Eigenpair(value, right, left, error)


def refined(pencil: Pencil, estimates: Sequence[Estimate]) -> Iterator[Eigenpair]:
    """Each eigenpair by Rayleigh's quotient, polished where that is not accurate enough."""
    values = np.array([estimate.value for estimate in estimates])
    for index, each in enumerate(with_progress(estimates)):
        right, left = unit_vector(each.right), unit_vector(each.left)
        value, rate = quotient(pencil, each.value, right, left)
        others = np.abs(np.delete(values, index) - value)
        # what is left of the vectors' errors, wᴴQ Q⁻¹ Q v, by the factors of a point nearby: these
        # see the part along a neighbour smaller by its distance over that of the point
        residual = sum(pencil.terms(value, right)).astype(complex)
        rest = pencil.from_left(value, left) @ each.factors.solve(residual)
        nearby = max(abs(value - each.factors.at) / others.min(initial=np.inf), 1.0)
        error = abs(rest / rate) * nearby if rate else np.inf
        if error > Refinement.enough * max(abs(value.real), 1.0):
            yield polished(pencil, value, right, left)
        else:
            error += error_of_rounding(pencil, value, right, left, rate)
            yield Eigenpair(value, right, left, error)


def growing_first(pairs: Sequence[Eigenpair]) -> list[Eigenpair]:
    """Sort by frequency; of two that have merged the growing one comes first.

    A limit on the number of modes would else cut it off.
    """
    ordered = sorted(pairs, key=lambda each: (each.value.imag, -each.value.real))
    for index in range(1, len(ordered)):
        first, second = ordered[index - 1].value, ordered[index].value
        # the frequencies of both differ by round-off
        if second.imag - first.imag <= 1e-9 * second.imag and second.real > first.real:
            ordered[index - 1 : index + 1] = ordered[index], ordered[index - 1]
    return ordered


def unit_vector(vector: np.ndarray) -> Any:
    """A vector of length 1."""
    return vector / np.linalg.norm(vector)
