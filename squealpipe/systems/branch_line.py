"""A branch between two of its points, and where a function of the point vanishes on it."""

from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np
import scipy
from numpy.typing import NDArray

from squealpipe.systems.continuation import (
    ContinuationState,
    PathEquations,
    PseudoArclength,
    length_of,
)

Vector = NDArray[np.float64]
Found = TypeVar("Found")
ZERO_ROUND_OFF = 1e-9
"""Value below zero that is round-off."""


class Line(Generic[Found]):
    """A branch, or a curve, between two points of it, and a little beyond.

    Args:
        algorithm, equations: what finds further points.
        first, last: both points, each with what is found there.
        found_at: what is found at a point, as a cycle or an orbit.
    """

    def __init__(
        self,
        algorithm: PseudoArclength,
        equations: PathEquations,
        first: tuple[ContinuationState, Found],
        last: tuple[ContinuationState, Found],
        found_at: Callable[[Vector], Found],
    ) -> None:
        self.algorithm, self.equations, self.found_at = algorithm, equations, found_at
        self.known = {0.0: first, 1.0: last}
        self.normal = first[0].tangent
        self.reach = float(self.normal @ (last[0].point - first[0].point))

    def at(self, share: float) -> tuple[ContinuationState, Found]:
        """The point over a share of the step; an ArithmeticError where there is none."""
        if share not in self.known:
            shares = sorted(self.known)
            high = next((s for s in shares if s > share), shares[-1])
            low = shares[shares.index(high) - 1]
            (one, _), (other, _) = self.known[low], self.known[high]
            width, part = high - low, (share - low) / (high - low)
            step = other.point - one.point
            slopes = [
                s.tangent * (width * self.reach / float(self.normal @ s.tangent)) - step
                for s in (one, other)
            ]
            bend = (1.0 - part) * slopes[0] - part * slopes[1]
            if not length_of(bend) < length_of(step):
                bend = np.zeros_like(step)
            guess = one.point + part * step + part * (1.0 - part) * bend
            state = self.algorithm.solve(
                self.equations, guess, self.normal, self.known[0.0][0].step
            )
            if state is None:
                raise ArithmeticError
            self.known[share] = state, self.found_at(state.point)
        return self.known[share]

    def root(
        self,
        test: Callable[[ContinuationState, Found], float],
        end: float = 1.0,
        begin: float = 0.0,
    ) -> float | None:
        """Return where a test is zero between two shares of the step, or None."""

        def value(share: float) -> float:
            found = test(*self.at(share))
            return 1.0 if found == np.inf else found

        tolerance = 1e-12
        try:
            first = value(begin)
            if first <= 0.0 and value(end) < 0.0:
                return begin if first > -ZERO_ROUND_OFF else None
            return float(
                scipy.optimize.brentq(
                    value, begin, end, xtol=tolerance, rtol=tolerance, maxiter=60
                )
            )
        except (ArithmeticError, ValueError, RuntimeError):
            return None
