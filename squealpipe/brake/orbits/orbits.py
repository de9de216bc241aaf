"""Exact symmetric periodic orbits, from compiled kernels."""

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
)

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Orbit:
    """A symmetric periodic orbit in the units of its system.

    Attributes:
        point: (3,) x0, y0, T/2 from an instant of rest, that with the larger y if not said.
        rest: (2,) x and y at the other instant of rest.
        stability_index: trace of the monodromy matrix − 2.
    """

    point: Vector
    rest: Vector
    switches: Vector
    stability_index: float
    residual: float

    @property
    def omega(self) -> float:
        """Angular frequency 2π/T."""
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
        durations = np.diff([0.0, *self.switches, self.point[2]])
        return float(durations[int(self.point[1] <= threshold) :: 2].sum())

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
    legs: int = 0


class OrbitEquations:
    """Rest at both ends of half a period: two equations for z = (x0, y0, T/2).

    Attributes:
        fastest: frequency of the fastest mode of either state.
        work: its phase in all shots of Newton's method, rad.
    """

    def __init__(self, system: PiecewiseLinearSystem) -> None:
        self.system, self.rows = system, system.rows
        self.fastest, self.work = float(fastest(system.rows)), 0.0
        nothing = np.empty(0)
        self._latest = _Shot(nothing, nothing, nothing, nothing, nothing, nothing)

    def evaluate(self, z: Vector) -> tuple[Vector, Vector]:
        """Velocities after half a period and their derivatives, (2,) and (2, 3)."""
        shot = self._shot(z)
        return shot.velocities, shot.gradients

    def orbit(self, z: Vector) -> Orbit:
        """The orbit that a solution is."""
        shot = self._shot(z)
        return Orbit(
            z,
            shot.final[:2],
            shot.switches[: shot.legs - 1],
            float(stability_index(self.rows, shot.segments, shot.legs)),
            float(np.abs(shot.velocities).max()),
        )

    def sense(self, state: ContinuationState) -> float:
        """Return whether a branch runs along the vector across both gradients, 1, or against it,
        −1.
        """
        gradients = self._shot(state.point).gradients
        return float(np.sign(np.linalg.det([*gradients, state.tangent])))

    def at_other_rest(self, z: Vector, direction: Vector) -> Vector:
        """A direction of a branch, described from the other instant of rest."""
        shot, vector = self._shot(z), np.array([*direction[:2], 0.0, 0.0])
        push(self.rows, shot.segments, shot.legs, vector)
        return np.array([*vector[:2], direction[2]])

    def _shot(self, z: Vector) -> _Shot:
        if z is not self._latest.point:
            shot = _Shot(
                z,
                np.empty(2),
                np.empty((2, 3)),
                np.empty((shooting_limits.segments, 9)),
                np.empty(shooting_limits.segments),
                np.empty(4),
            )
            _, residual, gradients, segments, switches, final, _ = shot
            work = segments, switches, residual, gradients, final
            legs = rest_conditions(self.rows, z, *work)
            if not legs:
                shot.velocities.fill(np.nan)
            self._latest = shot._replace(legs=legs)
        return self._latest


@dataclass(frozen=True)
class Across(PseudoArclength):
    """Pseudo-arclength whose corrector is in closed form; its tolerance is of end velocities."""

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
        unit = normal / np.linalg.norm(normal)
        count, iterations, residual = solve_constrained(
            problem.rows, point, unit, self.settings.tolerance, *work, tangent
        )
        problem.work += (iterations + 1) * problem.fastest * abs(float(guess[2]))
        if count == 0:
            return None
        return point, math.copysign(1.0, tangent @ unit) * tangent, iterations, residual


to_round_off = Across(ContinuationSettings(tolerance=1e-300))
"""Goes on until round-off stops the progress."""


def orbit_across(
    system: PiecewiseLinearSystem, guess: Vector, normal: Vector
) -> Orbit | None:
    """The orbit on the plane through a guess across a normal, or None where Newton fails."""
    equations = OrbitEquations(system)
    correction = to_round_off.correct(equations, guess[:3], normal)
    return None if correction is None else equations.orbit(correction[0])


def solve_orbit(system: PiecewiseLinearSystem, guess: Vector) -> Orbit | None:
    """The orbit with the y0 of a guess (x0, y0, T/2), or None where Newton's method fails."""
    return orbit_across(system, guess, np.array([0.0, 1.0, 0.0]))


def decoupled_half_period(system: PiecewiseLinearSystem, y_peak: float) -> float:
    """T/2 of a y motion that does not feel x: one spring above the threshold, another below."""
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
    """(x amplitude, y amplitude, largest |vx|) over a period; amplitudes are half peak-to-peak."""
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
