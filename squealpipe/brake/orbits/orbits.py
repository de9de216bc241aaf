"""Symmetric periodic orbits of a piecewise-linear system, exact to round-off.

Idea: an orbit that is at rest at (x0, y0) and again after T/2 is periodic, so z = (x0, y0, T/2) has
to fulfil two equations: both velocities vanish after half a period. A plane in z, given or chosen
by pseudo-arclength, is the third for Newton's method; the compiled kernels of
:mod:`squealpipe.brake.orbits.shooting` do the work. Invariant: an orbit states its ``residual``,
the largest velocity at the second rest. Cost: one shot over half a period for each Newton step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.orbits.modal_flow import propagator
from squealpipe.brake.orbits.orbit_shape import extremes
from squealpipe.brake.orbits.piecewise_linear import PiecewiseLinearSystem
from squealpipe.brake.orbits.shooting import (
    fastest,
    push,
    rest_conditions,
    shooting_limits,
    solve_constrained,
    stability_index,
)
from squealpipe.systems.continuation import (
    ContinuationSettings,
    ContinuationState,
    PseudoArclength,
    length_of,
)

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Orbit:
    """A symmetric periodic orbit in the units of its system.

    Attributes:
        point: (3,) x0 and y0 at an instant of rest, and T/2; of both instants the one with the
            larger y unless said otherwise.
        rest: (2,) x and y at the other instant of rest.
        switches: times at which y crosses the threshold within the half period after ``point``.
        stability_index: trace of the monodromy matrix − 2.
        residual: largest velocity at ``rest``.
    """

    point: Vector
    rest: Vector
    switches: Vector
    stability_index: float
    residual: float

    @property
    def omega(self) -> float:
        """Angular frequency 2π/T, in radians per unit of time."""
        return float(math.pi / self.point[2])

    def from_higher_rest(self) -> Orbit:
        """Return the same orbit, described from its instant of rest with the larger y."""
        if self.rest[1] <= self.point[1]:
            return self
        point = np.array([*self.rest, self.point[2]])
        times = self.point[2] - self.switches[::-1]
        return Orbit(point, self.point[:2], times, self.stability_index, self.residual)

    def flight(self, threshold: float) -> float:
        """Time above the threshold within half a period."""
        times = [0.0, *self.switches.tolist(), float(self.point[2])]
        first = int(self.point[1] <= threshold)
        legs = range(first, len(times) - 1, 2)
        return float(sum(times[i + 1] - times[i] for i in legs))

    def largest_y(self, system: PiecewiseLinearSystem) -> float:
        """Largest y over the period."""
        out = np.empty(6)
        extremes(system.rows, np.ascontiguousarray(self.point, dtype=float), out)
        return float(out[3])


class _Shot(NamedTuple):
    """A shot over half a period; velocities are NaN where it was given up."""

    point: Vector
    velocities: Vector
    gradients: Vector
    segments: Vector
    switches: Vector
    final: Vector
    legs: int


class OrbitEquations:
    """Rest at both ends of half a period: two equations for z = (x0, y0, T/2).

    Attributes:
        fastest: angular frequency of the fastest mode of either linear state.
        work: phase through which that mode has run in all shots of Newton's method, rad; a measure
            of cost.
    """

    def __init__(self, system: PiecewiseLinearSystem) -> None:
        self.system, self.rows = system, system.rows
        self.fastest, self.work = float(fastest(system.rows)), 0.0
        nothing = np.empty(0)
        self._latest = _Shot(nothing, nothing, nothing, nothing, nothing, nothing, 0)
        self._latest_orbit: Orbit | None = None

    def evaluate(self, z: Vector) -> tuple[Vector, Vector]:
        """Return the velocities after half a period, (2,), and their derivatives by z, (2, 3)."""
        shot = self._shot(z)
        return shot.velocities, shot.gradients

    def orbit(self, z: Vector) -> Orbit:
        """Return the orbit of a solution z."""
        shot = self._shot(z)
        if self._latest_orbit is None:
            x_speed, y_speed = shot.velocities.tolist()
            self._latest_orbit = Orbit(
                z,
                shot.final[:2],
                shot.switches[: shot.legs - 1],
                float(stability_index(self.rows, shot.segments, shot.legs)),
                max(abs(x_speed), abs(y_speed)),
            )
        return self._latest_orbit

    def sense(self, state: ContinuationState) -> float:
        """Return 1 where a branch runs along the cross product of both gradients, else −1."""
        first, second = self._shot(state.point).gradients.tolist()
        along = (
            (first[i - 2] * second[i - 1] - first[i - 1] * second[i - 2]) * each
            for i, each in enumerate(state.tangent.tolist())
        )
        return float(np.sign(sum(along)))

    def at_other_rest(self, z: Vector, direction: Vector) -> Vector:
        """Return a direction of a branch, (3,), as it is at the other instant of rest."""
        shot, vector = self._shot(z), np.array([*direction[:2], 0.0, 0.0])
        push(self.rows, shot.segments, shot.legs, vector)
        return np.array([*vector[:2], direction[2]])

    def _shot(self, z: Vector) -> _Shot:
        if z is not self._latest.point:
            velocities, gradients, final = np.empty(2), np.empty((2, 3)), np.empty(4)
            segments = np.empty((shooting_limits.segments, 9))
            switches = np.empty(shooting_limits.segments)
            work = segments, switches, velocities, gradients, final
            legs = rest_conditions(self.rows, z, *work)
            if not legs:
                velocities.fill(np.nan)
            self._latest = _Shot(
                z, velocities, gradients, segments, switches, final, legs
            )
            self._latest_orbit = None
        return self._latest


@dataclass(frozen=True)
class Across(PseudoArclength):
    """Pseudo-arclength with a compiled corrector; its tolerance is of end velocities."""

    def correct(
        self, problem: Any, guess: Vector, normal: Vector
    ) -> tuple[Vector, Vector, int, float] | None:
        """Correct a guess as :class:`PseudoArclength` does, for :class:`OrbitEquations`."""
        point, tangent = np.array(guess, dtype=float), np.empty(3)
        work = (
            np.empty((shooting_limits.segments, 9)),
            np.empty(shooting_limits.segments),
            np.empty(4),
        )
        unit = normal / length_of(normal)
        effort, settings = np.empty(2), self.settings
        count = solve_constrained(
            problem.rows, point, unit, settings.tolerance, *work, tangent, effort
        )
        iterations, residual = int(effort[0]), float(effort[1])
        problem.work += (iterations + 1) * problem.fastest * abs(float(guess[2]))
        if count == 0:
            return None
        return point, math.copysign(1.0, tangent @ unit) * tangent, iterations, residual


to_round_off = Across(ContinuationSettings(tolerance=1e-300))
"""Goes on until round-off stops the progress."""


def orbit_across(
    system: PiecewiseLinearSystem, guess: Vector, normal: Vector
) -> Orbit | None:
    """Return the orbit on the plane through a guess, or None where Newton's method fails.

    Args:
        guess: x0, y0, T/2; what follows is not read.
        normal: (3,) normal of the plane.
    """
    equations = OrbitEquations(system)
    correction = to_round_off.correct(equations, guess[:3], normal)
    return None if correction is None else equations.orbit(correction[0])


def solve_orbit(system: PiecewiseLinearSystem, guess: Vector) -> Orbit | None:
    """Return the orbit with the y0 of a guess (x0, y0, T/2); None where Newton's method fails."""
    return orbit_across(system, guess, np.array([0.0, 1.0, 0.0]))


def decoupled_half_period(system: PiecewiseLinearSystem, y_peak: float) -> float:
    """Return T/2 of a motion in y alone, on one spring above the threshold and another below.

    Args:
        y_peak: its largest y.
    """
    above, below = system.above, system.below
    frequency = math.sqrt(above.matrix[1][1])
    centre = above.load[1] / above.matrix[1][1]
    fall = math.acos((system.threshold - centre) / (y_peak - centre))
    speed = (y_peak - centre) * frequency * math.sin(fall)
    stiff = math.sqrt(below.matrix[1][1])
    offset = system.threshold - below.load[1] / below.matrix[1][1]
    return fall / frequency + (math.pi - math.atan2(speed / stiff, offset)) / stiff


def shape(
    system: PiecewiseLinearSystem, point: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Return x amplitude, y amplitude (half peak-to-peak) and the largest of |vx| over a period."""
    out = np.empty(6)
    extremes(system.rows, np.ascontiguousarray(point[:3], dtype=float), out)
    return (
        0.5 * (out[1] - out[0]),
        0.5 * (out[3] - out[2]),
        float(np.abs(out[4:]).max()),
    )


def index_from_switches(
    system: PiecewiseLinearSystem,
    switches: NDArray[np.float64],
    half_period: float,
    y0: float,
) -> float:
    """Stability index of a motion that switches at given times of its half period.

    The tangent flow depends on the motion through these times alone, so this serves a series
    as well as an exact orbit: it is the exact trace − 2 of the approximate orbit.
    """
    times = np.concatenate([[0.0], switches, [half_period]])
    segments = np.empty((len(times) - 1, 9))
    side = int(y0 > system.threshold)
    for leg, duration in enumerate(np.diff(times)):
        propagator(system.rows[side], float(duration), segments[leg])
        segments[leg, 8] = side
        side = 1 - side
    return float(stability_index(system.rows, segments, len(segments)))
