"""Onset of instability: the friction at which a mode turns unstable, to 1e-10.

Without damping two modes merge: their eigenvalues there depend on friction by a square root, but
the 2 × 2 matrix of both, λ of K v = λ M v on their common subspace, is smooth, and its discriminant
passes through zero. With damping the growth of one mode itself passes through zero. Where a contact
opens or closes the matrices jump, and a mode may turn unstable there.

What was found in a subspace of a large structure is confirmed in the whole: there the same measure
is followed from the vectors of the subspace, and its zero is located again.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

from squealpipe.structures.pencil import FEW_ENTRIES, Pencil
from squealpipe.structures.refinement import (
    Eigenpair,
    Refinement,
    polished,
    unit_vector,
)
from squealpipe.structures.sliding import NoSlidingError, SlidingBalance


@dataclass(frozen=True)
class OnsetSearch:
    """Limits of the search for the friction at which a mode turns unstable."""

    first_narrowing: float = 2.0**-6
    """Share of a step to which it is narrowed first, so that other modes are not nearer."""
    vanished: float = 1e-3
    """A measure has vanished at this share of its size on both sides."""
    aside: float = 1e-5
    """Relative shift off the mean of two squares: the factor of its square must not vanish."""
    most_iterations: int = 6
    """Inverse iterations for a subspace; one from a place nearby takes three."""
    settled: float = 1e-8
    """Relative change of a subspace's eigenvalues from which it converges in one more iteration."""
    same_shape: float = 0.5
    """Cosine of the angle between two shapes from which they may be those of one mode."""
    most_halvings: int = 12
    """A step in friction is halved so often where shapes change more."""
    around: tuple[float, ...] = (1e-3, 1e-2, 1e-1, 1.0)
    """Shares of a step in friction about the onset of the subspace, at which the whole structure
    is measured."""


limits = OnsetSearch()


class Crossing(NamedTuple):
    """Friction at which a mode turns unstable.

    Attributes:
        mu: friction.
        low, high: ends of the step in friction that was searched.
        before, after: the mode there, stable and unstable.
        known: what the measure knows of the mode at the friction nearest to ``mu``, a block or a
            pair; None where a contact opens or closes.
    """

    mu: float
    low: float
    high: float
    before: Eigenpair
    after: Eigenpair
    known: Any = None


def onset(
    pencil_at: Callable[[float], Pencil],
    stable: tuple[float, Eigenpair],
    unstable: tuple[float, Eigenpair],
) -> Crossing | None:
    """Return the friction between two at which the mode turns unstable.

    Args:
        pencil_at: pencil of a friction.
        stable, unstable: a friction and the mode there.

    Returns:
        None where the mode cannot be followed to it.
    """
    (low, before), (high, after) = stable, unstable
    if high - low <= SlidingBalance.located:  # a contact opens or closes between both
        return Crossing(high, low, high, before, after)
    measure: _Followed
    if pencil_at(high).is_undamped and pencil_at(low).is_undamped:
        measure = _Subspace(pencil_at, {high: turned(pencil_at(high), _block(after))})
    else:
        measure = _Growth(pencil_at, {low: before, high: after})
    try:
        mu = _zero(measure, low, high)
    except (RuntimeError, NoSlidingError):
        # factors are singular, the mode has become another one; or friction jams between both
        return None
    if mu is None:
        return None
    return Crossing(mu, low, high, before, after, measure.nearest(mu))


def confirmed(
    pencil_at: Callable[[float], Pencil], found: Crossing, basis: np.ndarray
) -> float | None:
    """Return where the whole structure turns unstable near the onset of a subspace.

    Args:
        pencil_at: pencil of the whole structure at a friction.
        basis: of the subspace, (n, m).

    Returns:
        None where the whole does not turn unstable there, or the mode is lost.
    """
    size = found.high - found.low
    try:
        measure = _measure_of_whole(pencil_at, found, basis)
        for share in limits.around:
            lower = max(found.mu - share * size, found.low)
            upper = min(found.mu + share * size, found.high)
            if measure(upper) > 0 >= measure(lower):
                return _between(measure, lower, upper)
    except RuntimeError:  # the mode has become another one
        return None
    return None


def _measure_of_whole(
    pencil_at: Callable[[float], Pencil], found: Crossing, basis: np.ndarray
) -> "_Followed":
    """The measure of the mode, known next to where it turned unstable in a subspace."""
    # not at the zero itself, where the root of a mode at rest vanishes
    start = min(found.mu + limits.around[0] * (found.high - found.low), found.high)
    pencil = pencil_at(start)
    if isinstance(found.known, Block):
        right, left = (
            np.linalg.qr(basis @ each)[0]
            for each in (found.known.right, found.known.left)
        )
        block = settled(pencil, found.known._replace(right=right, left=left))
        if block is None:
            raise RuntimeError("the subspace does not belong to this structure")
        return _Subspace(pencil_at, {start: block})
    pair = _polished_as(pencil, found.known, basis)
    return _Growth(pencil_at, {start: pair})


def grows(pencil: Pencil, pair: Eigenpair, basis: np.ndarray) -> bool | None:
    """Return whether the mode of a subspace grows in the whole; None if it is none there."""
    try:
        whole = _polished_as(pencil, pair, basis)
    except RuntimeError:
        return None
    return bool(whole.value.real > whole.error)


def _polished_as(pencil: Pencil, pair: Eigenpair, basis: np.ndarray) -> Eigenpair:
    """The mode of the whole that a mode of a subspace stands for.

    Raises:
        RuntimeError: there is none.
    """
    right, left = (unit_vector(basis @ each) for each in (pair.right, pair.left))
    whole = polished(pencil, pair.value, right, left)
    if abs(np.vdot(right, whole.right)) < limits.same_shape:
        raise RuntimeError("the mode has become another one")
    return whole


def _zero(measure: Callable[[float], float], low: float, high: float) -> float | None:
    """Return where the measure turns positive, searched from the upper end."""
    if not measure(high) > 0:
        return None
    # from the unstable side: the subspace at each place starts from that of the last
    step = limits.first_narrowing * (high - low)
    upper = high
    while True:
        lower = max(upper - step, low)
        if measure(lower) <= 0 or lower == low:
            break
        upper, step = lower, 1.5 * step
    at_lower = measure(lower)
    # a friction that is the critical one itself leaves a round-off of either sign
    if (
        0
        < at_lower * (upper - lower)
        <= SlidingBalance.located * (measure(upper) - at_lower)
    ):
        return float(lower)
    if not at_lower <= 0:
        return None
    return _between(measure, lower, upper)


def _between(
    measure: Callable[[float], float], lower: float, upper: float
) -> float | None:
    """The zero between two frictions of which the measure is positive at the upper one."""
    zero = brentq(
        measure, lower, upper, xtol=SlidingBalance.located, rtol=4 * np.finfo(float).eps
    )
    # the measure jumps where the mode has become another one on the way
    largest = max(abs(measure(lower)), abs(measure(upper)))
    return float(zero) if abs(measure(zero)) <= limits.vanished * largest else None


class _Followed:
    """A measure along friction, each value from what is known at the nearest friction.

    Where the step is too large to know what has become of it, the middle comes first.
    """

    def __init__(
        self, pencil_at: Callable[[float], Pencil], known: dict[float, Any]
    ) -> None:
        self.pencil_at, self.known = pencil_at, known

    def nearest(self, mu: float) -> Any:
        """Return the state at the known friction that is nearest."""
        return self.known[min(self.known, key=lambda each: abs(each - mu))]

    def __call__(self, mu: float) -> float:
        self._reach(mu, limits.most_halvings)
        return self._measure(mu)

    def _reach(self, mu: float, halvings: int) -> None:
        if mu in self.known:
            return
        near = min(self.known, key=lambda each: abs(each - mu))
        reached = self._moved(near, mu)
        if reached is not None:
            self.known[mu] = reached
            return
        if not halvings:
            raise RuntimeError("the mode is lost on its way")
        self._reach(0.5 * (near + mu), halvings - 1)
        self._reach(mu, halvings - 1)

    def _moved(self, near: float, mu: float) -> Any:
        """Return the state at a friction from that at another; None if it may be another mode."""
        raise NotImplementedError

    def _measure(self, mu: float) -> float:
        """Return the measure at a friction that was reached."""
        raise NotImplementedError


class Block(NamedTuple):
    """Two modes, or one.

    Attributes:
        right, left: orthonormal bases, (n, 2).
        roots: λ.
        split: the square of half the distance of both; of one mode λ itself.
        matrix: (WᵀMV)⁻¹ WᵀKV of both bases.
    """

    right: np.ndarray
    left: np.ndarray
    roots: list[complex]
    split: float
    matrix: Any = None


class _Subspace(_Followed):
    """Positive where the modes of a subspace grow, without damping; smooth in friction."""

    def _moved(self, near: float, mu: float) -> Block | None:
        start = self.known[near]
        reached = settled(self.pencil_at(mu), start)
        if reached is None:
            return None
        alike = np.linalg.svd(start.right.T @ reached.right, compute_uv=False)
        return reached if alike.min() >= limits.same_shape else None

    def _measure(self, mu: float) -> float:
        return -self.known[mu].split  # type: ignore[no-any-return]


def _block(pair: Eigenpair) -> Block:
    """A mode without damping and the one that it has merged with, if it has."""
    square = -(pair.value**2)
    merged = pair.value.imag != 0
    roots = [square, square.conjugate()] if merged else [complex(square.real)]
    right, left = (
        np.linalg.qr(np.stack([v.real, v.imag], 1) if merged else v.real[:, None])[0]
        for v in (pair.right, pair.left)
    )
    return Block(right, left, roots, 0.0)


def settled(pencil: Pencil, start: Block) -> Block | None:
    """The block after as many inverse iterations as it takes; None if they do not end."""
    last = start
    for _ in range(limits.most_iterations):
        block = turned(pencil, last)
        size = abs(np.mean(block.roots))
        moved = abs(np.mean(block.roots) - np.mean(last.roots)) / size
        opened = abs(block.split - last.split) / size**2
        last = block
        if (
            max(moved, opened) <= limits.settled
        ):  # what is left vanishes in one more turn
            return turned(pencil, last)
    return None


def turned(pencil: Pencil, start: Block) -> Block:
    """The block after one inverse iteration from both sides."""
    solve = _solver(pencil, start.roots)
    right = np.linalg.qr(solve(start.right, False))[0]
    left = np.linalg.qr(solve(start.left, True))[0]
    matrix = _projected(pencil, right, left)
    if len(matrix) == 1:
        return Block(right, left, [complex(matrix[0, 0])], float(matrix[0, 0]))
    mean, half = 0.5 * np.trace(matrix), 0.5 * (matrix[0, 0] - matrix[1, 1])
    split = float(half**2 + matrix[0, 1] * matrix[1, 0])
    distance = np.sqrt(complex(split))
    roots = [float(mean) + distance, float(mean) - distance]
    return Block(right, left, roots, split, matrix)


def _projected(pencil: Pencil, right: np.ndarray, left: np.ndarray) -> Any:
    """(WᵀMV)⁻¹ WᵀKV, summed in extended precision."""
    columns = [pencil.products(column) for column in right.T]
    rows = left.T.astype(np.longdouble)
    mass = np.stack([rows @ column[0].real for column in columns], 1)
    stiffness = np.stack([rows @ column[2].real for column in columns], 1)
    if len(mass) == 1:
        return stiffness / mass
    (a, b), (c, d) = mass
    inverse = np.array([[d, -b], [-c, a]]) / (a * d - b * c)
    return inverse @ stiffness


def _solver(
    pencil: Pencil, roots: list[complex]
) -> Callable[[np.ndarray, bool], np.ndarray]:
    """Inverse iterations about each root in turn, or with the transposed matrices.

    About their mean alone an eigenvalue between both would come in.
    """
    aside = limits.aside * max(
        float(abs(np.mean(roots))), (Refinement.slow * pencil.unit) ** 2
    )
    is_pair = roots[0].imag != 0
    shifts = [roots[0]] if is_pair else [root.real for root in roots]
    # as of other factors: the pattern is symmetric
    order = {} if pencil.is_dense else FEW_ENTRIES
    factors = [
        splu(sp.csc_array(pencil.stiffness - (shift + aside) * pencil.mass), **order)
        for shift in shifts
    ]

    def solve(vectors: Any, transposed: bool) -> Any:
        trans = "T" if transposed else "N"
        for factor in factors:
            right = pencil.mass @ vectors
            vectors = factor.solve(
                right.astype(complex) if is_pair else right, trans=trans
            )
        # the matrices are real: factors about a root are those about its conjugate
        if is_pair:
            right = (pencil.mass @ vectors).conj()
            vectors = factors[0].solve(right, trans=trans).real
        return vectors

    return solve


class _Growth(_Followed):
    """Growth rate of a mode."""

    def _moved(self, near: float, mu: float) -> Eigenpair | None:
        guess = self.known[near]
        value = guess.value
        # along the line through the nearest two
        others = sorted(self.known, key=lambda known: abs(known - mu))
        if len(others) > 1:
            other = others[1] if others[0] == near else others[0]
            slope = (self.known[other].value - value) / (other - near)
            value += float(mu - near) * slope
        pair = polished(self.pencil_at(mu), value, guess.right, guess.left)
        alike = abs(np.vdot(guess.right, pair.right))
        return pair if alike >= limits.same_shape else None

    def _measure(self, mu: float) -> float:
        return self.known[mu].value.real  # type: ignore[no-any-return]
