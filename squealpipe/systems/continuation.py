"""Continue a branch of F(z) = 0 with one unknown more than equations, by pseudo-arclength.

Idea: predict along the tangent, bent as the last steps were, and correct by Newton's method in the
plane normal to it, so that folds are nothing special. A step is halved where Newton's method
converges slowly or turns too far, and grows where it converges at once. Source: H. B. Keller, in
Applications of Bifurcation Theory (1977). Invariant: tangents keep their sense along a branch.
Cost: two to four evaluations of F and its Jacobian a step.

Settings, algorithm and state are separate; a :class:`Continuation` is iterated and
yields one state after the other, so the caller decides when to stop.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


def length_of(vector: Vector) -> float:
    """Return the norm that ``np.linalg.norm`` has, to the last bit, in less than half its time."""
    whole = vector.ravel()  # BLAS adds up what has gaps in another order
    return math.sqrt(whole.dot(whole))


class PathEquations(Protocol):
    """F: R^(n+1) → R^n with its Jacobian."""

    def evaluate(self, z: Vector) -> tuple[Vector, Vector]:
        """F(z), (n,), and its Jacobian, (n, n + 1)."""


@dataclass(frozen=True, kw_only=True)
class ContinuationSettings:
    """Step control; lengths are relative to 1 + |z|.

    Attributes:
        first_step, shortest_step, longest_step: arclength.
        tolerance: of the largest component of F.
        stagnant: the same where Newton's method gets no further, as by round-off; 0 for never.
        max_iterations: Newton iterations of a step; with more, the step is halved.
        easy_iterations, growth: with no more than these, the next step grows by this factor.
        least_cosine: of the angle between tangents before and after a step.
    """

    first_step: float = 0.01
    shortest_step: float = 1e-7
    longest_step: float = 0.05
    tolerance: float = 1e-11
    stagnant: float = 0.0
    max_iterations: int = 6
    easy_iterations: int = 3
    growth: float = 1.5
    least_cosine: float = 0.97
    max_points: int = 2000

    def __post_init__(self) -> None:
        if not (0.0 < self.shortest_step <= self.first_step <= self.longest_step):
            raise ValueError(
                f"shortest_step = {self.shortest_step!r}, first_step = {self.first_step!r}, "
                f"longest_step = {self.longest_step!r}: they must be positive and ascend"
            )
        if not (self.tolerance > 0.0 and 0.0 < self.least_cosine < 1.0):
            raise ValueError(
                f"tolerance = {self.tolerance!r}, least_cosine = {self.least_cosine!r}: "
                "a positive tolerance and a cosine between 0 and 1 are needed"
            )
        if not (
            0 < self.easy_iterations <= self.max_iterations and self.max_points > 0
        ):
            raise ValueError(
                f"easy_iterations = {self.easy_iterations!r}, max_iterations = "
                f"{self.max_iterations!r}, max_points = {self.max_points!r}: "
                "0 < easy_iterations <= max_iterations and at least one point are needed"
            )


@dataclass(frozen=True)
class ContinuationState:
    """A point of the branch.

    Attributes:
        point: z with F(z) = 0.
        tangent: unit direction of the branch.
        curvature: its change per arclength, by differences.
    """

    point: Vector
    tangent: Vector
    curvature: Vector
    step: float
    iterations: int
    residual: float


@dataclass(frozen=True)
class PseudoArclength:
    """The algorithm: predict along the bending tangent, correct in the plane normal to it.

    Attributes:
        least_iterations: of Newton's method; 0 accepts a guess as it is where it is a solution.
        own_tangent: take it from the Jacobian at the point; else, for one solution of the linear
            system less, from the one before.
    """

    settings: ContinuationSettings
    least_iterations: int = 1
    own_tangent: bool = False

    def correct(
        self, problem: PathEquations, guess: Vector, normal: Vector
    ) -> tuple[Vector, Vector, int, float] | None:
        """Newton's method with normal · dz = 0.

        Returns:
            (point, tangent, iterations, residual), or None where it does not converge. The
            tangent is oriented along ``normal``.
        """
        z, size = guess, len(guess)
        system = np.empty((size, size))
        right = np.zeros((size, 2))
        system[-1], right[-1, 1] = normal, 1.0
        tangent, previous = normal, np.inf
        for iteration in range(self.settings.max_iterations + 1):
            values, jacobian = problem.evaluate(z)
            residual = float(np.abs(values).max())
            stagnates = 0.2 * previous < residual <= self.settings.stagnant
            solved = (
                residual <= self.settings.tolerance or stagnates
            ) and iteration >= self.least_iterations
            if solved and not self.own_tangent:
                break
            if not residual < max(10.0 * previous, self.settings.tolerance):
                return None
            previous = residual
            system[:-1], right[:-1, 0] = jacobian, -values
            try:
                solution = np.linalg.solve(system, right)
            except np.linalg.LinAlgError:
                return None
            tangent = np.asarray(solution[:, 1], dtype=np.float64)
            if solved:
                break
            z = z + solution[:, 0]
        else:
            return None
        return z, tangent / length_of(tangent), iteration, residual

    def solve(
        self, problem: PathEquations, guess: Vector, normal: Vector, step: float
    ) -> ContinuationState | None:
        """The state that :meth:`correct` leads to, of no known curvature, with its next step."""
        correction = self.correct(problem, guess, normal)
        if correction is None:
            return None
        point, tangent, iterations, residual = correction
        return ContinuationState(
            point, tangent, np.zeros_like(point), step, iterations, residual
        )

    def attempt(
        self, problem: PathEquations, state: ContinuationState
    ) -> ContinuationState | None:
        """One step of the state's own length; None where it is not accepted."""
        settings = self.settings
        length = state.step * (1.0 + length_of(state.point))
        guess = (
            state.point
            + length * state.tangent
            + 0.5 * length * length * state.curvature
        )
        corrected = self.correct(problem, guess, state.tangent)
        if corrected is None:
            return None
        point, tangent, iterations, residual = corrected
        near = length_of(point - guess) < 0.3 * length
        if not (near and float(tangent @ state.tangent) > settings.least_cosine):
            return None
        easy = iterations <= settings.easy_iterations
        following = min(
            state.step * (settings.growth if easy else 1.0), settings.longest_step
        )
        curvature = (tangent - state.tangent) / length
        return ContinuationState(
            point, tangent, curvature, following, iterations, residual
        )

    def advance(
        self,
        problem: PathEquations,
        state: ContinuationState,
        accepts: Callable[[ContinuationState], bool] = lambda _: True,
    ) -> ContinuationState | None:
        """The next state that is accepted; None where no step down to the shortest one is."""
        while state.step >= self.settings.shortest_step:
            following = self.attempt(problem, state)
            if following is not None and accepts(following):
                return following
            state = replace(state, step=0.5 * state.step)
        return None


@dataclass(frozen=True)
class Continuation:
    """A branch to be iterated over, from a solution and a direction.

    Attributes:
        adapt: applied to each new state before it is yielded (to describe it otherwise).
    """

    problem: PathEquations
    start: Vector
    direction: Vector
    settings: ContinuationSettings = ContinuationSettings()
    adapt: Callable[[ContinuationState], ContinuationState] = lambda state: state

    def __iter__(self) -> Iterator[ContinuationState]:
        algorithm = PseudoArclength(self.settings)
        unit = self.direction / length_of(self.direction)
        state = ContinuationState(
            self.start, unit, np.zeros_like(unit), self.settings.first_step, 0, 0.0
        )
        while (following := algorithm.advance(self.problem, state)) is not None:
            state = self.adapt(following)
            yield state

    def run(self, stop: Callable[[ContinuationState], bool]) -> list[ContinuationState]:
        """States up to and including the first that ``stop`` accepts, or ``max_points`` of them.

        Fewer that end otherwise are all that could be followed.
        """
        states: list[ContinuationState] = []
        for state in islice(self, self.settings.max_points):
            states.append(state)
            if stop(state):
                break
        return states
