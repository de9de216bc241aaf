"""The return map of a hybrid system in one parameter, as equations for a continuation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from squealpipe.methods.continuation import ContinuationSettings, ContinuationState, PseudoArclength
from squealpipe.methods.cycles.cycles import Cycle
from squealpipe.methods.cycles.event_flow import HybridSystem, Passage, Vector, flow


@dataclass
class CycleEquations:
    """φ_T(z; p) − z = 0 and a phase condition; unknowns (z/scale, T/time, p/unit).

    Attributes:
        system_at: parameter value → system.
        scale, time, unit: of state, period and parameter.
        reference: state that the phase condition goes through.
        normal: direction in scaled space that its plane is normal to.
        latest: the unknowns that were evaluated last, and their passage.
    """

    system_at: Callable[[float], HybridSystem]
    scale: Vector
    time: float
    unit: float
    reference: Vector
    normal: Vector
    latest: tuple[Vector, HybridSystem, Passage] | None = None

    def unpack(self, z: Vector) -> tuple[Vector, float, float]:
        """(state, period, parameter)."""
        return z[:4] * self.scale, float(z[4] * self.time), float(z[5] * self.unit)

    def pack(self, state: Vector, period: float, parameter: float) -> Vector:
        """The unknowns."""
        return np.array([*(state / self.scale), period / self.time, parameter / self.unit])

    def evaluate(self, z: Vector) -> tuple[Vector, Vector]:
        """F(z), (5,), and its Jacobian, (5, 6)."""
        state, period, parameter = self.unpack(z)
        values, jacobian = np.full(5, np.nan), np.zeros((5, 6))
        if not (period > 0.0 and np.isfinite(z).all()):
            return values, jacobian
        try:
            system = self.system_at(parameter)
        except ValueError:  # beyond what the parameter may be
            return values, jacobian
        passage = flow(system, state, period, keep=True)
        if not passage.complete:
            return values, jacobian
        self.latest = (z.copy(), system, passage)
        values[:4] = (passage.state - state) / self.scale
        values[4] = self.normal @ (z[:4] - self.reference / self.scale)
        jacobian[:4, :4] = (passage.derivative - np.eye(4)) * self.scale / self.scale[:, None]
        jacobian[:4, 4] = system.velocity(passage.regime, passage.state) / self.scale * self.time
        jacobian[:4, 5] = passage.slope / self.scale
        jacobian[4, :4] = self.normal
        return values, jacobian


def cycle_algorithm(steps: ContinuationSettings) -> PseudoArclength:
    """For equations expensive to evaluate: a good guess is a point, with its own tangent."""
    return PseudoArclength(steps, least_iterations=0, own_tangent=True)


def cycle_at(equations: CycleEquations, state: ContinuationState) -> Cycle:
    """The periodic motion of a state of the continuation."""
    if equations.latest is None or not np.array_equal(equations.latest[0], state.point):
        equations.evaluate(state.point)
    place, period, _ = equations.unpack(state.point)
    _, system, passage = equations.latest  # type: ignore[misc]
    return Cycle(system, place, period, equations.scale, state.residual, passage)


def anchor(
    equations: CycleEquations, state: ContinuationState, cycle: Cycle
) -> tuple[ContinuationState, Cycle]:
    """The same cycle with a phase condition of its own, described far from events.

    The phase stays while there is room to the next event; else it moves to the middle of the
    longest segment that is not a hold. The tangent is carried along by the flow.
    """
    passage = cycle.passage
    bounds = np.array([0.0, *passage.event_times, cycle.period])
    lengths = np.diff(bounds)
    lengths[[cycle.system.holds(regime) for regime in passage.regimes]] = 0.0
    if len(lengths) > 1:
        # the first segment and the last are one
        room = lengths[0] > 0.0 and min(lengths[0], lengths[-1]) > 0.2 * lengths.max()
        longest = int(np.argmax(lengths))
        time = 0.0 if room else 0.5 * float(bounds[longest] + bounds[longest + 1])
    else:
        time = 0.0
    tangent, point = state.tangent.copy(), state.point
    if time > 0.0:
        ahead = flow(cycle.system, cycle.state, time)
        carried = ahead.derivative @ (tangent[:4] * equations.scale) / equations.scale
        tangent[:4] = carried + ahead.slope / equations.scale * tangent[5]
        point = equations.pack(ahead.state, cycle.period, float(point[5] * equations.unit))
        cycle = cycle_at(equations, replace(state, point=point))
    normal = cycle.heading / np.linalg.norm(cycle.heading)
    equations.reference, equations.normal = cycle.state, normal
    tangent[:4] -= normal * (normal @ tangent[:4])
    tangent /= np.linalg.norm(tangent)
    curvature = np.zeros(6) if time > 0.0 else state.curvature
    return replace(state, point=point, tangent=tangent, curvature=curvature), cycle
