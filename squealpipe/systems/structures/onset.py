"""Where on the way of friction a mode turns unstable, to 1e-10.

Without damping two modes merge: their eigenvalues there depend on friction by a square root, but
the 2 × 2 matrix of both, λ of K v = λ M v on their common subspace, is smooth, and its discriminant
passes through zero. With damping the growth of one mode itself passes through zero.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

from squealpipe.systems.structures.pencil import Pencil
from squealpipe.systems.structures.refinement import SLOW, Eigenpair, polished

LOCATED = 1e-12
"""Tolerance of the friction located."""
NARROW = 2.0**-6
"""Share of a step to which it is narrowed first, so that other modes are not nearer."""
ASIDE = 1e-5
"""Shift off the mean of two squares, relative: the factor of its square must not vanish."""
TURNS = 4
"""Inverse iterations for a subspace."""


def onset(
    pencil_at: Callable[[float], Pencil],
    stable: tuple[float, Eigenpair],
    unstable: tuple[float, Eigenpair],
) -> float | None:
    """The friction between both at which the mode turns unstable.

    Args:
        pencil_at: pencil of a friction.
        stable, unstable: a friction and the mode there.

    Returns:
        None where the mode cannot be followed to it.
    """
    (low, before), (high, after) = stable, unstable
    if pencil_at(high).is_undamped and pencil_at(low).is_undamped:
        measure: Callable[[float], float] = _Subspace(pencil_at, after)
    else:
        measure = _Growth(pencil_at, before, after, (low, high))
    measured: dict[float, float] = {}

    def at(mu: float) -> float:
        if mu not in measured:
            measured[mu] = measure(mu)
        return measured[mu]

    try:
        return _zero(at, low, high)
    except RuntimeError:  # factors are singular: the mode has become another one
        return None


def _zero(measure: Callable[[float], float], low: float, high: float) -> float | None:
    """Where the measure turns positive, sought from the upper end."""
    if not measure(high) > 0:
        return None
    # from the unstable side: the subspace at each place starts from that of the last
    step = NARROW * (high - low)
    upper = high
    while True:
        lower = max(upper - step, low)
        if measure(lower) <= 0 or lower == low:
            break
        upper, step = lower, 1.5 * step
    if not measure(lower) <= 0:
        return None
    zero = brentq(measure, lower, upper, xtol=LOCATED, rtol=4 * np.finfo(float).eps)
    return float(zero)


class _Subspace:
    """Positive where the modes of a subspace grow, without damping; smooth in friction."""

    def __init__(self, pencil_at: Callable[[float], Pencil], after: Eigenpair) -> None:
        self.pencil_at = pencil_at
        self.square = -(after.value**2)
        pair = after.value.imag != 0
        self.right, self.left = (
            np.stack([v.real, v.imag], 1) if pair else v.real[:, None]
            for v in (after.right, after.left)
        )

    def __call__(self, mu: float) -> float:
        pencil = self.pencil_at(mu)
        for _ in range(TURNS):
            solve = _solver(pencil, self.square.real)
            self.right = np.linalg.qr(solve(pencil.mass @ self.right, False))[0]
            self.left = np.linalg.qr(solve(pencil.mass @ self.left, True))[0]
            block = self._block(pencil)
            self.square = complex(np.trace(block) / len(block))
        if len(block) == 1:
            return -float(block[0, 0])
        half = 0.5 * (block[0, 0] - block[1, 1])
        return -float(half**2 + block[0, 1] * block[1, 0])

    def _block(self, pencil: Pencil) -> Any:
        """(WᵀMV)⁻¹ WᵀKV, summed in extended precision."""
        columns = [pencil.products(column) for column in self.right.T]
        left = self.left.T.astype(np.longdouble)
        mass = np.stack([left @ each[0].real for each in columns], 1)
        stiffness = np.stack([left @ each[2].real for each in columns], 1)
        if len(mass) == 1:
            return stiffness / mass
        (a, b), (c, d) = mass
        inverse = np.array([[d, -b], [-c, a]]) / (a * d - b * c)
        return inverse @ stiffness


def _solver(pencil: Pencil, square: float) -> Callable[[np.ndarray, bool], np.ndarray]:
    """Solutions with K − λ M, or its transpose."""
    shift = square + ASIDE * max(abs(square), (SLOW * pencil.unit) ** 2)
    factors = splu(sp.csc_array(pencil.stiffness - shift * pencil.mass))

    def solve(right: Any, transposed: bool) -> Any:
        return factors.solve(np.asarray(right), trans="T" if transposed else "N")

    return solve


class _Growth:
    """Growth rate of a mode, each estimate starting from the nearest friction known."""

    def __init__(
        self,
        pencil_at: Callable[[float], Pencil],
        before: Eigenpair,
        after: Eigenpair,
        ends: tuple[float, float],
    ) -> None:
        self.pencil_at = pencil_at
        self.known = dict(zip(ends, (before, after), strict=True))

    def __call__(self, mu: float) -> float:
        if mu not in self.known:
            near = sorted(self.known, key=lambda each: abs(each - mu))
            guess = self.known[near[0]]
            value = guess.value
            if (
                len(near) > 1 and near[0] != near[1]
            ):  # along the line through the nearest two
                other = self.known[near[1]].value
                value += (other - value) * (mu - near[0]) / (near[1] - near[0])
            self.known[mu] = polished(
                self.pencil_at(mu), value, guess.right, guess.left
            )
        return self.known[mu].value.real
