"""Tracing a branch of symmetric orbits up to a given peak.

:mod:`squealpipe.systems.continuation` makes the steps. The tangent across both gradients keeps
its sense along a regular branch: a step to a point where it runs the other way has left the branch
across a bifurcation, perfect or not, and is taken again at half its length.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from enum import Enum, auto
from functools import partial

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.orbits.orbits import (
    Across,
    Orbit,
    OrbitEquations,
    orbit_across,
    solve_orbit,
    to_round_off,
)
from squealpipe.brake.orbits.piecewise_linear import PiecewiseLinearSystem
from squealpipe.brake.orbits.shooting import shooting_limits
from squealpipe.brake.orbits.shorter_orbits import about_to_meet, shorter_orbit_between
from squealpipe.systems.branch_line import Line
from squealpipe.systems.continuation import (
    ContinuationSettings,
    ContinuationState,
    length_of,
)
from squealpipe.systems.progress import report

Vector = NDArray[np.float64]
Place = Callable[[], Orbit | None]
"""Function of a place on a branch: the orbit there; None where Newton's method fails."""


@dataclass(frozen=True)
class TracingLimits:
    """Limits of the steps along a branch of exact orbits."""

    largest_turn: float = 0.5
    """Phase of the fastest mode by which T/2 and the time in flight may change in one step, rad;
    more, and a step might jump to another branch."""
    largest_change: float = 0.2
    """Change of (x0, y0) in one step, over the distance of both instants of rest."""
    close: float = 1e-2
    """Step over the longest one below which a meeting with another branch is judged."""
    most_work: float = 1e7
    """Phase of the fastest mode in all shots of Newton's method in a trace, rad: a minute."""
    near: float = 1e-3
    """An orbit moves so far, over 1 + |z|, when its peak is set right; at a fold like a root."""


limits = TracingLimits()


class TraceEnd(Enum):
    """Reason why a trace ended, in the words of ``schema.Outcome``."""

    amplitude_reached = auto()
    retraced = auto()
    tongue_end = auto()
    branch_lost = auto()
    step_limit = auto()
    pole = auto()


@dataclass(frozen=True, kw_only=True)
class TraceSettings(ContinuationSettings):
    """Step control of a trace, in arclength over 1 + |z| of z = (x0, y0, T/2).

    Attributes:
        strict: whether a step must keep the sense of the branch; without it a trace crosses
            narrow resonances, so it may leave its branch.
        largest_x: |x0| over y0 and the linear mode's x0 together, beyond which the branch
            follows an internal resonance to infinity.
        linear_x, linear_slope: |x0| of the linear mode at the threshold and its growth with y0.
    """

    shortest_step: float = 1e-12
    longest_step: float = 0.1
    tolerance: float = 1e-13
    easy_iterations: int = 4
    growth: float = 2.0
    least_cosine: float = 0.98
    max_points: int = 4000
    strict: bool = True
    largest_x: float = 50.0
    linear_x: float = 0.0
    linear_slope: float = 0.0


def trace_branch(
    system: PiecewiseLinearSystem,
    start: Vector,
    direction: Vector,
    y_stop: float,
    settings: TraceSettings,
    spacing: float,
) -> tuple[list[Orbit], TraceEnd]:
    """Orbits of a branch at even distances, and why it ended.

    Args:
        start, direction: (3,) a solution and the way to go; neither needs to be regular.
        y_stop: larger y of the instants of rest at which the trace ends.
        spacing: of the orbits over 1 + |z|; 0 for the last one alone.
    """
    trace, orbits = _Trace(system, settings, y_stop), list[Orbit]()
    for line, share in trace.steps(start, direction):
        orbits += found_at(trace.places(line, share, spacing))
        report(partial(_gone, orbits, y_stop))
    return orbits, trace.end


def places_on_branch(
    system: PiecewiseLinearSystem,
    start: Vector,
    direction: Vector,
    y_stop: float,
    settings: TraceSettings,
    spacing: float,
) -> tuple[list[Place], TraceEnd]:
    """Return the branch of :func:`trace_branch` with orbits as functions, computed when wanted."""
    trace, places = _Trace(system, settings, y_stop), list[Place]()
    for line, share in trace.steps(start, direction):
        places += trace.places(line, share, spacing)
    if trace.end is TraceEnd.amplitude_reached:
        peak = places[-1]()  # whether it is found decides why the trace ends
        places[-1] = lambda: peak
    return places, trace.end


def found_at(places: Iterable[Place]) -> list[Orbit]:
    """Orbits at places of a branch, without those that Newton's method does not find."""
    return [orbit for place in places if (orbit := place())]


def _gone(orbits: list[Orbit], y_stop: float) -> float:
    return float(orbits[-1].point[1]) / y_stop if orbits else 0.0


def orbit_on_branch(
    system: PiecewiseLinearSystem,
    start: Vector,
    direction: Vector,
    y_stop: float,
    settings: TraceSettings,
) -> tuple[Orbit | None, TraceEnd]:
    """The branch's orbit at y0 = y_stop, and why the trace ended; None where it is not met."""
    orbits, end = trace_branch(system, start, direction, y_stop, settings, 0.0)
    return (orbits[-1] if orbits else None), end


class _Trace:
    """A branch as it is traced."""

    def __init__(
        self, system: PiecewiseLinearSystem, settings: TraceSettings, y_stop: float
    ) -> None:
        self.system, self.settings, self.y_stop = system, settings, y_stop
        self.equations = OrbitEquations(system)
        self.algorithm = Across(settings)
        self.end = TraceEnd.step_limit
        self.sense, self.meets = 0.0, False

    def steps(
        self, start: Vector, direction: Vector
    ) -> Iterator[tuple[Line[Orbit], float]]:
        """Each step, and the share of it up to which it is gone."""
        settings, here = self.settings, self.equations.orbit(start)
        unit = direction / length_of(direction)
        state = ContinuationState(
            start, unit, np.zeros(3), settings.first_step, 0, here.residual
        )
        fastest = self.equations.fastest
        for _ in range(settings.max_points):
            if self.equations.work > limits.most_work:
                return
            if not fastest * state.point[2] < shooting_limits.phase:
                return
            following = self.algorithm.advance(
                self.equations, state, partial(self._accepts, here)
            )
            if following is None or self.meets:
                lost = following is None
                self.end = TraceEnd.branch_lost if lost else TraceEnd.tongue_end
                return
            there = self.equations.orbit(following.point)
            line = Line(
                to_round_off,
                self.equations,
                (state, here),
                (following, there),
                self.equations.orbit,
            )
            share = self._way_to_peak(line)
            if share is not None:
                self.end = TraceEnd.amplitude_reached
                yield line, share
                return
            yield line, 1.0
            if following.point[1] <= self.system.threshold and not there.switches.size:
                self.end = TraceEnd.retraced
                return
            if self._diverges(following.point):
                self.end = TraceEnd.pole
                return
            state, here = self._from_higher_rest(following, there)
            # a resonance is narrower than what the curvature before it is good for
            state = replace(state, curvature=np.zeros(3))
            self.sense = self.equations.sense(state)

    def _accepts(self, here: Orbit, trial: ContinuationState) -> bool:
        """Return whether a step is sure to stay on the branch, or has come to one that it meets."""
        if not self.settings.strict:
            return True
        moved, fastest = trial.point - here.point, self.equations.fastest
        extent = length_of(here.rest - here.point[:2])
        if (
            fastest * abs(moved[2]) > limits.largest_turn
            or length_of(moved[:2]) > limits.largest_change * extent > 0.0
        ):
            return False
        orbit = self.equations.orbit(trial.point)
        first, last = (each.flight(self.system.threshold) for each in (here, orbit))
        if not fastest * abs(last - first) < limits.largest_turn:
            return False
        turned = self.equations.sense(trial) * self.sense < 0.0
        if not (turned or about_to_meet(self.system, orbit)):
            return True
        close = (
            limits.close * self.settings.longest_step * (1.0 + length_of(here.point))
        )
        self.meets = bool(length_of(moved) < close) and shorter_orbit_between(
            self.system, here, orbit
        )
        return self.meets

    def _from_higher_rest(
        self, state: ContinuationState, orbit: Orbit
    ) -> tuple[ContinuationState, Orbit]:
        """Return the same point of the branch, described from its instant of rest with the larger
        y.
        """
        described = orbit.from_higher_rest()
        if described is orbit:
            return state, orbit
        tangent = self.equations.at_other_rest(state.point, state.tangent)
        tangent /= length_of(tangent)
        return replace(
            state, point=described.point, tangent=tangent, curvature=np.zeros(3)
        ), described

    def _diverges(self, point: Vector) -> bool:
        """Return whether x0 is many times as large as y0 and as x0 of the linear mode."""
        peak, settings = max(float(point[1]), 1.0), self.settings
        linear = settings.linear_x + settings.linear_slope * (peak - 1.0)
        return bool(abs(point[0]) > settings.largest_x * (peak + linear))

    def _room(self, _: ContinuationState | None, orbit: Orbit) -> float:
        """Return how far the larger y of the instants of rest is below that at which the trace
        ends.
        """
        return self.y_stop - max(float(orbit.point[1]), float(orbit.rest[1]))

    def _way_to_peak(self, line: Line[Orbit]) -> float | None:
        """Share of a step at which the peak is that at which the trace ends, if it is reached.

        Where y0 has a maximum within the step that may be higher, it is looked for.
        """
        (state, here), (following, there) = line.known[0.0], line.known[1.0]
        top = 1.0
        if self._room(None, there) > 0.0:
            rise = 1.5 * line.reach * float(state.tangent[1])
            if not (
                following.tangent[1] < 0.0 < rise
                and here.point[1] + rise >= self.y_stop
            ):
                return None
            turn = line.root(lambda each, _: float(each.tangent[1]))
            if turn is None or self._room(*line.at(turn)) > 0.0:
                return None
            top = turn
        share = line.root(self._room, top)
        return top if share is None else share

    def places(self, line: Line[Orbit], share: float, spacing: float) -> list[Place]:
        """Orbits of a step at even distances up to a share of it, and the one at the peak."""
        reached, places = self.end is TraceEnd.amplitude_reached, list[Place]()
        if spacing:
            unit = spacing * (1.0 + length_of(line.known[0.0][0].point))
            pieces = max(1, math.ceil(share * line.reach / unit))
            places += [
                partial(self._orbit, line, share * piece / pieces, piece == pieces)
                for piece in range(1, pieces + 1 - reached)
            ]
        return [*places, partial(self._peak, line, share)] if reached else places

    def _orbit(self, line: Line[Orbit], share: float, is_last: bool) -> Orbit | None:
        try:
            orbit = line.at(share)[1]
        except ArithmeticError:
            return None
        if is_last:
            orbit = orbit_across(self.system, orbit.point, line.normal) or orbit
        return orbit.from_higher_rest()

    def _peak(self, line: Line[Orbit], share: float) -> Orbit | None:
        there = line.at(share)[1].from_higher_rest()
        x0, _, half_period = there.point
        found = solve_orbit(self.system, np.array([x0, self.y_stop, half_period]))
        size = 1.0 + length_of(there.point)
        if found and np.abs(found.point - there.point).sum() < limits.near * size:
            return found.from_higher_rest()
        self.end = TraceEnd.branch_lost
        return None
